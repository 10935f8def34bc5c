"""What is measured of one simulated run: the thesis' peaks and amplitudes, and how the robot moved meanwhile."""

from __future__ import annotations

from typing import Any

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.signals.analysis import AnalysisOptions, analyse
from ssmr_ident.signals.filters import FREE_RESPONSE_LOW_PASS_HZ, SWIVEL_LOW_PASS_HZ
from ssmr_ident.signals.peaks import COUNT
from ssmr_ident.signals.spectra import FREE_RESPONSE_LENGTH, SWIVEL_LENGTH, select_range
from ssmr_ident.workflows.simulate.request import Request

AXES = ("ax", "ay", "az")
SHOWN_HZ = 60.0


def measured(recording: Recording, request: Request) -> tuple[dict[str, Any], dict[str, list[float]]]:
    """Numbers of a run with units in their keys, and its amplitude spectra up to ``SHOWN_HZ``.

    Parameters
    ----------
    recording : Recording
        All channels of the simulator, and slips.
    request : Request
    """
    free = request.experiment.free
    options = AnalysisOptions(
        part="beginning" if free else "middle",
        length=FREE_RESPONSE_LENGTH if free else SWIVEL_LENGTH,
        low_pass_hz=FREE_RESPONSE_LOW_PASS_HZ if free else SWIVEL_LOW_PASS_HZ,
    )
    found: dict[str, Any] = {}
    spectra: dict[str, list[float]] = {}
    rate = recording.sample_rate
    for axis in AXES:
        if rate <= 2.0 * options.low_pass_hz:
            break  # a testing machine's rate shows no vibration
        one = analyse(recording[axis], rate, options)
        found[f"{axis}_amplitude_m_s2"] = one.amplitude
        for rank in range(COUNT):
            there = rank < len(one.lines)
            found[f"{axis}_peak_{rank + 1}_hz"] = float(one.lines.frequency[rank]) if there else None
            found[f"{axis}_peak_{rank + 1}_m_s2"] = float(one.lines.amplitude[rank]) if there else None
        shown = one.spectrum.frequency <= SHOWN_HZ
        spectra["frequency"] = one.spectrum.frequency[shown].tolist()
        spectra[axis] = one.spectrum.amplitude[shown].tolist()
    part = select_range(len(recording.time), rate, options.part, length=options.length).indices
    found["yaw_rate_mean_deg_s"] = float(np.rad2deg(recording["wz"][part].mean()))
    found["forward_mean_m_s"] = float(recording["vx"][part].mean())
    found["lateral_mean_m_s"] = float(recording["vy"][part].mean())
    found["lateral_rms_m_s"] = float(np.sqrt(np.mean(recording["vy"][part] ** 2)))
    found["sliding_share"] = float(np.mean(recording["sliding"][part]) / 4.0)
    for wheel in (1, 2, 3, 4):
        found[f"slip_{wheel}_mean"] = float(recording[f"slip_{wheel}"][part].mean())
        found[f"load_{wheel}_least_N"] = float(recording[f"load_{wheel}"][part].min())
        side = np.hypot(recording[f"force_x_{wheel}"][part], recording[f"force_y_{wheel}"][part])
        found[f"grip_{wheel}_mean_N"] = float(side.mean())
    if "force" in recording:
        force = recording["force"]
        found["pull_mean_N"], found["pull_most_N"] = float(force.mean()), float(force.max())
    return found, spectra
