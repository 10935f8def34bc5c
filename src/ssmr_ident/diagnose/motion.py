"""What moved, from one channel: displacement and velocity whatever the sensor measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from ssmr_ident.identify.trials.trial import Trial

Array = np.ndarray

ORDER = {"position": 0, "angle": 0, "velocity": 1, "angular_rate": 1}
"""Derivatives of the displacement that a channel shows; all others show the second."""

LOWEST, PERIODS = 0.3, 1.5
"""Integration begins at this share of the main frequency, and no lower than this many periods in the recording:
below, a sensor's drift would be taken for motion."""

HIGHEST = 6.0
"""Times the main frequency, up to which derivatives are taken."""


@dataclass(frozen=True, eq=False)
class Motion:
    """One channel as a motion.

    Parameters
    ----------
    displacement, velocity : (n,) float
        In m and m/s, or rad and rad/s.
    frequency : float [Hz]
        Main frequency.
    place : str
        What moves, in words.
    units : (str, str, str)
        Of displacement, velocity and what pushes.
    """

    displacement: Array
    velocity: Array
    frequency: float
    place: str
    units: tuple[str, str, str]


def main_channel(trial: Trial) -> int:
    """The channel with the largest motion."""
    return int(np.argmax(trial.target.std(axis=0)))


def motion_of(trial: Trial, signal: Array, channel: int) -> Motion:
    """Displacement and velocity of a channel.

    Parameters
    ----------
    trial : Trial
    signal : (n,) float
        Measured or simulated, in the channel's unit.
    channel : int
    """
    name = trial.channels[channel]
    order = ORDER.get(name, 2)
    frequency = main_frequency(signal, trial.step, order)
    return Motion(
        integrated(signal, trial.step, order, frequency),
        integrated(signal, trial.step, order - 1, frequency),
        frequency,
        place(name),
        ("rad", "rad/s", "N m") if name.startswith("ang") else ("m", "m/s", "N"),
    )


def place(channel: str) -> str:
    """What a channel shows the displacement of, in words."""
    if channel in ("ax", "ay", "az"):
        return f"displacement at the accelerometer along {channel[1]} ({channel} integrated twice)"
    return {
        "position": "displacement",
        "angle": "angle",
        "velocity": "displacement (velocity integrated)",
        "angular_rate": "angle (rate integrated)",
    }.get(channel, "displacement (acceleration integrated twice)")


def main_frequency(signal: Array, step: float, order: int) -> float:
    """Where the velocity's spectrum has its middle [Hz]."""
    spectrum = np.abs(np.fft.rfft((signal - signal.mean()) * np.hanning(len(signal)))) ** 2
    frequency = np.fft.rfftfreq(len(signal), step)
    spectrum, frequency = spectrum[2:], frequency[2:]
    weight = np.cumsum(spectrum * frequency ** (2.0 * (1 - order)))
    return float(frequency[np.searchsorted(weight, 0.5 * weight[-1])])


def integrated(signal: Array, step: float, times: int, frequency: float) -> Array:
    """Integrated ``times`` times (differentiated where negative) between the lowest and highest frequency."""
    lowest = max(LOWEST * frequency, PERIODS / (step * len(signal))) if times > 0 else 0.0
    return filtered(signal, step, lambda s: s ** float(-times), lowest, HIGHEST * frequency)


def filtered(signal: Array, step: float, operator: Callable[[Array], Array], lowest: float, highest: float) -> Array:
    """A signal through ``operator(s)``, s = i·2π·f, within a band whose edges are a third of an octave wide.

    The ends are continued by their own mirror image turned about the end point, so that slopes go on smoothly.
    """
    return Band(len(signal), step, operator, lowest, highest)(signal)


class Band:
    """``filtered``, for many signals of one length."""

    def __init__(
        self, count: int, step: float, operator: Callable[[Array], Array], lowest: float, highest: float
    ) -> None:
        # no more mirror image than makes a length whose transform is quick
        total = 3 * count - 2
        while total > count + 2 and next_fast_len(total, real=True) != total:
            total -= 2
        self._count, self._reach = count, (total - count) // 2
        frequency = np.fft.rfftfreq(count + 2 * self._reach, step)
        mask = _edge(frequency, highest, falling=True)
        if lowest > 0.0:
            mask = mask * _edge(frequency, lowest, falling=False)
        self._gain = np.zeros(len(frequency), dtype=complex)
        inside = mask > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            self._gain[inside] = operator(2j * np.pi * frequency[inside]) * mask[inside]
        if not np.isfinite(self._gain[0]):
            self._gain[0] = 0.0
        ramp = np.vander(np.linspace(-1.0, 1.0, count), 2)
        self._line = np.linalg.qr(ramp)[0] if lowest > 0.0 else ramp[:, :0]

    def __call__(self, signal: Array) -> Array:
        middle = signal - self._line @ (self._line.T @ signal)
        reach = self._reach
        before, after = middle[reach:0:-1], middle[-2 : -reach - 2 : -1]
        padded = np.concatenate([2 * middle[0] - before, middle, 2 * middle[-1] - after])
        return irfft(rfft(padded) * self._gain, len(padded))[reach : reach + self._count]


def _edge(frequency: Array, corner: float, falling: bool) -> Array:
    with np.errstate(divide="ignore"):
        octaves = np.log2(np.maximum(frequency, 1e-300) / corner) / (1.0 / 3.0)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.clip(octaves + 0.5, 0.0, 1.0))
    return 1.0 - rise if falling else rise
