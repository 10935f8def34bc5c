"""From the motion to the log: low-pass, range, noise, mains, converter; a load cell that drifts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, lfilter, lfilter_zi

MAINS_HZ = 60.0


@dataclass(frozen=True)
class Chain:
    """What stands between a quantity and its log.

    Parameters
    ----------
    white : float
        Standard deviation per sample, in the quantity's unit, as are ``hum``, ``range`` and ``zero_drift`` (per s).
    hum : float
        Amplitude of the mains line.
    bandwidth_hz : float [Hz]
        -3 dB point of a second-order Butterworth low-pass; ``inf`` for none.
    range : float
        Clips beyond ± this.
    zero_drift : float
    gain_drift : float [1/s]
    """

    white: float
    hum: float = 0.0
    bandwidth_hz: float = np.inf
    range: float = np.inf
    zero_drift: float = 0.0
    gain_drift: float = 0.0

    def clean(self, fine: np.ndarray, fine_rate: float, stride: int) -> np.ndarray:
        """What the sensor gives without noise, every ``stride``-th of (n,) or (n, c) fine samples."""
        if np.isfinite(self.bandwidth_hz):
            forward, back = butter(2, self.bandwidth_hz, fs=fine_rate)
            settled = np.multiply.outer(lfilter_zi(forward, back), fine[0])
            fine = lfilter(forward, back, fine, axis=0, zi=settled)[0]
        samples = np.clip(fine[::stride], -self.range, self.range)
        if self.zero_drift or self.gain_drift:
            t = np.arange(len(samples)) * stride / fine_rate
            samples = samples * (1.0 + self.gain_drift * t) + self.zero_drift * t
        result: np.ndarray = samples
        return result

    def noisy(self, clean: np.ndarray, rate: float, random: np.random.Generator) -> np.ndarray:
        """The same with white noise and a mains line of its own phase on each channel."""
        columns = clean.reshape(len(clean), -1)
        t = np.arange(len(clean))[:, None] / rate
        phase = random.uniform(0.0, 2.0 * np.pi, columns.shape[1])
        disturbed = columns + self.hum * np.sin(2.0 * np.pi * MAINS_HZ * t + phase)
        return (disturbed + self.white * random.standard_normal(columns.shape)).reshape(clean.shape)


def converted(volts: np.ndarray, span: float = 5.0, bits: int = 12) -> np.ndarray:
    """What a converter over 0 … ``span`` V makes of volts."""
    quantum = span / 2**bits
    result: np.ndarray = np.round(np.clip(volts, 0.0, span - quantum) / quantum) * quantum
    return result
