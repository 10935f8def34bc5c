"""A prediction beside its measurement."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.core.shown import Shown
from ssmr_ident.signals.band import passed
from ssmr_ident.signals.filters import ORDER
from ssmr_ident.signals.noise import AutoregressiveNoise


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
    high_pass_hz : float
        Of the metric, where a recording is judged in a band.
    noises : tuple of AutoregressiveNoise
        Of the channels' means over ``block`` samples, where its colour is known.
    block : int
    """

    time: np.ndarray
    names: tuple[str, ...]
    units: tuple[str, ...]
    measured: np.ndarray
    simulated: np.ndarray
    metric: str = "nrmse_percent"
    low_pass_hz: float | None = 50.0
    nuisances: Mapping[str, float] = field(default_factory=dict)
    high_pass_hz: float = 0.0
    noises: tuple[AutoregressiveNoise, ...] = ()
    block: int = 1

    @property
    def sample_rate(self) -> float:
        return (len(self.time) - 1) / float(self.time[-1] - self.time[0])

    @property
    def filtered(self) -> bool:
        """Whether the metric's filter takes away anything to speak of."""
        if self.low_pass_hz is None:
            return False
        return self.high_pass_hz > 0.0 or self.low_pass_hz < 0.45 * self.sample_rate

    def judged(self, samples: np.ndarray) -> np.ndarray:
        """Samples as the metric sees them, (n, c)."""
        if self.low_pass_hz is None:
            return samples
        return passed(samples, self.sample_rate, (self.high_pass_hz, self.low_pass_hz))

    def gain(self, frequency: np.ndarray) -> np.ndarray:
        """What the metric's filter makes of a sine of each frequency [Hz]."""
        if not self.filtered or self.low_pass_hz is None:
            return np.ones(np.shape(frequency))
        upper = 1.0 / (1.0 + (frequency / self.low_pass_hz) ** (2 * ORDER))
        if self.high_pass_hz <= 0.0:
            return np.asarray(upper)
        return np.asarray(upper / (1.0 + (self.high_pass_hz / np.maximum(frequency, 1e-9)) ** (2 * ORDER)))

    def __str__(self) -> str:
        lines = [f"{', '.join(self.names)}: {len(self.time)} samples at {self.sample_rate:.6g} Hz, by {self.metric}"]
        lines += [f"  refitted for this recording: {name} = {value:.4g}" for name, value in self.nuisances.items()]
        return "\n".join(lines)


def left_the_numbers(recording: str, effects: Iterable[str]) -> SimulationError:
    """What is raised where a model's answer is no number."""
    return SimulationError(
        f"what the model says of {recording} left the finite numbers, with effects {', '.join(effects) or 'none'}. "
        "Compare the size of what was measured with that of the parameters"
    )
