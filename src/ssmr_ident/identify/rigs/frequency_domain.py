"""A rig's mass, spring and damper from measured force and motion: output error in the frequency domain.

The response of m x'' + d x' + k x = F to the measured force, taken as periodic, plus a free decay is exact for
band-limited records, whatever the initial state. Mass, offsets and initial state are linear in the output, so only
(k/m, d/m) are searched.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2
from scipy.stats import t as student

from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.lmfit_report import Variable, matrix_correlations, variables_report
from ssmr_ident.signals.noise import long_run_variance, whiteness

if TYPE_CHECKING:
    import lmfit

Array = np.ndarray

DERIVATIVES = {"position": 0, "angle": 0, "velocity": 1, "angular_rate": 1, "acceleration": 2, "acceleration_2": 2}
"""How often each measurable motion is differentiated."""


@dataclass(frozen=True)
class ForcedRecord:
    """One record of a forced rig.

    Parameters
    ----------
    step : float [s]
    force : (n,) float [N]
    motions : dict of str to (n,) float
        By quantity, SI.
    """

    step: float
    force: Array
    motions: dict[str, Array]


@dataclass(frozen=True)
class RigFit(Shown):
    """Mass, damper and spring of a rig (inertia, N m s/rad, N m/rad for a rotary one).

    Parameters
    ----------
    mass, damping, stiffness : float
    covariance : (3, 3) float
        Of (mass, damping, stiffness), for residuals that are correlated in time.
    unexplained_percent : dict of str to float
        100·‖residual‖/‖signal − mean‖ by record and motion.
    whiteness_p : float
    method : str
    friction, friction_std : float [N]
        Coulomb friction where it was fitted, else 0.
    offset, offset_std : float [N]
        Of the force channel where it was fitted, else 0.
    evidence : dict of str to float
        Schwarz's criterion by model, less is better.
    """

    mass: float
    damping: float
    stiffness: float
    covariance: Array
    unexplained_percent: dict[str, float]
    whiteness_p: float
    method: str
    friction: float = 0.0
    friction_std: float = 0.0
    offset: float = 0.0
    offset_std: float = 0.0
    evidence: dict[str, float] | None = None

    @property
    def stds(self) -> Array:
        """(3,) float, of mass, damping and stiffness."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    def __str__(self) -> str:
        lines = ["[[Fit Statistics]]", f"    {self.method}"]
        lines += [f"    unexplained {value:.3g} % of {name}" for name, value in self.unexplained_percent.items()]
        for model, score in sorted((self.evidence or {}).items(), key=lambda item: item[1]):
            lines.append(f"    Schwarz criterion {score:.1f}: {model}")
        return "\n".join([*lines, *self._variables(rotary=False)])

    def report(self, rotary: bool = False) -> str:
        """lmfit's report, with units; ``rotary`` for an inertia on a torsion spring."""
        return "\n".join(["[[Model]]", f"    {self.method}", *self._variables(rotary)])

    def _variables(self, rotary: bool) -> list[str]:
        units = ("kg m^2", "N m s/rad", "N m/rad", "N m") if rotary else ("kg", "N s/m", "N/m", "N")
        names = ("inertia" if rotary else "mass", "damping", "stiffness")
        values = (self.mass, self.damping, self.stiffness)
        rows = [
            Variable(name, value, float(std), unit)
            for name, value, std, unit in zip(names, values, self.stds, units[:3], strict=True)
            if std > 0 or value != 0
        ]
        if self.friction_std:
            rows.append(Variable("Coulomb friction", self.friction, self.friction_std, units[3]))
            rows.append(Variable("force offset", self.offset, self.offset_std, units[3]))
        return variables_report(rows, matrix_correlations(names, self.covariance))


class _Response:
    """Output of one record for given (k/m, d/m), linear parts eliminated."""

    def __init__(self, record: ForcedRecord, bandwidth_hz: float | None) -> None:
        count = len(record.force)
        self.record, self.count = record, count
        self.natural_square = math.nan
        # Room for the free decay that the period's join excites, and a length that transforms fast.
        self.size = 1 << (count - 1).bit_length()
        self.spectrum = np.fft.rfft(record.force - record.force.mean(), self.size)
        self.s = 2j * np.pi * np.fft.rfftfreq(self.size, record.step)
        self.times = record.step * np.arange(count)
        self.sensor = np.ones(len(self.s), complex)
        if bandwidth_hz is not None:
            corner = 2 * np.pi * bandwidth_hz
            self.sensor = corner**2 / (self.s**2 + math.sqrt(2) * corner * self.s + corner**2)

    def columns(self, stiffness: float, damping: float, name: str) -> Array:
        """Unit-mass response, free decay, offset; (n, 4)."""
        order = DERIVATIVES[name]
        denominator = self.s**2 + damping * self.s + stiffness
        sensor = self.sensor if order == 2 else 1.0
        driven = np.fft.irfft(self.spectrum * self.s**order / denominator * sensor, self.size)[: self.count]
        return np.column_stack([driven, *self._free(stiffness, damping), np.ones(self.count)])

    def _free(self, stiffness: float, damping: float) -> tuple[Array, Array]:
        decay, inside = damping / 2, stiffness - damping**2 / 4
        if inside > 0:
            wave = np.exp((-decay + 1j * math.sqrt(inside)) * self.times)
            return wave.real, wave.imag
        root = math.sqrt(-inside)
        return np.exp(-(decay - root) * self.times), np.exp(-(decay + root) * self.times)


RATIOS = ("log_stiffness_over_mass", "log_damping_over_mass")


def _logs(parameters: lmfit.Parameters) -> Array:
    return np.array([parameters[name].value for name in RATIOS])


def fit_rig(
    records: list[ForcedRecord], start: tuple[float, float, float], bandwidth_hz: float | None = None
) -> RigFit:
    """Mass, damping and stiffness by output error over all records and motions.

    Parameters
    ----------
    records : list of ForcedRecord
    start : (mass, damping, stiffness)
    bandwidth_hz : float, optional
        Of the accelerometer, a second-order Butterworth low-pass.

    Returns
    -------
    RigFit

    Notes
    -----
    Each channel is weighted by its own residual. One mass serves all records; in the gain of a second
    accelerometer, whose place on the structure is unknown, nothing can be read of the mass, so it has its own.
    """
    responses = [_Response(record, bandwidth_hz) for record in records]
    channels = [(response, name) for response in responses for name in response.record.motions]
    outputs = [response.record.motions[name] for response, name in channels]
    weights = np.array([1.0 / max(float(np.std(output)), 1e-300) for output in outputs])
    shared = [name != "acceleration_2" for _, name in channels]

    def solve(logs: Array) -> tuple[list[Array], float, list[Array]]:
        stiffness, damping = np.exp(logs)
        blocks = [response.columns(stiffness, damping, name) for response, name in channels]
        # Own free decay and offset are projected out per channel; the gain is then shared.
        numerator = denominator = 0.0
        pieces = []
        for block, output, weight, together in zip(blocks, outputs, weights, shared, strict=True):
            own = block[:, 1:]
            basis, _ = np.linalg.qr(own)
            driven = block[:, 0] - basis @ (basis.T @ block[:, 0])
            target = output - basis @ (basis.T @ output)
            pieces.append((driven, target, weight))
            if together:
                numerator += weight**2 * float(driven @ target)
                denominator += weight**2 * float(driven @ driven)
        gain = numerator / max(denominator, 1e-300)
        residuals, drivens = [], []
        for (driven, target, weight), together in zip(pieces, shared, strict=True):
            own_gain = gain if together else float(driven @ target) / max(float(driven @ driven), 1e-300)
            residuals.append(weight * (target - own_gain * driven))
            drivens.append(weight * driven)
        return residuals, gain, drivens

    import lmfit  # it brings pandas: who fits no rig need not wait

    mass, damping, stiffness = start
    origin = np.log([stiffness / mass, damping / mass])
    starts = [origin + np.array([shift, 0.0]) for shift in (0.0, -0.2, 0.2)]
    for _ in range(2):
        costs = [sum(float(r @ r) for r in solve(point)[0]) for point in starts]
        first = starts[int(np.argmin(costs))]
        parameters = lmfit.Parameters()
        for name, value in zip(RATIOS, first, strict=True):
            # a factor of 10⁴ either way of where the search begins
            parameters.add(name, value=value, min=value - 9.2, max=value + 9.2)
        search = lmfit.Minimizer(lambda p: np.concatenate(solve(_logs(p))[0]), parameters, calc_covar=False)
        found = _logs(search.least_squares(x_scale=[0.1, 0.5], xtol=1e-10).params)
        weights = weights / np.array([max(float(np.std(r)), 1e-12) for r in solve(found)[0]])
        starts = [found]
    residuals, gain, drivens = solve(found)
    for response in responses:
        response.natural_square = math.exp(found[0])
    jacobian = []
    for index in range(2):
        move = np.zeros(2)
        move[index] = 1e-5
        ahead, behind = solve(found + move)[0], solve(found - move)[0]
        jacobian.append([(a - b) / 2e-5 for a, b in zip(ahead, behind, strict=True)])
    spread = _spread(channels, jacobian, drivens, residuals, shared)
    mass = 1.0 / gain
    ratio_k, ratio_d = np.exp(found)
    # (log k/m, log d/m, gain) to (m, d, k)
    turn = np.array(
        [
            [0, 0, -mass / gain],
            [0, mass * ratio_d, -mass * ratio_d / gain],
            [mass * ratio_k, 0, -mass * ratio_k / gain],
        ]
    )
    unexplained = {}
    for number, ((_, name), residual, weight, output) in enumerate(
        zip(channels, residuals, weights, outputs, strict=True)
    ):
        share = float(np.linalg.norm(residual) / weight / np.linalg.norm(output - output.mean()))
        unexplained[f"record {number + 1} {name}"] = 100 * share
    return RigFit(
        mass=mass,
        damping=mass * float(ratio_d),
        stiffness=mass * float(ratio_k),
        covariance=turn @ spread @ turn.T,
        unexplained_percent=unexplained,
        whiteness_p=min(1.0, len(residuals) * min(whiteness(residual) for residual in residuals)),
        method="output error of mass, spring and damper, force taken band-limited",
    )


def _spread(
    channels: list[tuple[_Response, str]],
    jacobian: list[list[Array]],
    drivens: list[Array],
    residuals: list[Array],
    shared: list[bool],
) -> Array:
    """Covariance of (log k/m, log d/m, gain), (3, 3): a sandwich in time, widened to the scatter of the records.

    A model that misses something asks for other parameters in each record. How much they differ is seen in the
    gradients of the single records, which cancel only in their sum; with few records the widening goes up to
    Student's 95 % point.
    """
    information, meat = np.zeros((3, 3)), np.zeros((3, 3))
    by_record: dict[int, Array] = {}
    for k, (response, _) in enumerate(channels):
        slope_gain = -drivens[k] if shared[k] or not any(shared) else np.zeros_like(drivens[k])
        columns = np.column_stack([jacobian[0][k], jacobian[1][k], slope_gain])
        information += columns.T @ columns
        period = 2 * np.pi / np.sqrt(response.natural_square) / response.record.step
        bandwidth = min(round(1.5 * period), len(residuals[k]) // 10)
        meat += long_run_variance(columns * residuals[k][:, None], bandwidth)
        score = columns.T @ residuals[k]
        by_record[id(response)] = by_record.get(id(response), np.zeros(3)) + score
    inverse = np.linalg.pinv(information, hermitian=True)
    spread = inverse @ meat @ inverse
    count = len(by_record)
    if count < 3:
        return spread
    scores = np.array(list(by_record.values()))
    between = inverse @ (scores.T @ scores * count / (count - 1)) @ inverse
    widen = float(student.ppf(0.975, count - 1) / 1.959964)
    own = np.maximum(np.diag(spread), 1e-300)
    scale = np.maximum(1.0, widen * np.sqrt(np.diag(between) / own))
    # Chance alone makes the scatter of a few records look wide; only what is beyond it counts.
    scale = np.where(np.diag(between) / own > chi2.isf(0.01, count - 1) / (count - 1), scale, 1.0)
    result: Array = spread * np.outer(scale, scale)
    return result
