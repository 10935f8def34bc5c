"""Frequency and damping over amplitude: does a decay keep its mode, or does it drift as the motion dies?

Windows of a few periods are fitted on their own. A frequency that rises with amplitude is a hardening spring, one
that falls a softening one; damping that rises as the amplitude falls is dry friction (ξ ~ 1/A), damping that
grows with amplitude is quadratic (ξ ~ A).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.decays.poles import Block, fit_poles, modelled
from ssmr_ident.identify.decays.result import DecayFit
from ssmr_ident.signals.noise import nuisance_columns

Array = np.ndarray

PERIODS, FALL = 2.5, 0.2
"""That a window lasts at least, a third of a short record but one period; and by which share a motion falls in it, for
a window in which it does not fall tells no damping."""


@dataclass(frozen=True)
class Backbone(Shown):
    """Local modes along a decay.

    Parameters
    ----------
    amplitude : (w,) float [unit of the signal]
        At the middle of each window, falling.
    omega_n, omega_n_std : (w,) float [rad/s]
    xi, xi_std : (w,) float [1]
    small_omega_n, small_omega_n_std : float [rad/s]
        Continued to amplitude 0 by a polynomial in the amplitude's square.
    omega_trend_p, xi_trend_p : float
        Chance of such a trend with amplitude where there is none.
    """

    amplitude: Array
    omega_n: Array
    omega_n_std: Array
    xi: Array
    xi_std: Array
    small_omega_n: float
    small_omega_n_std: float
    omega_trend_p: float
    xi_trend_p: float

    @property
    def mean_xi(self) -> tuple[float, float]:
        """Mean damping of the windows and its standard deviation; windows overlap by half."""
        weight = self.xi_std**-2.0
        return float(weight @ self.xi / weight.sum()), float(np.sqrt(2.0 / weight.sum()))

    def __str__(self) -> str:
        lines = ["  amplitude   omega_n rad/s          xi"]
        for row in zip(self.amplitude, self.omega_n, self.omega_n_std, self.xi, self.xi_std, strict=True):
            lines.append("  {:9.4g}   {:8.4f} ± {:<8.2g}  {:<9.4g} ± {:.2g}".format(*row))
        lines.append(f"  small amplitudes: {self.small_omega_n:.4f} ± {self.small_omega_n_std:.2g} rad/s")
        return "\n".join(lines)


def backbone(time: Array, samples: Array, fit: DecayFit, channel: int = 0) -> Backbone | None:
    """Local frequency and damping of the dominant mode.

    Parameters
    ----------
    time : (n,) float [s]
    samples : (n,) or (n, c) float
        The record that was fitted.
    fit : DecayFit
        Of this record alone.
    channel : int

    Returns
    -------
    Backbone, or None where fewer than four windows stand above the noise.
    """
    samples = np.asarray(samples, float)
    series = samples if samples.ndim == 1 else samples[:, channel]
    step = float(time[-1] - time[0]) / (len(time) - 1)
    begin = int(np.searchsorted(time, fit.starts_s[0] - step / 2))
    mode = fit.dominant
    lines = () if fit.mains_hz[0] is None else (fit.mains_hz[0],)
    # Other modes and offset come from the whole record, so that short windows need not find them.
    columns = nuisance_columns(time - time[begin], lines)[:, 1:]
    others = np.zeros(len(series))
    for other in fit.modes:
        if other is not mode:
            turn = other.omega_n * np.sqrt(max(1 - other.xi**2, 0.0))
            since = np.maximum(time - time[begin], 0.0)
            others += (
                other.amplitudes[0, channel]
                * np.exp(-other.decay_rate * since)
                * np.sin(turn * since + other.phases[0, channel])
            )
    cleaned = series - others - fit.offsets[0, channel]
    return along(
        cleaned[begin:], step, mode.omega_n, mode.xi, fit.noise_stds[0, channel], columns[begin:] if lines else None
    )


def along(
    samples: Array, step: float, natural: float, ratio: float, noise: float, lines: Array | None = None
) -> Backbone | None:
    """Local frequency and damping of a single mode.

    Parameters
    ----------
    samples : (n,) float
        From its release on, about zero.
    step : float [s]
    natural : float [rad/s]
    ratio : float
        Frequency and damping ratio of the whole record.
    noise : float
        Standard deviation of white noise.
    lines : (n, k) float, optional
        What every window has besides: mains lines.

    Returns
    -------
    Backbone, or None where fewer than four windows stand above the noise.
    """
    frequency, rate = natural * np.sqrt(max(1 - ratio**2, 1e-6)), ratio * natural
    period = 2 * np.pi / frequency / step
    wanted = max(PERIODS * period, FALL / max(rate * step, 1e-300))
    width = max(24, round(min(wanted, max(period, len(samples) / 3))))
    found = []
    for first in range(0, len(samples) - width, max(1, width // 2)):
        part = slice(first, first + width)
        nuisances = np.zeros((width, 0)) if lines is None else lines[part]
        block = Block(0.0, step, samples[part, None], nuisances)
        local = fit_poles([block], np.array([rate]), np.array([frequency]))
        size = float(np.hypot(*local.coefficients[0][:2, 0]))
        turn, fall = float(local.frequencies[0]), float(local.rates[0])
        if not local.converged or size * np.exp(-fall * width * step) < 3 * noise or not 0.3 < turn / frequency < 3:
            break
        residual = block.samples - modelled(block, local, 0)
        variance = max(float(np.sum(residual**2)) / (width - 4), noise**2)
        spread = np.linalg.inv(local.information) * variance
        own = float(np.hypot(turn, fall))
        jacobian = np.array([[fall / own, turn / own], [turn**2 / own**3, -fall * turn / own**3]])
        stds = np.sqrt(np.diag(jacobian @ spread @ jacobian.T))
        found.append((size * np.exp(-fall * width * step / 2), own, stds[0], fall / own, stds[1]))
    if len(found) < 4:
        return None
    amplitude, omega, omega_std, xi, xi_std = np.array(found).T
    small, small_std = _to_zero(amplitude, omega, omega_std)
    return Backbone(
        amplitude, omega, omega_std, xi, xi_std, small, small_std,
        _trend_p(amplitude, omega, omega_std), _trend_p(amplitude, xi, xi_std),
    )  # fmt: skip


def _trend_p(amplitude: Array, value: Array, std: Array) -> float:
    """Chance of a linear trend this strong; windows overlap by half, so the variance counts twice."""
    columns = np.column_stack([np.ones(len(value)), amplitude / amplitude.max()]) / std[:, None]
    inverse = np.linalg.inv(columns.T @ columns)
    solution = inverse @ columns.T @ (value / std)
    left = value / std - columns @ solution
    excess = max(1.0, float(left @ left) / max(len(value) - 2, 1))
    return float(2 * norm.sf(abs(solution[1]) / np.sqrt(2.0 * inverse[1, 1] * excess)))


def _to_zero(amplitude: Array, value: Array, std: Array) -> tuple[float, float]:
    """Value at amplitude 0 by a polynomial of first or second degree in A², whichever Schwarz prefers."""
    square = (amplitude / amplitude.max()) ** 2
    best = (np.inf, 0.0, 0.0)
    for degree in (1, 2):
        if len(value) < degree + 3:
            continue
        columns = square[:, None] ** np.arange(degree + 1) / std[:, None]
        inverse = np.linalg.pinv(columns.T @ columns, hermitian=True)
        solution = inverse @ columns.T @ (value / std)
        left = value / std - columns @ solution
        excess = float(left @ left) / max(len(value) - degree - 1, 1)
        score = len(value) * np.log(max(float(left @ left), 1e-12) / len(value)) + (degree + 1) * np.log(len(value))
        if score < best[0]:
            best = (score, float(solution[0]), float(np.sqrt(inverse[0, 0] * max(2.0, 2.0 * excess))))
    return best[1], best[2]
