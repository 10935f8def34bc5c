"""Small sessions of one rig on disk, for what handles many of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE, SAMPLES = 200.0, 300


def write_fleet(folder: Path, count: int, seed: int = 0) -> list[str]:
    """Sessions ``rig-0000`` … of two decays each; the stiffness of each is drawn anew. Their names, in order."""
    random = np.random.default_rng(seed)
    time = np.arange(SAMPLES) / RATE
    names = [f"rig-{n:04d}" for n in range(count)]
    for name in names:
        place = folder / name
        place.mkdir(parents=True)
        stiffness = 2.0 * (2.0 * np.pi * random.uniform(4.0, 6.0)) ** 2
        damping = 0.02 * 2.0 * np.sqrt(2.0 * stiffness)
        rate = damping / 4.0
        turning = np.sqrt(stiffness / 2.0 - rate**2)
        for trial in (1, 2):
            start = random.uniform(0.8e-3, 1.2e-3)
            motion = start * np.exp(-rate * time) * (np.cos(turning * time) + rate / turning * np.sin(turning * time))
            rows = np.column_stack([time, motion + random.normal(0.0, 1e-5, SAMPLES)])
            np.savetxt(place / f"decay-{trial}.csv", rows, "%.7g", ",", header="time [s],position [m]", comments="")
        (place / "session.yaml").write_text(
            f"schema: ssmr-ident/session/1\nname: {name}\nrobot: rig.yaml\nbaseline: sdof\nrecordings:\n"
            "  - {file: decay-1.csv, experiment: free_response}\n  - {file: decay-2.csv, experiment: free_response}\n",
            encoding="utf-8",
        )
        (place / "rig.yaml").write_text(
            "schema: ssmr-ident/parameters/1\nname: small rig\nmass_kg: {value: 2.0, std: 0.02}\n"
            "stiffness_N_m: {value: 2000, std: 1000}\ndamping_N_s_m: {value: 2.5}\n",
            encoding="utf-8",
        )
    return names
