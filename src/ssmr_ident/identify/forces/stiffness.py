"""Springs from forces: in series, in parallel, and which law a curve follows (3.8), (3.9)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import lmfit
import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.lmfit_report import Variable, variables_report

Array = np.ndarray


def in_series(*springs: float) -> float:
    """Stiffness of springs in series [N/m] (3.9).

    >>> in_series(2.0, 2.0)
    1.0
    """
    return 1.0 / sum(1.0 / spring for spring in springs)


def behind_cable(measured: float, cable: float) -> float:
    """Tire stiffness behind a cable, K = K_m·K_c/(K_c − K_m) (3.9) [N/m].

    Raises
    ------
    ValueError
        When the cable alone is softer than what was measured.
    """
    if measured >= cable:
        raise ValueError(f"measured {measured:.4g} N/m is not below the cable's {cable:.4g} N/m")
    return measured * cable / (cable - measured)


def belt_stiffness(measured: float) -> float:
    """One of two belts in parallel, K_measured = 2·K_belt (3.8) [N/m].

    >>> belt_stiffness(6000.0)
    3000.0
    """
    return measured / 2.0


UNITS = {"force_zero": "N", "stiffness": "N/m", "stiffness_2": "N/m", "knee": "m", "k3": "N/m^3"}


@dataclass(frozen=True)
class StiffnessLaw:
    """One law fitted to force over deflection.

    Parameters
    ----------
    name : str
        ``linear``, ``two slopes`` or ``cubic``.
    values, stds : dict of str to float
        In SI: force_zero [N], stiffness [N/m], and knee [m], stiffness_2 [N/m], or k3 [N/m^3]; standard deviations
        count that neighbouring samples go together.
    evidence : float
        Schwarz's criterion, less is better.
    scatter : float [N]
    correlations : dict of (str, str) to float
    """

    name: str
    values: dict[str, float]
    stds: dict[str, float]
    evidence: float
    scatter: float
    correlations: dict[tuple[str, str], float] = field(default_factory=dict)

    def report(self) -> str:
        """lmfit's report, with units."""
        variables = [Variable(key, value, self.stds[key], UNITS[key]) for key, value in self.values.items()]
        head = ["[[Model]]", f"    {self.name}", "[[Fit Statistics]]", f"    scatter {self.scatter:.4g} N"]
        return "\n".join([*head, *variables_report(variables, self.correlations)])


@dataclass(frozen=True)
class StiffnessChoice(Shown):
    """Laws compared; the first has the best evidence.

    Parameters
    ----------
    laws : tuple of StiffnessLaw
        Best first.
    """

    laws: tuple[StiffnessLaw, ...]

    @property
    def best(self) -> StiffnessLaw:
        return self.laws[0]

    @property
    def decisive(self) -> bool:
        """True where the next law is worse by more than 10 (posterior odds of 150 to 1)."""
        return len(self.laws) < 2 or self.laws[1].evidence - self.laws[0].evidence > 10

    def __str__(self) -> str:
        lines = ["law            Schwarz   parameters"]
        for law in self.laws:
            values = ", ".join(f"{key} {value:.4g} ± {law.stds[key]:.2g}" for key, value in law.values.items())
            lines.append(f"{law.name:<12} {law.evidence - self.best.evidence:>9.1f}   {values}")
        return "\n".join(lines)


def _linear(x: Array, force_zero: float, stiffness: float) -> Array:
    return force_zero + stiffness * x


def _cubic(x: Array, force_zero: float, stiffness: float, k3: float) -> Array:
    return force_zero + stiffness * x + k3 * x**3


def _two_slopes(x: Array, force_zero: float, stiffness: float, stiffness_2: float, knee: float) -> Array:
    result: Array = force_zero + stiffness * np.minimum(x, knee) + stiffness_2 * np.maximum(x - knee, 0.0)
    return result


LAWS: dict[str, Callable[..., Array]] = {"linear": _linear, "cubic": _cubic, "two slopes": _two_slopes}


def compare_laws(deflection: Array, force: Array) -> StiffnessChoice:
    """One straight line, two joined lines, or a cubic: which law a stretch of force over deflection follows.

    Parameters
    ----------
    deflection : (n,) float [m]
    force : (n,) float [N]

    Notes
    -----
    Each law is an ``lmfit.Model``, started at its linear least squares (for the knee: the best of a grid) and kept
    within the stretch. Neighbouring samples go together, so the evidence counts n·(1 − r)/(1 + r) of them, r being
    the first-order correlation of the best law's residual.
    """
    deflection, force = np.asarray(deflection, float), np.asarray(force, float)
    offset = deflection - deflection[0]
    results = {name: _fitted(name, offset, force) for name in LAWS}
    least = min(results.values(), key=lambda result: result.chisqr)
    residual = np.asarray(least.residual)
    power = float(residual @ residual)
    correlation = float(np.clip(residual[1:] @ residual[:-1] / power, 0.0, 0.95)) if power > 0 else 0.0
    effective = max(len(force) * (1 - correlation) / (1 + correlation), 8.0)
    widened = float(np.sqrt((1 + correlation) / (1 - correlation)))
    laws = []
    for name, result in results.items():
        count = result.nvarys
        evidence = effective * np.log(max(result.chisqr, 1e-300) / len(force)) + count * np.log(effective)
        correlations = {
            (first, second): float(size)
            for first, parameter in result.params.items()
            for second, size in (parameter.correl or {}).items()
            if first < second
        }
        stds = {key: float("inf") if p.stderr is None else widened * p.stderr for key, p in result.params.items()}
        scatter = float(np.sqrt(result.chisqr / max(len(force) - count, 1)))
        laws.append(StiffnessLaw(name, dict(result.params.valuesdict()), stds, float(evidence), scatter, correlations))
    return StiffnessChoice(tuple(sorted(laws, key=lambda law: law.evidence)))


def _fitted(name: str, offset: Array, force: Array) -> lmfit.model.ModelResult:
    """One law by lmfit, from its linear least squares."""
    model = lmfit.Model(LAWS[name], independent_vars=["x"])
    ones = np.ones(len(offset))
    if name == "two slopes":
        # The knee is the one non-linear parameter: a grid finds its valley.
        knees = np.linspace(offset.min(), offset.max(), 62)[3:-3]
        knee = float(knees[int(np.argmin([_solve(_bent(offset, knee), force)[1] for knee in knees]))])
        zero, slope, change = _solve(_bent(offset, knee), force)[0]
        parameters = model.make_params(force_zero=zero, stiffness=slope, stiffness_2=slope + change, knee=knee)
        parameters["knee"].set(min=float(knees[0]), max=float(knees[-1]))
    elif name == "cubic":
        zero, slope, k3 = _solve(np.column_stack([ones, offset, offset**3]), force)[0]
        parameters = model.make_params(force_zero=zero, stiffness=slope, k3=k3)
    else:
        zero, slope = _solve(np.column_stack([ones, offset]), force)[0]
        parameters = model.make_params(force_zero=zero, stiffness=slope)
    return model.fit(force, parameters, x=offset)


def _bent(offset: Array, knee: float) -> Array:
    return np.column_stack([np.ones(len(offset)), offset, np.maximum(offset - knee, 0.0)])


def _solve(columns: Array, target: Array) -> tuple[Array, float]:
    """Least squares: solution and sum of squares."""
    scale = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
    solution = np.linalg.lstsq(columns / scale, target, rcond=None)[0]
    residual = target - columns / scale @ solution
    return solution / scale, float(residual @ residual)
