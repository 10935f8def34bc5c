"""Decaying modes fitted by variable projection: only the poles are non-linear, everything else is eliminated.

Why an own Gauss-Newton and not a general least-squares package: a decay has two non-linear parameters per mode
and many linear ones (an amplitude and a phase per channel and trial, an offset, the mains line). With the linear
ones eliminated the derivative columns are t·e^(st), so one Gram matrix per iteration gives the linear solution,
the Gauss-Newton step and the covariance. That costs about 0.2 ms per iteration at 2048 samples, some thirty
times less than a finite-difference fit of all parameters, and it cannot stop at a wrong amplitude.

Whitening costs nothing here: an FIR filter maps offset, mains line and damped sinusoids onto themselves with
other amplitudes, so it is enough to filter the data; poles stay (`noise.py` does that).

Source: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973), with Kaufman's step (BIT 15, 1975).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Block:
    """One record in a joint fit: a uniform grid, its channels and its linear nuisances.

    Parameters
    ----------
    start : float [s]
        Time of the first sample, from the moment that amplitudes refer to.
    step : float [s]
        Sample interval.
    samples : (n, c) float
        Each channel divided by its noise standard deviation.
    nuisances : (n, p) float
        Columns fitted beside the modes: offset, mains sine and cosine.
    """

    start: float
    step: float
    samples: Array
    nuisances: Array

    @property
    def times(self) -> Array:
        """(n,) float [s]."""
        return self.start + self.step * np.arange(len(self.samples))


@dataclass(frozen=True)
class PoleFit:
    """Poles and everything that was eliminated.

    Parameters
    ----------
    rates : (k,) float [1/s]
        Decay rates λ.
    frequencies : (k,) float [rad/s]
        Damped angular frequencies ω_d.
    information : (2k, 2k) float
        Of (λ_1, ω_1, λ_2, …), linear parameters eliminated, for unit noise.
    coefficients : tuple of (2k + p, c) float
        Per block: cosine and sine amplitude of each mode, then the nuisances.
    cost : float
        Sum of squared residuals, all blocks.
    samples : int
        Number of residuals.
    iterations : int
    converged : bool
    """

    rates: Array
    frequencies: Array
    information: Array
    coefficients: tuple[Array, ...]
    cost: float
    samples: int
    iterations: int
    converged: bool


def exponentials(block: Block, rates: Array, frequencies: Array) -> Array:
    """e^((−λ + iω)t) on the block's grid, (n, k) complex.

    A geometric sequence, so it is made as an outer product of two short ones: 2√n exponentials, not n.
    """
    count = len(block.samples)
    poles = -np.asarray(rates) + 1j * np.asarray(frequencies)
    fine = math.isqrt(count) + 1
    coarse = -(-count // fine)
    inner = np.exp(np.outer(np.arange(fine) * block.step, poles))
    outer = np.exp(np.outer(block.start + np.arange(coarse) * (fine * block.step), poles))
    result: Array = (outer[:, None, :] * inner[None, :, :]).reshape(-1, len(poles))[:count]
    return result


def solve_symmetric(matrix: Array, right: Array) -> Array:
    """Solution of a positive (semi-)definite system, scaled to a unit diagonal first.

    Falls back to the minimum-norm solution where two columns coincide (two modes that ran together).
    """
    scale = 1.0 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    scaled = matrix * scale[:, None] * scale[None, :]
    target = (right.T * scale).T
    try:
        solution = np.linalg.solve(scaled, target)
    except np.linalg.LinAlgError:
        solution = np.linalg.lstsq(scaled, target, rcond=1e-12)[0]
    return (solution.T * scale).T


def _block_system(block: Block, rates: Array, frequencies: Array) -> tuple[float, Array, Array, Array]:
    """Cost, gradient (2k,), information (2k, 2k) and linear coefficients of one block."""
    modes = len(rates)
    waves = exponentials(block, rates, frequencies)
    times = block.times[:, None]
    linear = 2 * modes + block.nuisances.shape[1]
    columns = np.hstack([waves.real, waves.imag, block.nuisances, times * waves.real, times * waves.imag])
    gram = columns.T @ columns
    right = columns.T @ block.samples
    inner, cross, outer = gram[:linear, :linear], gram[:linear, linear:], gram[linear:, linear:]
    solved = solve_symmetric(inner, np.hstack([right[:linear], cross]))
    channels = block.samples.shape[1]
    coefficients, projected = solved[:, :channels], solved[:, channels:]
    cost = float(np.sum(block.samples**2) - np.sum(right[:linear] * coefficients))
    left_over = outer - cross.T @ projected
    slope = right[linear:] - cross.T @ coefficients
    gradient = np.zeros(2 * modes)
    information = np.zeros((2 * modes, 2 * modes))
    for channel in range(channels):
        cosine, sine = coefficients[:modes, channel], coefficients[modes : 2 * modes, channel]
        # y = p Re z + q Im z gives dy/dλ = -t(p Re z + q Im z) and dy/dω = t(q Re z - p Im z).
        turn = np.zeros((2 * modes, 2 * modes))
        for k in range(modes):
            turn[k, 2 * k], turn[modes + k, 2 * k] = -cosine[k], -sine[k]
            turn[k, 2 * k + 1], turn[modes + k, 2 * k + 1] = sine[k], -cosine[k]
        gradient += turn.T @ slope[:, channel]
        information += turn.T @ left_over @ turn
    return cost, gradient, information, coefficients


def fit_poles(
    blocks: Sequence[Block],
    rates: Array,
    frequencies: Array,
    max_iterations: int = 40,
    tolerance: float = 1e-5,
) -> PoleFit:
    """Poles shared by all blocks and channels, by damped Gauss-Newton from one start.

    Parameters
    ----------
    blocks : sequence of Block
    rates, frequencies : (k,) float [1/s], [rad/s]
        Start.
    max_iterations : int
    tolerance : float
        Stops when the expected gain falls below this share of one unit of χ² (a thousandth of a standard
        deviation of any parameter is far below what noise leaves open).

    Returns
    -------
    PoleFit
    """
    point = np.column_stack([rates, frequencies]).ravel().astype(float)
    highest = math.pi / max(block.step for block in blocks)
    longest = max(block.step * len(block.samples) for block in blocks)

    def system(at: Array) -> tuple[float, Array, Array, tuple[Array, ...]]:
        parts = [_block_system(block, at[0::2], at[1::2]) for block in blocks]
        return (
            sum(part[0] for part in parts),
            sum((part[1] for part in parts), np.zeros(len(at))),
            sum((part[2] for part in parts), np.zeros((len(at), len(at)))),
            tuple(part[3] for part in parts),
        )

    def allowed(at: Array) -> bool:
        # Growth beyond e^3 over the record, or a frequency outside (0, Nyquist), is no decaying mode.
        return bool(np.all(at[1::2] > 0) and np.all(at[1::2] < highest) and np.all(at[0::2] * longest > -3.0))

    cost, gradient, information, coefficients = system(point)
    damping, converged, iterations = 0.0, False, 0
    residuals = sum(block.samples.size for block in blocks)
    while iterations < max_iterations:
        iterations += 1
        step = solve_symmetric(information + damping * np.diag(np.diag(information)), gradient)
        unit = max(cost, 1e-300) / residuals
        if float(gradient @ step) < tolerance * unit:
            converged = True
            break
        trial = point + step
        if allowed(trial):
            tried = system(trial)
            if tried[0] <= cost:
                point = trial
                cost, gradient, information, coefficients = tried
                damping = 0.0 if damping < 1e-3 else damping / 10
                continue
        damping = 1e-2 if damping == 0.0 else damping * 10
        if damping > 1e8:
            break
    order = np.argsort(point[1::2])
    shuffle = np.column_stack([2 * order, 2 * order + 1]).ravel()
    modes = len(order)
    rows = np.concatenate([order, modes + order])
    coefficients = tuple(np.vstack([part[rows], part[2 * modes :]]) for part in coefficients)
    return PoleFit(
        rates=point[0::2][order],
        frequencies=point[1::2][order],
        information=information[np.ix_(shuffle, shuffle)],
        coefficients=coefficients,
        cost=max(cost, 0.0),
        samples=residuals,
        iterations=iterations,
        converged=converged,
    )


def modelled(block: Block, fit: PoleFit, index: int) -> Array:
    """Fitted signal of block ``index``, (n, c)."""
    waves = exponentials(block, fit.rates, fit.frequencies)
    result: Array = np.hstack([waves.real, waves.imag, block.nuisances]) @ fit.coefficients[index]
    return result
