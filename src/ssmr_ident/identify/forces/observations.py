"""What forces say of a robot: first rises, friction and single tires, as observations for ``most_probable``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ssmr_ident.identify.body.builder import SHIFTS, RobotBuilder
from ssmr_ident.identify.forces.friction import gripping_load
from ssmr_ident.identify.forces.pull_model import pull_stiffness
from ssmr_ident.identify.posterior.most_probable import Observation, Unknown

SLOPE_SHARE = 0.003
"""The same for the slope of a pull's first rise; there the largest difference seen is 0.3 %."""

FRICTION_SHARE = 0.01
"""Wheels do not let go at the same moment, so the force of a pull reaches µ·N within about a percent."""

SHARES = {"share at peaks": 0.05, "share at troughs": 0.10}
"""Standard deviation of what teeth reach of µ·N: wheels let go one after another, so a peak stays below µ_s·N and a
trough above µ_k·N, by an amount that all pulls of a session have in common. In simulated pulls whose friction is known
peaks reach 0.94 to 1.00 of it and troughs 0.97 to 1.14."""


def slope_observation(
    name: str, slope: float, std: float, direction: str, height: float, gripping: tuple[int, ...],
    cable_stiffness: float | None, builder: RobotBuilder,
) -> Observation:  # fmt: skip
    """The first rise of a pull [N/m]."""

    def predict(values: Mapping[str, float]) -> np.ndarray:
        return np.array([pull_stiffness(builder(values), direction, height, gripping, cable_stiffness)])

    variance = std**2 + (SLOPE_SHARE * slope) ** 2
    return Observation(name, (FIRST_RISE,), np.array([slope]), np.array([[variance]]), predict)


FIRST_RISE = "first rise N/m"

DRAWS = 64
"""Draws of the contact shifts in ``with_shifts_unknown``: a standard deviation known to 9 %."""


def with_shifts_unknown(
    observations: Sequence[Observation], unknowns: Sequence[Unknown], seed: int = 0
) -> tuple[list[Observation], tuple[Unknown, ...]]:
    """Observations that carry the centre of mass's place along x and y in their covariance, and the other unknowns.

    Parameters
    ----------
    observations : sequence of Observation
    unknowns : sequence of Unknown
    seed : int

    Notes
    -----
    A pull bends with the square of the distance between cable and centre of stiffness, so it tells how far off the
    middle the contacts are but not to which side: a derivative says nothing there. What the shifts' prior does to all
    first rises together, mean and covariance, is drawn instead.
    """
    shifts = [u for u in unknowns if u.name in SHIFTS and u.prior_std]
    rest = tuple(u for u in unknowns if u.name not in SHIFTS)
    rises = [o for o in observations if o.labels == (FIRST_RISE,)]
    if not shifts or len(rises) < 1:
        return list(observations), rest
    nominal = {u.name: u.prior for u in unknowns}
    centre = np.array([float(o.predict(nominal)[0]) for o in rises])
    rng = np.random.default_rng(seed)
    draws = []
    for _ in range(DRAWS // 2):
        step = rng.standard_normal(len(shifts))
        for sign in (1, -1):
            moved = {u.name: u.value(sign * float(x)) for u, x in zip(shifts, step, strict=True)}
            draws.append([float(o.predict({**nominal, **moved})[0]) for o in rises])
    ratios = np.array(draws) / centre
    mean, spread = ratios.mean(axis=0), np.cov(ratios.T).reshape(len(rises), len(rises))
    values = np.array([float(o.values[0]) for o in rises])
    own = np.diag([float(o.covariance[0, 0]) for o in rises])

    def predict(parameters: Mapping[str, float]) -> np.ndarray:
        result: np.ndarray = mean * np.array([float(o.predict(parameters)[0]) for o in rises])
        return result

    joint = Observation(
        "first rises", tuple(o.name for o in rises), values, own + spread * np.outer(values, values), predict
    )
    return [joint, *(o for o in observations if o.labels != (FIRST_RISE,))], rest


def friction_observation(
    name: str, key: str, force: float, std: float, direction: str, height: float, gripping: tuple[int, ...],
    builder: RobotBuilder, share: str | None = None,
) -> Observation:  # fmt: skip
    """The force at which a pull slides, or lets go [N]: µ times the load on the gripping wheels.

    Parameters
    ----------
    key : str
        Name of the coefficient among the unknowns; each floor has its own.
    share : str, optional
        The one of ``SHARES`` by which the force may differ from µ·N in all pulls alike.
    """

    def predict(values: Mapping[str, float]) -> np.ndarray:
        robot = builder(values)
        own = robot.mu_static if key == "tire.mu_static" else robot.mu_kinetic
        mu = values.get(key, own) * (1.0 if share is None else values[share])
        return np.array([mu * gripping_load(robot, gripping, direction, height, force)])

    variance = std**2 + (FRICTION_SHARE * force) ** 2
    return Observation(name, (f"force at {key}",), np.array([force]), np.array([[variance]]), predict)


def single_wheel_observation(name: str, key: str, slope: float, std: float) -> Observation:
    """Stiffness of one tire along one axis [N/m]."""

    def predict(values: Mapping[str, float]) -> np.ndarray:
        return np.array([values[key]])

    variance = std**2 + (SLOPE_SHARE * slope) ** 2
    return Observation(name, (f"{key}",), np.array([slope]), np.array([[variance]]), predict)
