"""Two loggers of one event, made in code: each with a rate, a start and a clock of its own."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, lsim, lti, sosfiltfilt

FINE = 2000.0
"""Hz at which an event is made before loggers sample it."""


@dataclass(frozen=True)
class Event:
    """A force or a base and what answers, on true time.

    Parameters
    ----------
    time : (n,) float [s]
    drive : (n,) float
    answer : dict of str to (n,) float
        Position, velocity, acceleration.
    """

    time: np.ndarray
    drive: np.ndarray
    answer: dict[str, np.ndarray]

    def logged(
        self, name: str, rate: float, start: float, ppm: float, noise: float, rng: np.random.Generator
    ) -> tuple[np.ndarray, np.ndarray]:
        """Stamps and samples of a logger that starts at ``start`` and whose clock is fast by ``ppm``."""
        truth = self.drive if name == "drive" else self.answer[name]
        true = start + np.arange(int((self.time[-1] - start) * rate / (1 + 1e-6 * ppm))) / rate * (1 - 1e-6 * ppm)
        samples = np.interp(true, self.time, truth)
        return (true - start) * (1 + 1e-6 * ppm), samples + noise * np.std(truth) * rng.standard_normal(len(true))


def event(
    rng: np.random.Generator,
    hertz: tuple[float, ...] = (5.0,),
    xi: float = 0.03,
    mass: float = 3.0,
    seconds: float = 20.0,
    band: tuple[float, float] = (0.5, 12.0),
    hits: tuple[float, ...] = (),
) -> Event:
    """Modes side by side under noise in a band, or under blows."""
    time = np.arange(round(seconds * FINE)) / FINE
    if hits:
        drive = sum(200.0 * np.exp(-(((time - at) / 0.004) ** 2)) for at in hits)
    else:
        drive = 100.0 * sosfiltfilt(butter(3, band, "bandpass", fs=FINE, output="sos"), rng.standard_normal(len(time)))
        drive *= np.minimum(1.0, time / 0.5)
    position, velocity = np.zeros_like(time), np.zeros_like(time)
    for number, one in enumerate(hertz):
        omega = 2.0 * math.pi * one
        swings = [[0, 1], [-(omega**2), -2 * xi * omega]]
        system = lti(swings, [[0], [1 / (mass * (1 + number))]], np.eye(2), np.zeros((2, 1)))
        _, states, _ = lsim(system, drive, time)
        position, velocity = position + states[:, 0], velocity + states[:, 1]
    return Event(time, drive, {"position": position, "velocity": velocity, "acceleration": np.gradient(velocity, time)})
