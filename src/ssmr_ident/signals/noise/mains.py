"""Mains lines in samples: the fundamental to a fraction of a bin, and those of its harmonics that stand out."""

from __future__ import annotations

import math

import numpy as np

Array = np.ndarray

MAINS_HZ = (50.0, 60.0)
MAINS_SPREAD_HZ = 0.3
"""How far from its nominal frequency a mains line is sought; grids hold ±0.05 Hz, a logger's clock ±1e-3."""

HARMONICS = range(2, 10)
"""That are looked for: rectifiers draw odd ones, and a transformer's hum is the second."""

LOWEST_HZ = 5.0
"""Lines that seem slower at a low sampling rate are left: that is where motions are."""

FAINTEST = 12.0
"""Power of a line over the mean of bins nearby. Bins of noise are exponential in power; twelve means are passed by
chance once in 160 000."""

APART = 4.0
"""Bins from which on two lines are two: a tapered one is four bins wide."""


class _Periodogram:
    """Power of tapered samples, (n, c), at any frequency."""

    def __init__(self, samples: Array, step: float) -> None:
        count = len(samples)
        self.resolution = 1.0 / (count * step)
        self.highest = 0.45 / step - 2.0
        self._step, self._fine = step, math.isqrt(count) + 1
        rows = -(-count // self._fine)
        centred = np.zeros((rows * self._fine, samples.shape[1]))
        centred[:count] = (samples - samples.mean(axis=0)) * np.hanning(count)[:, None]
        # (channel, row, place): an exponential of all samples is the product of that of a row and that within it
        self._centred = np.ascontiguousarray(centred.reshape(rows, self._fine, -1).transpose(2, 0, 1))

    def power(self, frequency: float) -> float:
        turn = -2j * np.pi * frequency * self._step
        within = np.exp(turn * np.arange(self._fine))
        of_rows = self._centred @ np.column_stack([within.real, within.imag]) @ np.array([1.0, 1j])
        rows = np.exp(turn * self._fine * np.arange(of_rows.shape[1]))
        return float(np.sum(np.abs(of_rows @ rows) ** 2))

    def stands_out(self, frequency: float) -> bool:
        """Whether a line is far above the noise around it; False where the record is too short to tell."""
        if self.resolution > 4.0 or frequency > self.highest:
            return False
        around = [self.power(frequency + sign * k * self.resolution) for sign in (-1, 1) for k in (4.5, 6.5, 8.5)]
        return self.power(frequency) > FAINTEST * float(np.median(around)) / 0.69  # median of an exponential

    def refined(self, nominal: float) -> float:
        low, high = nominal - MAINS_SPREAD_HZ, nominal + MAINS_SPREAD_HZ
        grid = np.linspace(low, high, max(7, math.ceil((high - low) / (0.5 * self.resolution))))
        best = float(grid[int(np.argmax([self.power(f) for f in grid]))])
        width = min(0.25 * self.resolution, MAINS_SPREAD_HZ / 4)
        for _ in range(25):
            left, middle, right = (self.power(f) for f in (best - width, best, best + width))
            curvature = left - 2 * middle + right
            if curvature < 0:
                best += float(np.clip(0.5 * (left - right) / curvature, -1, 1)) * width
            width *= 0.5
        return best


def mains_lines(samples: Array, step: float, nominal: float, folds: bool = False) -> tuple[float, ...]:
    """Fundamental and harmonics [Hz] that stand above the noise around them, as they are seen at this sampling rate.

    A harmonic goes with the fundamental's own frequency, and without a fundamental there is none.

    Parameters
    ----------
    samples : (n, c) float
        A stretch without transients is best.
    step : float [s]
    nominal : float [Hz]
        50 or 60.
    folds : bool
        Lines above half of the rate are looked for as well, where they fold to. Not where a motion may be.
    """
    spectrum = _Periodogram(samples, step)
    half = np.inf if folds else 0.5 / step
    seen, sign = _folded(nominal, step)
    if nominal > half or seen < LOWEST_HZ or not spectrum.stands_out(seen):
        return ()
    found = spectrum.refined(seen)
    multiples = [order * (nominal + sign * (found - seen)) for order in HARMONICS]
    harmonics = [_folded(hz, step)[0] for hz in multiples if hz < half]
    lines = [found]
    for hz in sorted(harmonics, key=spectrum.power, reverse=True):
        # two that fold to one place are one line
        apart = min(abs(hz - line) for line in lines) > APART * spectrum.resolution
        if apart and hz > LOWEST_HZ and spectrum.stands_out(hz):
            lines.append(hz)
    return tuple(lines)


def any_mains_lines(samples: Array, step: float, folds: bool = False) -> tuple[float, ...]:
    """``mains_lines`` of both grids."""
    return tuple(line for nominal in MAINS_HZ for line in mains_lines(samples, step, nominal, folds))


def _folded(frequency: float, step: float) -> tuple[float, float]:
    """Where a line is seen in samples, and 1 or -1: whether it moves there with the true one, or against it."""
    apart = frequency - round(frequency * step) / step
    return abs(apart), float(np.sign(apart))


def nuisance_columns(times: Array, lines_hz: tuple[float, ...]) -> Array:
    """Offset, and sine and cosine of each line, (n, 1 + 2·lines)."""
    columns = [np.ones(len(times))]
    for line in lines_hz:
        phase = 2 * np.pi * line * times
        columns += [np.cos(phase), np.sin(phase)]
    return np.column_stack(columns)


def rest_after(samples: Array, times: Array, lines_hz: tuple[float, ...], share: float = 0.2) -> Array:
    """Samples with the offset and lines of their last part removed, (n, c); also tells noise from motion.

    Parameters
    ----------
    samples : (n, c) float
    times : (n,) float [s]
    lines_hz : tuple of float [Hz]
    share : float
        Last part of the record that is taken as being at rest.
    """
    columns = nuisance_columns(times, lines_hz)
    tail = slice(int(len(times) * (1 - share)), None)
    solution = np.linalg.lstsq(columns[tail], samples[tail], rcond=None)[0]
    result: Array = samples - columns @ solution
    return result


def without_mains(rest: Array, time: Array) -> tuple[Array, Array, Array]:
    """(n, c) samples less the mains lines that stand out of them; those, (k,) [Hz], and their waves, (2 k, c)."""
    lines = any_mains_lines(rest, float(time[1] - time[0]))
    columns = nuisance_columns(time, lines)
    waves = np.linalg.lstsq(columns, rest, rcond=None)[0][1:]
    return rest - columns[:, 1:] @ waves, np.array(lines), waves


def line_power(samples: Array, sample_rate: float, frequency: float) -> Array:
    """Mean square of a line of known frequency, (c,) float; samples : (n, c) float."""
    steps = np.arange(len(samples)) / sample_rate
    wave = np.exp(-2j * np.pi * frequency * steps)
    return np.asarray(2.0 * np.abs((wave[:, None] * samples).mean(axis=0)) ** 2)
