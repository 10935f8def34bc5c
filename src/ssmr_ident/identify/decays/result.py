"""A fitted decay: modes with uncertainties, and a report that prints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.decays.poles import Block, PoleFit, fit_poles, modelled
from ssmr_ident.identify.lmfit_report import Variable, matrix_correlations, variables_frame, variables_report

if TYPE_CHECKING:
    import lmfit
    import pandas as pd


@dataclass(frozen=True)
class Mode:
    """One decaying mode A·e^(−ξω_n t)·sin(√(1−ξ²)·ω_n t + B).

    Parameters
    ----------
    omega_n, omega_n_std, omega_n_bound : float [rad/s]
        Natural frequency, its standard deviation, and the Cramér–Rao bound of this very record.
    xi, xi_std, xi_bound : float [1]
        Damping ratio, likewise.
    correlation : float
        Between ω_n and ξ.
    amplitudes, amplitude_stds : (r, c) float [unit of the signal]
        At the start, per record and channel.
    phases : (r, c) float [rad]
        B at the start.
    """

    omega_n: float
    omega_n_std: float
    omega_n_bound: float
    xi: float
    xi_std: float
    xi_bound: float
    correlation: float
    amplitudes: np.ndarray
    amplitude_stds: np.ndarray
    phases: np.ndarray

    @property
    def decay_rate(self) -> float:
        """λ = ξω_n [1/s] (5.9)."""
        return self.xi * self.omega_n

    @property
    def frequency_hz(self) -> float:
        """Damped frequency f [Hz], the one a spectrum shows (5.9)."""
        return self.omega_n * math.sqrt(max(1.0 - self.xi**2, 0.0)) / (2 * math.pi)


@dataclass(frozen=True)
class DecayFit(Shown):
    """Modes of one decay, or of several fitted together.

    Parameters
    ----------
    modes : tuple of Mode
        By frequency.
    covariance : (2k, 2k) float
        Of (ω_n, ξ) of each mode in turn [rad/s, 1].
    offsets : (r, c) float
        Per record and channel.
    starts_s : tuple of float [s]
        Per record, the time from which it was fitted.
    noise_stds : (r, c) float
        White part of the noise, in the signal's unit.
    noise_orders : tuple of int
        Order of the autoregressive noise model per record and channel.
    mains_hz : tuple of float or None
        The line that was eliminated, per record.
    mains_amplitudes : (r, c) float
    evidence : dict of int to float
        Schwarz's criterion (less is better) by number of modes tried.
    misfit : float
        Residual variance over noise variance while the motion stands above the noise; 1 when nothing is left.
    whiteness_p : float
        Small when the residual still holds structure; standard deviations then come from a sandwich.
    samples : int
    iterations : int
    unit : str
        Of the signal.
    blocks : tuple of Block
        The whitened records that were fitted.
    """

    modes: tuple[Mode, ...]
    covariance: np.ndarray
    offsets: np.ndarray
    starts_s: tuple[float, ...]
    noise_stds: np.ndarray
    noise_orders: tuple[int, ...]
    mains_hz: tuple[float | None, ...]
    mains_amplitudes: np.ndarray
    evidence: dict[int, float]
    misfit: float
    whiteness_p: float
    samples: int
    iterations: int
    unit: str = ""
    blocks: tuple[Block, ...] = field(default=(), repr=False)

    @property
    def dominant(self) -> Mode:
        """The mode with the most energy over the records."""
        return max(self.modes, key=lambda mode: float(np.sum(mode.amplitudes**2)) / max(mode.decay_rate, 1e-9))

    @property
    def adequate(self) -> bool:
        """True where the residual passes for white noise at the level 1 in 1000."""
        return self.whiteness_p > 1e-3

    def __str__(self) -> str:
        lines = ["[[Fit Statistics]]"]
        lines.append(f"    {len(self.starts_s)} record(s), {self.samples} samples, {self.iterations} iterations")
        lines.append(
            f"    start {', '.join(f'{start:.4g}' for start in self.starts_s)} s, noise order "
            f"{', '.join(str(order) for order in self.noise_orders)}, noise std "
            f"{', '.join(f'{value:.3g}' for value in self.noise_stds.ravel())} {self.unit}"
        )
        tried = ", ".join(f"{count} mode(s) {score:.1f}" for count, score in sorted(self.evidence.items()))
        lines.append(f"    Schwarz criterion: {tried}")
        verdict = "white" if self.adequate else "NOT white: standard deviations from a sandwich"
        lines.append(f"    residual/noise variance {self.misfit:.3g}; residual {verdict} (p = {self.whiteness_p:.2g})")
        lines += variables_report(self.variables(), matrix_correlations(self.names, self.covariance), least=0.1)
        for number, mode in enumerate(self.modes, 1):
            lines.append(
                f"    mode {number}: f = {mode.frequency_hz:.5g} Hz, lambda = {mode.decay_rate:.4g} 1/s; "
                f"Cramér–Rao bounds {mode.omega_n_bound:.2g} rad/s and {mode.xi_bound:.2g}"
            )
        return "\n".join(lines)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of ``covariance``'s rows: omega_n_1, xi_1, omega_n_2, …"""
        return tuple(f"{name}_{k}" for k in range(1, len(self.modes) + 1) for name in ("omega_n", "xi"))

    def variables(self) -> list[Variable]:
        """ω_n and ξ of each mode, then amplitudes and phases per record and channel."""
        rows = []
        for number, mode in enumerate(self.modes, 1):
            rows.append(Variable(f"omega_n_{number}", mode.omega_n, mode.omega_n_std, "rad/s"))
            rows.append(Variable(f"xi_{number}", mode.xi, mode.xi_std, "1"))
        records, channels = self.modes[0].amplitudes.shape
        for number, mode in enumerate(self.modes, 1):
            for r in range(records):
                for c in range(channels):
                    place = f"_{number}" + (f"_record_{r + 1}" if records > 1 else "")
                    place += f"_channel_{c + 1}" if channels > 1 else ""
                    size, std = float(mode.amplitudes[r, c]), float(mode.amplitude_stds[r, c])
                    rows.append(Variable(f"A{place}", size, std, self.unit))
                    rows.append(Variable(f"B{place}", float(mode.phases[r, c]), None, "rad"))
        return rows

    def to_frame(self) -> pd.DataFrame:
        """A row a variable, by its name: ``value``, ``std``, ``unit`` and what else ``Variable`` has."""
        return variables_frame(self.variables())

    def minimize(self) -> lmfit.minimizer.MinimizerResult:
        """lmfit's own fit of ω_n and ξ, polished from this optimum on the whitened residual.

        Amplitudes, offsets and mains lines are eliminated inside, so every residual is the best for its ω_n and ξ.
        Standard deviations and correlations are replaced by those of ``covariance``, which also holds where the
        residual is not white.
        """
        import lmfit  # it brings pandas: what prints no report of it need not wait

        parameters = lmfit.Parameters()
        for number, mode in enumerate(self.modes, 1):
            parameters.add(f"omega_n_{number}", value=mode.omega_n, min=0.0)
            parameters.add(f"xi_{number}", value=mode.xi, min=-1.0, max=1.0)

        def residual(now: lmfit.Parameters) -> np.ndarray:
            values = np.array(list(now.valuesdict().values()))
            return whitened_residual(self.blocks, values[0::2], values[1::2])

        result = lmfit.Minimizer(residual, parameters, calc_covar=False).least_squares(x_scale="jac")
        result.covar = self.covariance
        result.var_names = list(self.names)
        result.errorbars = True
        stds = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        sizes = matrix_correlations(self.names, self.covariance)
        for index, name in enumerate(self.names):
            result.params[name].stderr = float(stds[index])
            result.params[name].correl = {
                (second if name == first else first): size
                for (first, second), size in sizes.items()
                if name in (first, second)
            }
        return result

    def report(self) -> str:
        """lmfit's printed report of :meth:`minimize`, units and eliminated amplitudes added."""
        from lmfit import fit_report

        text = fit_report(self.minimize(), min_correl=0.1)
        head = text[: text.index("[[Variables]]")].rstrip()
        sizes = matrix_correlations(self.names, self.covariance)
        return "\n".join([head, *variables_report(self.variables(), sizes, least=0.1)])


def whitened_residual(blocks: Sequence[Block], omega_n: np.ndarray, xi: np.ndarray) -> np.ndarray:
    """Residual of all records with the best amplitudes, offsets and mains lines, (n,) float.

    Parameters
    ----------
    blocks : sequence of Block
    omega_n, xi : (k,) float [rad/s], [1]
    """
    frequencies = omega_n * np.sqrt(np.maximum(1.0 - xi**2, 1e-12))
    # no iteration: the linear solution alone
    fit: PoleFit = fit_poles(blocks, omega_n * xi, frequencies, max_iterations=0)
    parts = [block.samples - modelled(block, fit, index) for index, block in enumerate(blocks)]
    return np.concatenate([part.ravel() for part in parts])
