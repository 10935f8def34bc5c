"""A rig on a shaken foot: what is logged of it, absolute, gives the rig back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lsim

from ssmr_ident.doctor.run import diagnose
from ssmr_ident.experiments.campaign import load

pytestmark = pytest.mark.slow

MASS, DAMPING, STIFFNESS, RATE, COUNT = 2.0, 6.0, 5000.0, 200.0, 1600


def shaken(folder: Path, channel: str) -> None:
    """Position of the foot, and an absolute motion of the mass, by another integrator."""
    random = np.random.default_rng(5)
    time = np.arange(COUNT) / RATE
    a = np.array([[0.0, 1.0], [-STIFFNESS / MASS, -DAMPING / MASS]])
    lines, unit = [], {"position": "m", "velocity": "m/s"}[channel]
    for number in (1, 2, 3):
        tones = random.uniform(2.0, 14.0, 12)
        phases = random.uniform(0.0, 2.0 * np.pi, 12)
        turn = 2.0 * np.pi * tones
        angle = turn * time[:, None] + phases
        foot, speed = (1e-3 * (turn**n * np.sin(angle + 0.5 * np.pi * n)).sum(axis=1) for n in (0, 1))
        fine = np.arange(10 * COUNT) / (10 * RATE)
        pull = 1e-3 * (turn**2 * np.sin(turn * fine[:, None] + phases)).sum(axis=1)
        _, state, _ = lsim((a, [[0.0], [1.0]], np.eye(2), np.zeros((2, 1))), pull, fine)
        state = state[::10]
        absolute = {"position": state[:, 0] + foot, "velocity": state[:, 1] + speed}[channel]
        logged = absolute + 0.005 * absolute.std() * random.standard_normal(COUNT)
        measured = foot + 2e-6 * random.standard_normal(COUNT)
        rows = "\n".join(f"{t:.3f},{f:.8f},{y:.8f}" for t, f, y in zip(time, measured, logged, strict=True))
        (folder / f"run-{number}.csv").write_text(f"time [s],foot [m],mass [{unit}]\n{rows}\n")
        lines.append(
            f"  - {{file: run-{number}.csv, experiment: base_motion, "
            f"channels: {{base_position: foot, {channel}: mass}}}}"
        )
    (folder / "session.yaml").write_text(
        "schema: ssmr-ident/session/1\nname: shaken\nrobot: rig.yaml\nbaseline: sdof\nrecordings:\n" + "\n".join(lines)
    )
    (folder / "rig.yaml").write_text(
        "schema: ssmr-ident/parameters/1\nname: rig\nmass_kg: {value: 2.0, std: 0.02, unit: kg}\n"
        "stiffness_N_m: {value: 4000.0, unit: N/m}\ndamping_N_s_m: {value: 10.0, unit: N s/m}\n"
    )


@pytest.mark.parametrize("channel", ["position", "velocity"])
def test_a_foot_whose_position_is_logged(tmp_path: Path, channel: str) -> None:
    shaken(tmp_path, channel)
    found = diagnose(load(tmp_path))
    assert found.verdict == "nothing_missing"
    assert float(found.after["stiffness_N_m"].value) == pytest.approx(STIFFNESS, rel=0.01)
    assert float(found.after["damping_N_s_m"].value) == pytest.approx(DAMPING, rel=0.05)
    assert found.heldout.before < 1.6
