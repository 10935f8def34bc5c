"""Process noise: a white disturbance that reaches a channel through the system itself, beside the channel's own."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.signal import lfilter, periodogram

from ssmr_ident.signals.noise.autoregressive import AutoregressiveNoise, burg_noise

Array = np.ndarray

RATIOS = (-9.0, 40.0)
"""Limits of the logarithm of disturbance over the channel's own noise, at the frequency where it is largest."""


def process_noise(
    parts: Sequence[Array], numerator: Array, denominator: Array, largest_order: int = 24, spent: int = 0
) -> AutoregressiveNoise:
    """Noise of a channel of which a part comes through a linear system.

    A force that is measured with noise, or a shaking floor, moves a mass on a spring most at its resonance: a line in
    what a fit leaves, far narrower than an autoregressive model of low order can draw.

    Parameters
    ----------
    parts : sequence of (n,) float
        What a fit leaves, each part from a start of its own.
    numerator, denominator : (k + 1,) float
        Of the system from disturbance to channel, in falling powers of z; the denominator's first is 1.
    largest_order : int
        Of the autoregressive part.
    spent : int
        Degrees of freedom that a fit took out of the samples.

    Returns
    -------
    AutoregressiveNoise
        With a moving average where Schwarz's criterion prefers it.

    Notes
    -----
    The ratio of the two densities by Whittle's likelihood, the minimum-phase factor of their sum, and an autoregressive
    model of what that leaves. Source: Priestley, Spectral Analysis and Time Series (1981), sections 6.1.5 and 10.1.
    """
    whole = np.concatenate([part - part.mean() for part in parts])
    plain = burg_noise(whole, largest_order, spent)
    # through the denominator what adds up is stationary: as it is, its slow part would leak into all the rest
    longest = lfilter(denominator, [1.0], max(parts, key=len))[len(denominator) - 1 :]
    frequency, power = periodogram(longest, detrend=False)
    z, power = np.exp(2j * math.pi * frequency[1:]), power[1:]
    own, through = (np.abs(np.polyval(c, z)) ** 2 for c in (denominator, numerator))
    peak = float((through / own).max())
    if not power.any():
        return plain

    def deviance(log_ratio: float) -> float:
        density = own + math.exp(log_ratio) / peak * through
        return float(np.sum(np.log(density)) + len(power) * math.log(np.mean(power / density)))

    ratio = math.exp(minimize_scalar(deviance, bounds=RATIOS, method="bounded").x) / peak
    moving = minimum_phase(denominator, numerator, ratio)
    # from its start what adds up in a part has nothing to be off by; off its mean it would begin with a blow
    filtered = np.concatenate([lfilter(denominator, moving, part) for part in parts])
    rest = burg_noise(filtered, largest_order, spent + 1)
    count = len(whole)
    gained = 2.0 * count * math.log(plain.std / rest.std) + (plain.order - rest.order - 1) * math.log(count)
    if not gained > 0.0:
        return plain
    return AutoregressiveNoise(np.convolve(rest.filter, denominator), rest.std, rest.least, moving)


def minimum_phase(first: Array, second: Array, ratio: float) -> Array:
    """c with c(z) c(1/z) proportional to a(z) a(1/z) + ratio b(z) b(1/z), zeros within the unit circle, c_0 = 1."""
    both = np.convolve(first, first[::-1]) + ratio * np.convolve(second, second[::-1])
    zeros = np.roots(both)
    inner = zeros[np.argsort(np.abs(zeros))][: len(first) - 1]
    return np.real(np.poly(inner))
