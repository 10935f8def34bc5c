"""Decays of the robot's body prepared for output error: block averages, whitened, offset and mains line taken out.

A block average is an FIR filter followed by decimation. It keeps white noise white and maps every decaying mode
onto itself with another amplitude, so nothing is approximated; what is lost lies above the block rate's half.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.identify.decays.record import Record, prepare
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.signals.noise import AutoregressiveNoise, fit_noise, nuisance_columns, white_noise

Array = np.ndarray

BLOCK_RATE_HZ = 200.0
"""Of the block averages. The body's fastest mode lies near 20 Hz; block averages lose 2 % of its amplitude there."""

SETTLED = 1e-3
"""Share to which the accelerometer's own transient must have died before samples count."""

LARGEST_ORDER = 8
"""Of the autoregressive noise model of block averages."""


@dataclass(frozen=True, eq=False)
class BodyDecay:
    """One decay on its block grid.

    Parameters
    ----------
    name : str
    axes : tuple of int
        Which of ax, ay, az (0, 1, 2) the columns are.
    samples : (n, c) float [m/s^2]
        Block averages.
    first : float [s]
        Middle of the first block, from the release.
    step : float [s]
        Between blocks.
    block : int
        Samples averaged into one.
    record : Record
        All samples from the release on.
    noises : tuple of AutoregressiveNoise
        Per column, of the block averages.
    """

    name: str
    axes: tuple[int, ...]
    samples: Array
    first: float
    step: float
    block: int
    record: Record
    noises: tuple[AutoregressiveNoise, ...]

    @property
    def lost(self) -> int:
        """Blocks that the whitening filters' start-up takes."""
        return max(noise.order for noise in self.noises)

    @cached_property
    def times(self) -> Array:
        """(n − lost,) float [s], middles of the blocks that count."""
        return self.first + self.step * np.arange(self.lost, len(self.samples))

    def whitened(self, samples: Array) -> Array:
        """(n, c) of this grid to (n − lost, c) in units of the noise."""
        columns = [
            noise.whiten(samples[:, index])[self.lost - noise.order :] for index, noise in enumerate(self.noises)
        ]
        return np.column_stack(columns)

    def nuisances(self) -> Array:
        """Orthonormal columns of offset and mains lines, (n − lost, p).

        Each line may grow, fall or drift in phase linearly over the record: a strong one, whose frequency is known to
        a few parts in a million, would otherwise leave more than the noise behind.
        """
        times = self.times
        columns = nuisance_columns(times, self.record.lines)
        middle = (times - times.mean())[:, None] / np.ptp(times)
        return np.linalg.qr(np.hstack([columns, middle * columns[:, 1:]]))[0]

    def averaged(self, signals: Array, rows: Array | None = None, gains: Array | None = None) -> Array:
        """Block averages of signals on the record's own grid.

        Parameters
        ----------
        signals : (j, m, c) float
        rows : (k,) int, optional
            Which of them, maybe one several times; each once otherwise.
        gains : (k, c) float, optional
            By which each is multiplied.

        Returns
        -------
        (k, n, c) float

        Raises
        ------
        ValueError
            Signals end before the last block does.
        """
        skip = round((self.first - (self.block - 1) / 2 * self.record.step) / self.record.step)
        if signals.shape[1] < skip + len(self.samples) * self.block:
            raise ValueError(f"{signals.shape[1]} samples; blocks need {skip + len(self.samples) * self.block}")
        rows = np.arange(len(signals)) if rows is None else rows
        gains = np.ones((len(rows), signals.shape[2])) if gains is None else gains
        means = np.empty((len(rows), len(self.samples), signals.shape[2]))
        _block_means(np.ascontiguousarray(signals), rows, gains, skip, self.block, means)
        return means

    def averaging(self, poles: Array) -> Array:
        """What block averaging makes of e^(st), (k,) complex."""
        lags = self.record.step * (np.arange(self.block) - (self.block - 1) / 2)
        result: Array = np.exp(np.outer(poles, lags)).mean(axis=1)
        return result

    def whitening(self, poles: Array) -> Array:
        """What the whitening filters make of e^(st), (c, k) complex."""
        rows = np.empty((len(self.noises), len(poles)), complex)
        for row, noise in zip(rows, self.noises, strict=True):
            row[:] = noise.gain(poles, self.step) / noise.std if noise.order else 1.0 / noise.std
        return rows

    def with_noise_of(self, residual: Array, spent: int) -> BodyDecay:
        """The same with noise models taken from a residual's second half.

        Parameters
        ----------
        residual : (n, c) float [m/s^2]
            Of the block averages.
        spent : int
            Parameters fitted per column.
        """
        tail = residual[len(residual) // 2 :]
        return replace(
            self, noises=tuple(fit_noise(tail[:, c], LARGEST_ORDER, spent // 2) for c in range(tail.shape[1]))
        )

    def trusted_less(self, sizes: Array) -> BodyDecay:
        """The same with each column's noise taken ``sizes`` times as large, (c,) float."""
        return replace(
            self,
            noises=tuple(noise.louder(float(size)) for noise, size in zip(self.noises, sizes, strict=True)),
        )


def blocks_of(step: float, bandwidth_hz: float) -> tuple[int, int]:
    """Samples of a log that are averaged into a block, and those after a release that its accelerometer's own transient
    takes."""
    block = max(1, round(1.0 / (BLOCK_RATE_HZ * step)))
    if low_pass_coefficients(bandwidth_hz, step)[0] == 1.0:
        return block, 0
    # Poles of a second-order Butterworth lie at ω_c·(−1 ± i)/√2.
    return block, math.ceil(-math.log(SETTLED) / (2 * math.pi * bandwidth_hz / math.sqrt(2.0)) / step)


def body_decay(
    name: str, time: Array, channels: Sequence[tuple[int, Array]], bandwidth_hz: float, mains_hz: float | None = 60.0
) -> BodyDecay:
    """Prepare one recording.

    Parameters
    ----------
    name : str
    time : (n,) float [s]
    channels : sequence of (axis, (n,) float [m/s^2])
    bandwidth_hz : float
        Of the accelerometer, whose transient is waited for.
    mains_hz : float or None

    Raises
    ------
    InputError
        As ``fit_decay``.
    """
    record = prepare(time, np.column_stack([samples for _, samples in channels]), None, mains_hz, 0)
    block, skip = blocks_of(record.step, bandwidth_hz)
    count = (len(record.samples) - skip) // block
    samples = record.samples[skip : skip + count * block].reshape(count, block, -1).mean(axis=1)
    noises = tuple(white_noise(samples[:, c]) for c in range(samples.shape[1]))
    first = (skip + (block - 1) / 2) * record.step
    return BodyDecay(
        name, tuple(axis for axis, _ in channels), samples, first, block * record.step, block, record, noises
    )


@kernel
def _block_means(signals: Array, rows: Array, gains: Array, skip: int, block: int, means: Array) -> None:
    """What ``mean`` gives of ``gains * signals[rows]`` over its blocks, whose short last axis numpy takes many times as
    long for."""
    for k in range(len(rows)):
        signal = signals[rows[k]]
        for n in range(means.shape[1]):
            begin = skip + n * block
            for c in range(means.shape[2]):
                gain = gains[k, c]
                total = signal[begin, c] * gain
                for i in range(begin + 1, begin + block):
                    total += signal[i, c] * gain
                means[k, n, c] = total / block
