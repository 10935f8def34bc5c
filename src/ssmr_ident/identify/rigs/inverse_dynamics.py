"""A drive without a spring: mass, viscous and Coulomb friction and force offset by inverse dynamics.

F = m·a + d·v + F_c·sign(v) − F_0 is linear. Position is differentiated after a zero-phase low-pass that keeps what
stands above the encoder's noise, force passes the same filter, and both are decimated (Gautier, Janot and
Vandanjon, IEEE Trans. Control Systems Technology 21, 2013). Under closed-loop control an output-error fit of the
plain model goes astray; the regressors here hold hardly any noise, so least squares does not.
"""

from __future__ import annotations

import lmfit
import numpy as np
from scipy.signal import butter, sosfiltfilt

from ssmr_ident.identify.rigs.frequency_domain import RigFit
from ssmr_ident.signals.noise import long_run_variance, usable_band, whiteness

Array = np.ndarray


COLUMNS = ("mass", "damping", "friction", "offset")


def _by_lmfit(start: Array, table: Array, target: Array) -> Array:
    """lmfit's least squares from the linear solution, mass and friction kept above 0 where they began there."""
    parameters = lmfit.Parameters()
    for name, value in zip(COLUMNS, start, strict=False):
        parameters.add(name, value=float(value), min=0.0 if name in ("mass", "friction") and value > 0 else -np.inf)

    def residual(now: lmfit.Parameters) -> Array:
        result: Array = target - table @ np.array(list(now.valuesdict().values()))
        return result

    result = lmfit.Minimizer(residual, parameters, calc_covar=False).least_squares(jac="2-point", x_scale="jac")
    return np.array(list(result.params.valuesdict().values()))


def fit_drive(
    positions: list[Array],
    forces: list[Array],
    step: float,
    coulomb: bool = True,
    low_pass_hz: float | None = None,
) -> RigFit:
    """Mass, viscous damping, Coulomb friction and force offset.

    Parameters
    ----------
    positions, forces : lists of (n,) float [m], [N]
        Records at one sample rate.
    step : float [s]
    coulomb : bool
        Allow Coulomb friction and an offset of the force channel.
    low_pass_hz : float, optional
        Half the usable band by default.

    Returns
    -------
    RigFit
        Stiffness 0.
    """
    corner = low_pass_hz or min(0.5 * usable_band(position, step) for position in positions)
    section = butter(4, corner * 2 * step, output="sos")
    margin = int(2.0 / corner / step)
    keep = max(1, int(0.2 / corner / step))
    rows, targets, groups = [], [], []
    for number, (position, force) in enumerate(zip(positions, forces, strict=True)):
        smooth = sosfiltfilt(section, position)
        velocity = np.gradient(smooth, step)
        acceleration = np.gradient(velocity, step)
        # At rest dry friction takes any value up to F_c, so rows near standstill say nothing and are left out;
        # elsewhere sign(v) passes the same filter as the force, so both are smeared alike at a reversal.
        moving = np.abs(velocity) > 0.05 * float(np.sqrt(np.mean(velocity**2)))
        sign = sosfiltfilt(section, np.sign(velocity))
        columns = np.column_stack([acceleration, velocity, sign, -np.ones(len(position))])
        inner = np.arange(margin, len(position) - margin, keep)
        inner = inner[moving[inner]]
        rows.append(columns[inner])
        targets.append(sosfiltfilt(section, force)[inner])
        groups.append(np.full(len(targets[-1]), number))
    table, target = np.vstack(rows), np.concatenate(targets)
    models = {"mass and viscous damper": (0, 1), "with Coulomb friction and force offset": (0, 1, 2, 3)}
    evidence, fits = {}, {}
    for name, chosen_columns in models.items():
        part = table[:, chosen_columns]
        solution = np.linalg.lstsq(part, target, rcond=None)[0]
        residual = target - part @ solution
        evidence[name] = float(len(target) * np.log(float(residual @ residual) / len(target)))
        evidence[name] += len(chosen_columns) * np.log(len(target))
        fits[name] = (solution, residual, part)
    chosen = min(evidence, key=lambda name: evidence[name]) if coulomb else "mass and viscous damper"
    start, _, part = fits[chosen]
    solution = _by_lmfit(start, part, target)
    residual = target - part @ solution
    inverse = np.linalg.inv(part.T @ part)
    # A fifth of a period of the corner between points; two seconds of them go together at most.
    bandwidth = min(round(2.0 / (keep * step)), len(target) // 10)
    spread = inverse @ long_run_variance(part * residual[:, None], bandwidth) @ inverse
    stds = np.sqrt(np.diag(spread))
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = spread[:2, :2]
    full = len(solution) == 4
    return RigFit(
        mass=float(solution[0]),
        damping=float(solution[1]),
        stiffness=0.0,
        covariance=covariance,
        unexplained_percent={"force": 100 * float(np.linalg.norm(residual) / np.linalg.norm(target - target.mean()))},
        whiteness_p=whiteness(residual),
        method=f"inverse dynamics below {corner:.3g} Hz: {chosen}",
        friction=float(solution[2]) if full else 0.0,
        friction_std=float(stds[2]) if full else 0.0,
        offset=float(solution[3]) if full else 0.0,
        offset_std=float(stds[3]) if full else 0.0,
        evidence=evidence,
    )
