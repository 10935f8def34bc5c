"""What was simulated, as a recording."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.workflows.simulate.request import Request


def logged(request: Request, time: np.ndarray, **channels: tuple[np.ndarray, str]) -> Recording:
    """Channels (samples and their unit) under the names that readers know them by."""
    made = tuple(Channel(name, samples, unit, name) for name, (samples, unit) in channels.items())
    return Recording(time, made, Provenance(f"simulated {request.experiment.name}", "", "simulator"))


def head_of(request: Request) -> tuple[np.ndarray, np.ndarray]:
    """Time [s] and position [m] of a testing machine's head at constant speed, (n,) float each."""
    time = np.arange(round(request.duration * request.rate)) / request.rate
    return time, request.conditions.speed_mm_s * 1e-3 * time
