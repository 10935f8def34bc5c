"""What a swivel leaves that does not depend on its waveform: spectra, levels, extremes, and how sure they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import signal

BAND_HZ = (1.0, 50.0)  # of the contract's log_psd_db
WELCH = 0.53
"""Variance of a Welch density of T seconds (Hann, half overlapping, 1 Hz wide) is WELCH/T of its square."""
EXTREMES = (0.005, 0.5, 0.995)
PARTS = 4  # of a record, whose scatter says how far levels and extremes repeat


def mixes(channels: int) -> np.ndarray:
    """(m, channels) float: each channel, and sums and differences of every two.

    The density of a sum holds the real part of the cross spectrum, so that coherence and its sign are compared with
    the same means as power.
    """
    rows = list(np.eye(channels))
    for i in range(channels):
        for j in range(i + 1, channels):
            for sign in (1.0, -1.0):
                row = np.zeros(channels)
                row[i], row[j] = np.sqrt(0.5), sign * np.sqrt(0.5)
                rows.append(row)
    return np.array(rows)


@dataclass(frozen=True, eq=False)
class Look:
    """One run, or several of one kind averaged.

    Parameters
    ----------
    frequency : (k,) float [Hz]
    cross : (k, c, c) float
        Real part of the spectral matrix, one-sided [(m/s^2)^2/Hz].
    dof : float
        Degrees of freedom of each density: twice its squared mean over its variance.
    levels : (s,) float
        Means of the channels [m/s^2], then logarithms of upper and lower extremes over the median.
    level_variance : (s,) float
        Of ``levels``, from the scatter of a record's parts.
    """

    frequency: np.ndarray
    cross: np.ndarray
    dof: float
    levels: np.ndarray
    level_variance: np.ndarray

    def log_density(self, scale: np.ndarray, noise: np.ndarray | None = None) -> np.ndarray:
        """Natural logarithm of the density of every mix, (k, m) float.

        Parameters
        ----------
        scale : (c,) float [m/s^2]
            By which the channels are divided before they are mixed.
        noise : (c,) float [(m/s^2)^2/Hz]
            Added to the channels' densities.
        """
        cross = self.cross if noise is None else self.cross + np.diag(noise)
        mix = mixes(cross.shape[1]) / scale
        return np.log(np.maximum(np.einsum("mi,kij,mj->km", mix, cross, mix), 1e-30))


def look(samples: np.ndarray, sample_rate: float) -> Look:
    """Measure a run; samples : (n, c) float [m/s^2], at least two seconds long."""
    segment = round(sample_rate)
    window = signal.get_window("hann", segment)
    parts = sliding_window_view(samples.T, segment, axis=1)[:, :: segment // 2]  # (c, segments, segment)
    parts = (parts - parts.mean(axis=2, keepdims=True)) * (window / np.sqrt(sample_rate * np.sum(window**2)))
    frequency = np.fft.rfftfreq(segment, 1.0 / sample_rate)
    inside = (frequency >= BAND_HZ[0] - 1e-9) & (frequency <= min(BAND_HZ[1], 0.48 * sample_rate) + 1e-9)
    z = np.fft.rfft(parts, axis=2)[:, :, inside]
    cross = 2.0 * np.einsum("isk,jsk->kij", z, z.conj()).real / z.shape[1]
    levels = levels_of(samples)
    each = np.array([levels_of(part) for part in np.array_split(samples, PARTS)])
    variance = each.var(axis=0, ddof=1) / PARTS
    return Look(frequency[inside], cross, 2.0 * len(samples) / sample_rate / WELCH, levels, variance)


def levels_of(samples: np.ndarray) -> np.ndarray:
    """Means, and logarithms of upper and lower extremes over the median: (3 c,) float; samples : (n, c) float."""
    at = [round(share * (len(samples) - 1)) for share in EXTREMES]
    low, middle, high = np.partition(np.ascontiguousarray(samples.T), at, axis=1)[:, at].T
    upper, lower = np.log(np.maximum([high - middle, middle - low], 1e-6))
    return np.concatenate([samples.mean(axis=0), upper, lower])


def average(looks: list[Look]) -> Look:
    """Several runs of one kind as one."""
    if len(looks) == 1:
        return looks[0]
    share = np.array([one.dof for one in looks]) / sum(one.dof for one in looks)
    bins = min(len(one.frequency) for one in looks)
    return Look(
        looks[0].frequency[:bins],
        np.einsum("l,lkij->kij", share, np.array([one.cross[:bins] for one in looks])),
        float(sum(one.dof for one in looks)),
        np.einsum("l,ls->s", share, np.array([one.levels for one in looks])),
        np.einsum("l,ls->s", share**2, np.array([one.level_variance for one in looks])),
    )
