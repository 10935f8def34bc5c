"""What one sensor's record says of another's: a rational response with its transients, on the bins of one transform.

Bins of a record that is cut anywhere obey Y·D(s) = U·N(s) + T(s) exactly, T a polynomial for what was in motion at
both ends (Pintelon and Schoukens 2001, section 6.3.2); linear least squares, re-weighted (Sanathanan and Koerner 1963).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

Array = np.ndarray
Pair = tuple[Array, Array]

REWEIGHTINGS, LEVEL_ROUNDS = 4, 4
LEAST_DAMPING, MOST_DAMPING, MOST_STEPS = 1e-12, 1e6, 30
ENOUGH = 1e-6
"""Share of the misfit that a step must take off for another one to be made."""

FOLDED = 4
"""Choice: a cubic over 0.4 of the sampling rate leaves less than a hundredth of what is folded of 1/s."""

NEIGHBOURS = 12
"""Bins on each side over which a residual's power is taken as that of the noise there."""


@dataclass(frozen=True)
class Structure:
    """Powers of s in a response: ``order`` poles, and which powers stand above them.

    Parameters
    ----------
    order : int
        Two for each mode.
    above : tuple of int
        Powers of s in the numerator.
    """

    order: int
    above: tuple[int, ...]

    @property
    def transients(self) -> int:
        """Coefficients of T: as many as the response has memory, and a numerator of a higher degree edges; 1/s, for a
        zero that drifts; and some for what sampling folds of the jumps at both ends, which is smooth over the band."""
        return max(self.order, *self.above) + 1 + FOLDED

    @property
    def size(self) -> int:
        return self.order + len(self.above) + self.transients


STRUCTURES: tuple[Structure, ...] = (
    *(Structure(0, (power,)) for power in (0, 1, 2)),
    *(Structure(2, (power,)) for power in (0, 1, 2)),
    Structure(2, (0, 1, 2)),
    Structure(4, (2, 3, 4)),
    Structure(4, (0, 1, 2, 3, 4)),
)
"""The same thing felt twice, or its derivatives; one or two modes between what drives and what moves."""

ONE_MODE, TWO_MODES = Structure(2, (0, 1, 2)), STRUCTURES[-1]
"""Felt in any derivative: what a search is made with."""


def alone_of(structure: Structure) -> Structure:
    """The same modes ringing on by themselves, when the input is nought: what a record explains without the other."""
    return Structure(structure.order, (0,))


@dataclass(frozen=True)
class Response:
    """A fitted response.

    Parameters
    ----------
    structure : Structure
    coefficients : (size,) float
        Of D without its leading one, N, T, in powers of ``s`` over the highest bin's.
    residual : (k,) complex
        Of the output's bins.
    clock : (2,) float
        By how much the clocks were moved beside it: shift [s], drift [1].
    covariance : (2, 2) float
        Of ``clock``; not finite where it was not asked for.
    """

    structure: Structure
    coefficients: Array
    residual: Array
    clock: Array
    covariance: Array


def fitted_response(
    s: Array,
    u: Array,
    y: Array,
    weight: Array,
    structure: Structure,
    rounds: int = REWEIGHTINGS,
    first: Array | None = None,
) -> Response:
    """Linear least squares, re-weighted by the last denominator.

    Parameters
    ----------
    s : (k,) complex
        i·ω of the bins over the largest.
    u, y : (k,) complex
        Input and output.
    weight : (k,) float
        One over the standard deviation of the output's error.
    structure : Structure
    rounds : int
    first : (k,) float, optional
        Size of the denominator by which the first one is weighted: where modes are expected. Without, the highest bins
        count most, by the power of s that is the order.
    """
    basis = _Basis.of(s, structure)
    last = np.ones(len(s)) if first is None else first
    best, least = np.zeros(structure.size), np.inf
    for _ in range(rounds if structure.order else 1):
        scale = weight / last
        design = np.hstack([-y[:, None] * basis.poles[:, :-1], u[:, None] * basis.zeros, basis.ends])
        found = _real_least_squares(design * scale[:, None], y * basis.poles[:, -1] * scale)
        d, n, t = basis.parts(found)
        last = np.maximum(np.abs(d), 1e-9)
        cost = float(np.sum((weight * np.abs(y - (n * u + t) / d)) ** 2))
        if cost < least:
            best, least = found, cost
    d, n, t = basis.parts(best)
    return Response(structure, best, y - (n * u + t) / d, np.zeros(2), np.full((2, 2), np.inf))


def with_clock(
    s: Array,
    bins: Callable[[Array], tuple[Pair, Pair]],
    start: Response,
    clock: Array,
    weight: Array,
    drift_std: float,
) -> Response:
    """The response together with shift and drift of the clocks, by damped Gauss-Newton steps.

    Parameters
    ----------
    s : (k,) complex
    bins : callable
        From (shift, drift) to the bins (input, output), and what both move by over shift and drift, each (2, k).
    start : Response
    clock : (2,) float [s], [1]
    weight : (k,) float
    drift_std : float
        What is known of the drift beforehand: none, give or take this.
    """
    basis = _Basis.of(s, start.structure)

    def asked(theta: Array, moved: Array) -> tuple[Array, Array, Callable[[], Array]]:
        (u, y), (slope_u, slope_y) = bins(moved)
        d, n, t = basis.parts(theta)
        model = (n * u + t) / d
        rest = y - model

        def jacobian() -> Array:
            columns = [(model / d)[:, None] * basis.poles[:, :-1], -(u / d)[:, None] * basis.zeros]
            columns += [-basis.ends / d[:, None], (slope_y - n / d * slope_u).T]
            table = np.hstack(columns) * weight[:, None]
            known = np.zeros(table.shape[1])
            known[-1] = 1.0 / drift_std
            return np.vstack([table.real, table.imag, known])

        white = weight * rest
        return rest, np.concatenate([white.real, white.imag, [moved[1] / drift_std]]), jacobian

    theta, moved = start.coefficients, np.asarray(clock, float)
    left, white, jacobian = asked(theta, moved)
    damping, gained, steps = 1e-3, True, 0
    while gained and damping > LEAST_DAMPING and steps < MOST_STEPS:
        steps += 1
        table = jacobian()
        size = np.linalg.norm(table, axis=0) + 1e-300
        table /= size
        gram, gradient = table.T @ table, table.T @ white
        gained = False
        while not gained and damping < MOST_DAMPING:
            step = -np.linalg.solve(gram + damping * np.eye(len(gram)), gradient) / size
            tried = asked(theta + step[:-2], moved + step[-2:])
            gain = 1.0 - (tried[1] @ tried[1]) / (white @ white)
            damping *= 0.1 if gain > 0 else 10.0
            gained = gain > 0
        if gained:
            theta, moved, (left, white, jacobian) = theta + step[:-2], moved + step[-2:], tried
            gained = gain > ENOUGH
    covariance = np.linalg.pinv(gram)[-2:, -2:] / np.outer(size[-2:], size[-2:])
    return Response(start.structure, theta, left, moved, covariance)


def error_level(response: Response, s: Array) -> Array:
    """Standard deviation of a bin's error, real and imaginary part each, (k,) float.

    Both sensors are noisy, and the response carries the first one's noise, most of it near its resonance: the power of
    the residual is a sum of both, times what its neighbours show beside that.
    """
    basis = _Basis.of(s, response.structure)
    d, n, _ = basis.parts(response.coefficients)
    columns = np.stack([np.ones(len(s)), np.abs(n / d) ** 2], axis=1)
    power = np.abs(response.residual) ** 2
    level = np.full(len(s), max(float(np.mean(power)), 1e-300))
    for _ in range(LEVEL_ROUNDS):
        share = nnls(columns / level[:, None], power / level)[0]
        level = np.maximum(columns @ share, 1e-12 * float(np.max(power)) + 1e-300)
    width = min(2 * NEIGHBOURS + 1, 2 * ((len(s) - 1) // 2) + 1)
    padded = np.pad(power / level, width // 2, mode="reflect")
    return np.sqrt(0.5 * level * np.convolve(padded, np.ones(width) / width, mode="valid"))


@dataclass(frozen=True, eq=False)
class _Basis:
    """Powers of s that D, N and T are made of, (k, ...) complex each."""

    poles: Array
    zeros: Array
    ends: Array

    @staticmethod
    def of(s: Array, structure: Structure) -> _Basis:
        powers = s[:, None] ** np.arange(max(structure.order, *structure.above) + 1)
        degrees = np.arange(structure.transients - 1)
        # polynomials of s with real coefficients, well apart: Chebyshev's of ω, times i to their degree
        smooth = np.cos(degrees * np.arccos(s.imag[:, None])) * 1j**degrees
        ends = np.hstack([s[:1].imag / s[:, None], smooth])
        return _Basis(powers[:, : structure.order + 1], powers[:, list(structure.above)], ends)

    def parts(self, theta: Array) -> tuple[Array, Array, Array]:
        """D, N and T at the bins."""
        first = self.poles.shape[1] - 1
        second = first + self.zeros.shape[1]
        d = self.poles[:, :-1] @ theta[:first] + self.poles[:, -1]
        d[np.abs(d) < 1e-12] = 1e-12
        return d, self.zeros @ theta[first:second], self.ends @ theta[second:]


def _real_least_squares(design: Array, right: Array) -> Array:
    """Real coefficients of complex columns, by the normal equations of scaled columns."""
    size = np.sqrt(np.sum(np.abs(design) ** 2, axis=0))
    size[size == 0.0] = 1.0
    scaled = design / size
    gram = (scaled.conj().T @ scaled).real
    result: Array = np.linalg.lstsq(gram, (scaled.conj().T @ right).real, rcond=1e-13)[0] / size
    return result
