"""What a fitted decay is worth: modes with uncertainties, and a report that prints."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


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
class DecayFit:
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
        lines.append("[[Variables]]")
        for number, mode in enumerate(self.modes, 1):
            percent = 100 * mode.omega_n_std / mode.omega_n
            xi_percent = 100 * mode.xi_std / abs(mode.xi or 1)
            lines.append(
                f"    omega_n_{number}: {mode.omega_n:.6g} +/- {mode.omega_n_std:.2g} rad/s ({percent:.2g}%), "
                f"bound {mode.omega_n_bound:.2g}"
            )
            lines.append(
                f"    xi_{number}:      {mode.xi:.5g} +/- {mode.xi_std:.2g} ({xi_percent:.2g}%), "
                f"bound {mode.xi_bound:.2g}"
            )
            lines.append(f"      f = {mode.frequency_hz:.5g} Hz, lambda = {mode.decay_rate:.4g} 1/s")
            for record in range(mode.amplitudes.shape[0]):
                lines.append(
                    "      amplitude "
                    + ", ".join(
                        f"{a:.4g} +/- {s:.2g} {self.unit} at {b:.3f} rad"
                        for a, s, b in zip(
                            mode.amplitudes[record], mode.amplitude_stds[record], mode.phases[record], strict=True
                        )
                    )
                )
        lines.append("[[Correlations]]")
        scale = np.sqrt(np.maximum(np.diag(self.covariance), 1e-300))
        names = [f"{name}_{k + 1}" for k in range(len(self.modes)) for name in ("omega_n", "xi")]
        pairs = [(abs(self.covariance[i, j] / scale[i] / scale[j]), i, j) for i in range(len(names)) for j in range(i)]
        for size, i, j in sorted(pairs, reverse=True)[:4]:
            if size > 0.1:
                lines.append(f"    C({names[j]}, {names[i]}) = {self.covariance[i, j] / scale[i] / scale[j]:+.3f}")
        return "\n".join(lines)
