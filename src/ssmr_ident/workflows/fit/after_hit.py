"""Modes of the free decay that follows a blow on a rig."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.decays.fit import fit_decay
from ssmr_ident.session.entry import MOTIONS

SEEN = (*MOTIONS, "acceleration_2")


def modes_after_a_hit(
    forced: Sequence[Measurement], lines: dict[str, tuple[str, ...]], results: dict[str, dict[str, Any]]
) -> list[str]:
    """Modes of the free decay that follows a blow; nothing for a force that goes on."""
    findings = []
    for measurement in forced:
        recording = measurement.recording
        force = recording["force" if "force" in recording else "torque"]
        strength = np.abs(force - np.median(force))
        loud = np.flatnonzero(strength > 0.05 * strength.max())
        end = int(loud[-1]) + 1
        if end > 0.2 * len(force) or loud[-1] - loud[0] > 0.05 * len(force):
            continue
        names = [name for name in SEEN if name in recording]
        # Faster modes die first: a fiftieth of the record is left to them.
        start = float(recording.time[min(end + len(force) // 50, len(force) - 64)])
        table = np.column_stack([recording[name] for name in names])
        fit = fit_decay(recording.time, table, start_s=start, max_modes=3, unit=recording.channel(names[0]).unit)
        lines[f"{measurement.name} after the hit"] = tuple(str(fit).splitlines())
        results[f"{measurement.name} after the hit"] = {
            "experiment": "free decay after a hit",
            "modes": [
                {
                    "frequency_Hz": mode.frequency_hz,
                    "omega_n_rad_s": mode.omega_n,
                    "omega_n_std_rad_s": mode.omega_n_std,
                    "xi": mode.xi,
                    "xi_std": mode.xi_std,
                }
                for mode in fit.modes
            ],
        }
        strong = [m for m in fit.modes if np.sum(m.amplitudes**2) > 0.1 * np.sum(fit.dominant.amplitudes**2)]
        near = [m for m in strong if abs(m.omega_n / fit.dominant.omega_n - 1) < 0.3]
        if len(near) > 1:
            findings.append(
                f"{measurement.name}: {len(near)} modes close together, at "
                + " and ".join(f"{m.frequency_hz:.2f} Hz (xi {100 * m.xi:.2g} %)" for m in near)
                + ": one mass on one spring cannot beat"
            )
    return findings
