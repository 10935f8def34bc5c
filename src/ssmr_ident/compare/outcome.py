"""A prediction beside its measurement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.shown import Shown


@dataclass(frozen=True, eq=False)
class Prediction(Shown):
    """Measured and simulated channels on one even time grid.

    Parameters
    ----------
    time : (n,) float [s]
        The recording's own.
    names : tuple of str
    units : tuple of str
    measured, simulated : (n, c) float
    nuisances : mapping of str to float
        What was refitted for this recording, SI.
    metric : str
        ``nrmse_percent`` or ``log_psd_db``.
    low_pass_hz : float or None
        Of the metric; None as logged.
    """

    time: np.ndarray
    names: tuple[str, ...]
    units: tuple[str, ...]
    measured: np.ndarray
    simulated: np.ndarray
    metric: str = "nrmse_percent"
    low_pass_hz: float | None = 50.0
    nuisances: Mapping[str, float] = field(default_factory=dict)

    @property
    def sample_rate(self) -> float:
        return (len(self.time) - 1) / float(self.time[-1] - self.time[0])

    def __str__(self) -> str:
        lines = [f"{', '.join(self.names)}: {len(self.time)} samples at {self.sample_rate:.6g} Hz, by {self.metric}"]
        lines += [f"  refitted for this recording: {name} = {value:.4g}" for name, value in self.nuisances.items()]
        return "\n".join(lines)
