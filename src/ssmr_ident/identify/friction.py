"""Friction coefficients from pulls, and friction over slip speed with its knee (section 3.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.sawtooth import Pull
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.statics import rest_loads

Array = np.ndarray


@dataclass(frozen=True)
class Friction:
    """Coefficients of one pull.

    Parameters
    ----------
    mu_static, mu_static_std : float
        From the peaks of teeth, or from the level where the contact slides without teeth.
    mu_kinetic, mu_kinetic_std : float
        From the troughs, or from the level.
    static_over_teeth, kinetic_over_teeth : (t,) float
        One value per tooth; empty without stick-slip.
    load : float [N]
        On the gripping wheels while sliding.
    """

    mu_static: float
    mu_static_std: float
    mu_kinetic: float
    mu_kinetic_std: float
    static_over_teeth: Array
    kinetic_over_teeth: Array
    load: float

    def __str__(self) -> str:
        return (
            f"mu_s = {self.mu_static:.3f} ± {self.mu_static_std:.3f}, mu_k = {self.mu_kinetic:.3f} ± "
            f"{self.mu_kinetic_std:.3f} under {self.load:.4g} N"
        )


def gripping_load(robot: Robot, gripping: tuple[int, ...], direction: str, height: float, force: float) -> float:
    """Load on the gripping wheels [N] while the cable pulls with ``force`` [N].

    Parameters
    ----------
    gripping : tuple of int
        Wheels 1 to 4 as in Table 5.1.
    direction : str
        ``lateral`` (to the left, +y) or ``longitudinal`` (backwards, −x).
    height : float [m]
        Of the cable above the floor.

    Notes
    -----
    At rest by (2.24); the pull at a height shifts force·height/(track or wheelbase) to the side it pulls to.
    """
    at_rest = rest_loads(robot)
    axis, sign = (1, 1.0) if direction == "lateral" else (0, -1.0)
    place = sign * robot.contact_points[:, axis]
    centred = place - place.mean()
    shift = force * height * centred / float(centred @ centred)
    loads = np.maximum(at_rest + shift, 0.0)
    return float(sum(loads[wheel - 1] for wheel in gripping))


def friction_of(pull: Pull, load: float, load_std: float = 0.0, zero: float = 0.0) -> Friction:
    """Coefficients of a pull.

    Parameters
    ----------
    pull : Pull
    load : float [N]
        On the gripping wheels.
    load_std : float [N]
    zero : float [N]
        What the load cell reads without a pull.
    """
    if pull.stick_slip:
        peaks = (np.array([tooth.peak for tooth in pull.teeth]) - zero) / load
        troughs = (np.array([tooth.trough for tooth in pull.teeth]) - zero) / load
        count = np.sqrt(len(peaks))
        upper, lower = float(np.mean(peaks)), float(np.mean(troughs))
        upper_std, lower_std = float(np.std(peaks, ddof=1)) / count, float(np.std(troughs, ddof=1)) / count
    else:
        peaks = troughs = np.empty(0)
        upper = lower = (pull.level - zero) / load
        upper_std = lower_std = pull.level_std / load
    relative = load_std / load
    return Friction(
        mu_static=upper,
        mu_static_std=float(np.hypot(upper_std, upper * relative)),
        mu_kinetic=lower,
        mu_kinetic_std=float(np.hypot(lower_std, lower * relative)),
        static_over_teeth=peaks,
        kinetic_over_teeth=troughs,
        load=load,
    )


@dataclass(frozen=True)
class SpeedKnee:
    """Friction that falls linearly with slip speed and is flat beyond a knee.

    Parameters
    ----------
    at_rest, flat : float
        Value at speed 0 and beyond the knee, in the unit of the input.
    knee : float [m/s]
    at_rest_std, flat_std, knee_std : float
    """

    at_rest: float
    flat: float
    knee: float
    at_rest_std: float
    flat_std: float
    knee_std: float


def speed_knee(speed: Array, friction: Array) -> SpeedKnee:
    """Fit friction over slip speed: f = flat + (at_rest − flat)·max(0, 1 − v/knee).

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

    def solve(knee: float) -> tuple[Array, float, Array]:
        share = np.maximum(0.0, 1.0 - speed / knee)
        columns = np.column_stack([share, 1.0 - share])
        solution = np.linalg.lstsq(columns, friction, rcond=None)[0]
        residual = friction - columns @ solution
        return solution, float(residual @ residual), columns

    ordered = np.unique(speed[speed > 0])
    grid = np.linspace(ordered[0] * 1.001, ordered[-1], 400)
    knee = float(grid[int(np.argmin([solve(value)[1] for value in grid]))])
    width = float(grid[1] - grid[0])
    fine = np.linspace(max(knee - width, ordered[0] * 1e-3), knee + width, 81)
    knee = float(fine[int(np.argmin([solve(value)[1] for value in fine]))])
    solution, rss, columns = solve(knee)
    slope = np.where(speed < knee, (solution[0] - solution[1]) * speed / knee**2, 0.0)
    jacobian = np.column_stack([columns, slope])
    variance = rss / max(len(speed) - 3, 1)
    stds = np.sqrt(np.diag(np.linalg.pinv(jacobian.T @ jacobian, hermitian=True)) * variance)
    return SpeedKnee(float(solution[0]), float(solution[1]), knee, float(stds[0]), float(stds[1]), float(stds[2]))
