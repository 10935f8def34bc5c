"""Accelerometer and load cell: what stands between the motion and the log."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.kernel import kernel

THESIS_VOLTS_PER_M_S2 = 5.0 / (3.4 * 9.8)  # ±1.7 g over 5 V


@dataclass(frozen=True, eq=False)
class Accelerometer:
    """Three one-axis accelerometers on a cube.

    Parameters
    ----------
    position : (3,) float [m]
        p_a, from the CoM, body axes.
    volts_zero, volts_per_m_s2 : float [V], [V s^2/m]
        V = volts_zero + volts_per_m_s2 · a.
    range_m_s2 : float
        Clips beyond ± this.
    bandwidth_hz : float
        -3 dB point of a second-order Butterworth low-pass.
    polarity : (3,) float
        +1 or -1 per axis.
    gain : (3,) float
        What each axis reads of a true acceleration: sensitivities differ within their sheet.
    """

    position: np.ndarray = field(default_factory=lambda: np.array([-0.2, 0.0, 0.0]))
    volts_zero: float = 2.6
    volts_per_m_s2: float = THESIS_VOLTS_PER_M_S2
    range_m_s2: float = 1.7 * 9.8
    bandwidth_hz: float = 80.0
    polarity: np.ndarray = field(default_factory=lambda: np.ones(3))
    gain: np.ndarray = field(default_factory=lambda: np.ones(3))

    def to_volts(self, acceleration: np.ndarray, axis: int) -> np.ndarray:
        """Volts of one axis for a specific force, clipped at the range; (n,) [m/s^2] to (n,) [V]."""
        clipped = np.clip(self.polarity[axis] * acceleration, -self.range_m_s2, self.range_m_s2)
        return self.volts_zero + self.volts_per_m_s2 * clipped

    def to_acceleration(self, volts: np.ndarray, axis: int) -> np.ndarray:
        """Specific force of one axis from its volts; (n,) [V] to (n,) [m/s^2]."""
        return self.polarity[axis] * (volts - self.volts_zero) / self.volts_per_m_s2


def low_pass_coefficients(bandwidth_hz: float, step: float, order: float = 2.0) -> np.ndarray:
    """Butterworth low-pass as a difference equation (bilinear, frequency pre-warped).

    Parameters
    ----------
    bandwidth_hz : float [Hz]
        ``inf`` passes everything.
    step : float [s]
    order : float
        2, or 1.

    Returns
    -------
    (5,) float
        b0, b1, b2, a1, a2 of y = b0 u + b1 u' + b2 u'' - a1 y' - a2 y''.
    """
    if not math.isfinite(bandwidth_hz) or bandwidth_hz * step >= 0.45:
        return np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    k = math.tan(math.pi * bandwidth_hz * step)
    if order < 2.0:
        return np.array([k, k, 0.0, k - 1.0, 0.0]) / (1.0 + k)
    norm = 1.0 + math.sqrt(2.0) * k + k * k
    return np.array([k * k, 2 * k * k, k * k, 2 * (k * k - 1), 1 - math.sqrt(2.0) * k + k * k]) / norm


@kernel
def filter_step(history, axis, value, c):
    """One step of a second-order difference equation.

    Parameters
    ----------
    history : (k, 4) float
        Last two inputs and last two outputs of each axis; changed in place.
    axis : int
    value : float
    c : (5,) float
        As ``low_pass_coefficients`` gives them.
    """
    before, before_that = history[axis, 0], history[axis, 1]
    left, left_before = history[axis, 2], history[axis, 3]
    result = c[0] * value + c[1] * before + c[2] * before_that - c[3] * left - c[4] * left_before
    history[axis, 0], history[axis, 1], history[axis, 2], history[axis, 3] = value, before, result, left
    return result


@dataclass(frozen=True)
class Noise:
    """What a log adds to the motion.

    Parameters
    ----------
    white : float
        Standard deviation per sample, in the channel's SI unit.
    hum : float
        Amplitude of the mains line, same unit.
    hum_hz : float [Hz]
    quantum : float
        Step of the converter, in the unit of what is digitised (V for an accelerometer); 0 for none.
    """

    white: float = 0.0
    hum: float = 0.0
    hum_hz: float = 60.0
    quantum: float = 0.0

    def add(self, signal: np.ndarray, time: np.ndarray, random: np.random.Generator) -> np.ndarray:
        """The signal with white noise and hum of random phase; (n,) to (n,). Quantise last."""
        phase = random.uniform(0.0, 2.0 * np.pi)
        hum = self.hum * np.sin(2.0 * np.pi * self.hum_hz * time + phase)
        return signal + hum + self.white * random.standard_normal(signal.shape)


def quantise(signal: np.ndarray, quantum: float) -> np.ndarray:
    """Round to multiples of ``quantum``; unchanged for 0."""
    return signal if quantum == 0.0 else np.round(signal / quantum) * quantum
