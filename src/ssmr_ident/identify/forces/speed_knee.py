"""Friction over slip speed: a fall, then a flat (section 3.3)."""

from __future__ import annotations

from dataclasses import dataclass

import lmfit
import numpy as np

from ssmr_ident.identify.lmfit_report import Variable, variables_report

Array = np.ndarray


@dataclass(frozen=True)
class SpeedKnee:
    """Friction that falls linearly with slip speed and is flat beyond a knee.

    Parameters
    ----------
    at_rest, flat : float
        Value at speed 0 and beyond the knee, in the unit of the input.
    knee : float [m/s]
    at_rest_std, flat_std, knee_std : float
    correlations : dict of (str, str) to float
    """

    at_rest: float
    flat: float
    knee: float
    at_rest_std: float
    flat_std: float
    knee_std: float
    correlations: dict[tuple[str, str], float]

    def report(self, unit: str = "1") -> str:
        """lmfit's report; ``unit`` is that of the friction."""
        variables = [
            Variable("at_rest", self.at_rest, self.at_rest_std, unit),
            Variable("flat", self.flat, self.flat_std, unit),
            Variable("knee", self.knee, self.knee_std, "m/s"),
        ]
        return "\n".join(variables_report(variables, self.correlations))


def falling(speed: Array, at_rest: float, flat: float, knee: float) -> Array:
    """flat + (at_rest − flat)·max(0, 1 − v/knee), (n,) float."""
    return flat + (at_rest - flat) * np.maximum(0.0, 1.0 - speed / knee)


def speed_knee(speed: Array, friction: Array) -> SpeedKnee:
    """Fit friction over slip speed, an ``lmfit.Model`` started at the best of a grid of knees.

    Parameters
    ----------
    speed : (n,) float [m/s]
        At least 5, on both sides of the knee.
    friction : (n,) float
        Force or coefficient.

    Raises
    ------
    ValueError
        With fewer than five speeds.
    """
    speed, friction = np.asarray(speed, float), np.asarray(friction, float)
    if len(np.unique(speed)) < 5:
        raise ValueError(f"a knee needs at least 5 different speeds; got {len(np.unique(speed))}")
    ordered = np.unique(speed[speed > 0])

    def solve(knee: float) -> tuple[float, Array]:
        share = np.maximum(0.0, 1.0 - speed / knee)
        columns = np.column_stack([share, 1.0 - share])
        solution = np.linalg.lstsq(columns, friction, rcond=None)[0]
        residual = friction - columns @ solution
        return float(residual @ residual), solution

    grid = np.linspace(ordered[0] * 1.001, ordered[-1], 400)
    knee = float(grid[int(np.argmin([solve(value)[0] for value in grid]))])
    at_rest, flat = solve(knee)[1]
    model = lmfit.Model(falling, independent_vars=["speed"])
    parameters = model.make_params(at_rest=at_rest, flat=flat, knee=knee)
    parameters["knee"].set(min=1e-3 * float(ordered[0]), max=2.0 * float(ordered[-1]))
    result = model.fit(friction, parameters, speed=speed)
    stds = {name: np.inf if p.stderr is None else float(p.stderr) for name, p in result.params.items()}
    correlations = {
        (first, second): float(size)
        for first, parameter in result.params.items()
        for second, size in (parameter.correl or {}).items()
        if first < second
    }
    values = result.params.valuesdict()
    return SpeedKnee(
        float(values["at_rest"]), float(values["flat"]), float(values["knee"]),
        stds["at_rest"], stds["flat"], stds["knee"], correlations,
    )  # fmt: skip
