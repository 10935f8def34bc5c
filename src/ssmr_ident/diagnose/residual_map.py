"""Power of what is left over, over time and frequency, against what white noise gives.

Each cell is the mean of two sine-taper periodograms, under noise a chi-square with four degrees of freedom (two in
the lowest row and the highest, where sine and cosine are one). The threshold follows from its tail and the number of
cells (Bonferroni); that cells overlap makes it a little strict: at such heights, noise in neighbours is hardly shared.
Source: Riedel and Sidorenko, IEEE Trans. Signal Process. 43 (1995) 188 (sine tapers).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.stats import chi2

from ssmr_ident.diagnose.evidence import ResidualMap
from ssmr_ident.identify.fitting.joint import JointFit

Array = np.ndarray

TAPERS = 2
OVERLAP = 4
"""Windows that cover a sample."""

ONCE_IN = 100
FEWEST_VALID = 0.3
"""Share of a window that must count for it to be drawn."""


@dataclass(frozen=True, eq=False)
class Cells:
    """A map of one channel's whitened residual.

    Parameters
    ----------
    starts : (m,) int
        First sample of each window.
    length : int
        Samples of a window.
    power : (k, m) float
        Mean 1 under noise, in the equivalent of the rows with four degrees of freedom; nan where too little counts.
    threshold : float
        Exceeded by noise once in 100 maps at most.
    """

    starts: Array
    length: int
    power: Array
    threshold: float


def residual_maps(before: JointFit, after: JointFit | None, most: int = 3) -> tuple[ResidualMap, ...]:
    """Maps of the recordings and channels with most misfit.

    Parameters
    ----------
    before : JointFit
    after : JointFit or None
        On the same trials; None draws ``before`` twice.
    most : int
    """
    maps = []
    for index, channel in ranked(before)[:most]:
        trial = before.trials[index]
        first = cells(column(before, index, channel), counting(before, index, channel))
        second = first
        if after is not None:
            rest = trial.by_channel(trial.white_target - trial.whitened(after.simulated[index]))[:, channel]
            second = cells(rest, counting(before, index, channel))
        time, frequency = axes(first, trial.times[trial.lost :], trial.step)
        maps.append(
            ResidualMap(
                trial.name,
                trial.channels[channel],
                time,
                frequency,
                _decibel(first.power),
                _decibel(second.power),
                float(10.0 * np.log10(first.threshold)),
            )
        )
    return tuple(maps)


def ranked(fit: JointFit) -> list[tuple[int, int]]:
    """Trial and channel, most excess of residual power over its noise first."""
    pairs = [(i, c) for i, trial in enumerate(fit.trials) for c in range(len(trial.channels))]
    return sorted(pairs, key=lambda pair: -excess(fit, *pair))


def excess(fit: JointFit, index: int, channel: int) -> float:
    """Sum of squares beyond what noise is expected to leave, at least 0."""
    rest = column(fit, index, channel)
    return max(float(rest @ rest) - float(np.count_nonzero(counting(fit, index, channel))), 0.0)


def column(fit: JointFit, index: int, channel: int) -> Array:
    """Whitened residual of one channel, (n - lost,)."""
    return fit.trials[index].by_channel(fit.residuals[index])[:, channel]


def counting(fit: JointFit, index: int, channel: int) -> Array:
    """Which of its samples count, (n - lost,) bool."""
    trial = fit.trials[index]
    if trial.counts is None:
        return np.ones(len(trial.times) - trial.lost, dtype=bool)
    return trial.counts[trial.lost :, channel].astype(bool)


def cells(white: Array, counts: Array) -> Cells:
    """Power of a whitened residual, (n,), over windows and frequencies.

    Parameters
    ----------
    white : (n,) float
    counts : (n,) bool
    """
    count = len(white)
    length = int(np.clip(1 << round(np.log2(3.0 * np.sqrt(count))), 8, count))
    hop = max(1, length // OVERLAP)
    starts = np.arange(0, count - length + 1, hop)
    windows = starts[:, None] + np.arange(length)
    tapers = _tapers(length)
    spectra = np.fft.rfft(white[windows][:, None, :] * tapers, axis=-1)
    valid = counts[windows] @ np.mean(tapers**2, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        power = np.mean(np.abs(spectra) ** 2, axis=1).T / np.where(valid >= FEWEST_VALID, valid, np.nan)
    freedom = _freedom(length)
    tail = 1.0 / (ONCE_IN * power.size)
    limits = chi2.isf(tail, freedom) / freedom
    usual = float(chi2.isf(tail, 2 * TAPERS) / (2 * TAPERS))
    # rows with less freedom are lowered, so that one threshold holds for all
    return Cells(starts, length, power * (usual / limits)[:, None], usual)


def axes(found: Cells, times: Array, step: float) -> tuple[Array, Array]:
    """Centres of the windows [s] and frequencies [Hz]."""
    return times[found.starts] + 0.5 * step * (found.length - 1), np.fft.rfftfreq(found.length, step)


def _tapers(length: int) -> Array:
    places = np.arange(1, length + 1) / (length + 1)
    rows = [np.sin(np.pi * (k + 1) * places) for k in range(TAPERS)]
    return np.stack(rows) * np.sqrt(2.0 / (length + 1))


@lru_cache(maxsize=32)
def _freedom(length: int) -> Array:
    """Degrees of freedom per row of a map of white noise (Satterthwaite's, of a quadratic form of normal numbers)."""
    waves = np.exp(-2j * np.pi * np.outer(np.arange(length // 2 + 1), np.arange(length)) / length)
    freedom = np.empty(len(waves))
    for row, wave in enumerate(waves):
        parts = np.concatenate([_tapers(length) * wave.real, _tapers(length) * wave.imag])
        gram = parts @ parts.T
        freedom[row] = np.trace(gram) ** 2 / np.sum(gram**2)
    return freedom


def _decibel(power: Array) -> Array:
    return 10.0 * np.log10(np.maximum(power, 1e-3))
