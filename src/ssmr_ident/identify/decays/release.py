"""The moment of release: from where on a record is a free decay."""

from __future__ import annotations

import numpy as np

from ssmr_ident.identify.decays.poles import Block, fit_poles, modelled
from ssmr_ident.identify.decays.start import spectral_poles
from ssmr_ident.signals.noise import median_std, nuisance_columns, rest_after

Array = np.ndarray


def find_release(samples: Array, step: float, lines_hz: tuple[float, ...] = ()) -> int:
    """Index of the first sample that belongs to the decay.

    Parameters
    ----------
    samples : (n, c) float
        One record; the motion must have died down, or nearly so, at its end.
    step : float [s]
    lines_hz : tuple of float [Hz]
        Lines to eliminate.

    Returns
    -------
    int
        0 where the record begins within the decay.

    Notes
    -----
    A decay is fitted from the largest excursion on, where it is a decay for certain, and continued backwards
    as long as the record follows it, over a sixteenth of a period: within the noise and 3 % of the envelope
    (what the continued fit itself is uncertain by). Fast modes live near the release only, so the continuation
    is repeated with two and three modes. A late answer costs a little information; an early one would bias.
    """
    count = len(samples)
    times = step * np.arange(count)
    rest = rest_after(samples, times, lines_hz)
    last = rest[int(0.8 * count) :]
    noise = median_std(last) + 1e-12 * np.max(np.abs(rest))
    loud = int(np.argmax(np.max(np.abs(rest), axis=0) / noise))
    signal, level = rest[:, loud], float(noise[loud])
    width = max(1, round(0.004 / step))
    smooth = np.convolve(np.abs(signal), np.ones(width) / width, mode="same")
    peak = int(np.argmax(smooth))
    if smooth[peak] < 5 * level or count - peak < 32:
        return 0
    release = peak
    for modes in (1, 2, 3):
        release = min(release, _continued_back(signal, level, step, lines_hz, release, modes))
        if release == 0:
            break
    return release


def _continued_back(
    signal: Array, level: float, step: float, lines_hz: tuple[float, ...], begin: int, modes: int
) -> int:
    """First sample up to which a fit from ``begin`` on can be continued backwards.

    Parameters
    ----------
    signal : (n,) float
    level : float
        Standard deviation of its noise.
    begin : int
    modes : int
        Fast modes live near the release only, so one mode alone stops too early.
    """
    times = step * (np.arange(len(signal)) - begin)
    columns = nuisance_columns(times, lines_hz)
    block = Block(0.0, step, signal[begin:, None], columns[begin:])
    poles = np.empty(0, complex)
    left = block.samples
    fit = None
    for _ in range(modes):
        starts = [spectral_poles(left, step, 1, bins) for bins in (4, 12)]
        starts = [np.concatenate([poles, pole]) for pole in starts if len(pole) and pole[0].imag > 0]
        fits = [
            fit_poles([block], np.clip(-pole.real, 1e-3 * pole.imag, 0.5 * pole.imag), pole.imag, max_iterations=12)
            for pole in starts
        ]
        if not fits:
            break
        fit = min(fits, key=lambda candidate: candidate.cost)
        poles = -fit.rates + 1j * fit.frequencies
        left = block.samples - modelled(block, fit, 0)
    if fit is None:
        return begin
    sizes = np.hypot(fit.coefficients[0][: len(poles), 0], fit.coefficients[0][len(poles) : 2 * len(poles), 0])
    main = int(np.argmax(sizes))
    window = max(3, round(2 * np.pi / float(fit.frequencies[main]) / 16 / step))
    if begin < window:
        return 0
    before = Block(float(times[0]), step, signal[:begin, None], columns[:begin])
    excess = (signal[:begin] - modelled(before, fit, 0)[:, 0]) ** 2
    square = np.convolve(excess, np.ones(window) / window, mode="valid")
    envelope = np.exp(-fit.rates[main] * times[window - 1 : begin]) * sizes[main]
    allowance = (5 * level) ** 2 / window + level**2 + (0.03 * envelope) ** 2
    wrong = np.flatnonzero(square > allowance)
    return int(wrong[-1] + window) if len(wrong) else 0
