"""A robot's unknowns and what its recordings say of them, for ``most_probable``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import t as student

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.coupled import body_modes
from ssmr_ident.identify.decay_result import DecayFit, Mode
from ssmr_ident.identify.friction import gripping_load
from ssmr_ident.identify.posterior import Observation, Unknown
from ssmr_ident.identify.pull_model import pull_stiffness
from ssmr_ident.identify.tire_parameters import Geometry, rotation_modes
from ssmr_ident.physics.robot import Robot, robot_from_parameters

HEIGHT = "height_m"
"""Height of the centre of mass; the contact points' common z in the file."""

LINEAR_FREQUENCY = 0.001
LINEAR_DAMPING = 0.01
"""Shares by which modes of small motions may differ from those of the motions that were recorded (finite angles,
sensor, rest pose). Simulated decays whose robot is known differ by at most 0.04 % and 1.2 %."""

SLOPE_SHARE = 0.003
"""The same for the slope of a pull's first rise; there the largest difference seen is 0.3 %."""

FRICTION_SHARE = 0.01
"""Wheels do not let go at the same moment, so the force of a pull reaches µ·N within about a percent."""

SHARES = {"share at peaks": 0.05, "share at troughs": 0.10}
"""Standard deviation of what teeth reach of µ·N: wheels let go one after another, so a peak stays below µ_s·N and a
trough above µ_k·N, by an amount that all pulls of a session have in common. In simulated pulls whose friction is known
peaks reach 0.94 to 1.00 of it and troughs 0.97 to 1.14."""

_KEYS = (
    *("mass_kg", "inertia_kg_m2.xx", "inertia_kg_m2.yy", "inertia_kg_m2.zz", "inertia_kg_m2.xz"),
    *(f"tire.stiffness_{axis}_N_m" for axis in "xyz"),
    *(f"tire.damping_{axis}_N_s_m" for axis in "xyz"),
    *("tire.mu_static", "tire.mu_kinetic", "cable.stiffness_N_m"),
)


def robot_unknowns(parameters: ParameterSet) -> tuple[Unknown, ...]:
    """The parameters of a robot file that a fit may move, with their priors; ``fixed`` ones are left out."""
    found = []
    for key in _KEYS:
        if key in parameters and not parameters[key].fixed:
            estimate = parameters[key]
            found.append(Unknown(key, estimate.unit, float(estimate.value), _spread(estimate.std), _positive(key)))
    contacts = parameters["contact_points_m"]
    if not contacts.fixed:
        height = -float(np.mean(np.asarray(contacts.value)[:, 2]))
        found.append(Unknown(HEIGHT, "m", height, contacts.std))
    return tuple(found)


def _positive(key: str) -> bool:
    """Products of inertia have either sign; a damping that comes out negative is a finding, not to be hidden."""
    return key != "inertia_kg_m2.xz" and not key.startswith("tire.damping")


def _spread(std: float | None) -> float | None:
    """A std of 0 in a file means exactly known; a millionth keeps the algebra regular."""
    return None if std is None else max(std, 1e-9)


@dataclass(frozen=True)
class RobotBuilder:
    """From parameter values to a robot.

    Parameters
    ----------
    nominal : Robot
        As the file has it.
    """

    nominal: Robot

    @staticmethod
    def of(parameters: ParameterSet) -> RobotBuilder:
        return RobotBuilder(robot_from_parameters(parameters))

    def __call__(self, values: Mapping[str, float]) -> Robot:
        robot = self.nominal
        inertia = robot.inertia.copy()
        for row, column, axis in ((0, 0, "xx"), (1, 1, "yy"), (2, 2, "zz"), (0, 2, "xz"), (2, 0, "xz")):
            inertia[row, column] = values.get(f"inertia_kg_m2.{axis}", inertia[row, column])
        points = robot.contact_points.copy()
        if HEIGHT in values:
            points[:, 2] -= values[HEIGHT] - robot.height
        return replace(
            robot,
            mass=values.get("mass_kg", robot.mass),
            inertia=inertia,
            contact_points=points,
            stiffness=np.array(
                [values.get(f"tire.stiffness_{a}_N_m", robot.stiffness[i]) for i, a in enumerate("xyz")]
            ),
            damping=np.array([values.get(f"tire.damping_{a}_N_s_m", robot.damping[i]) for i, a in enumerate("xyz")]),
            mu_static=values.get("tire.mu_static", robot.mu_static),
            mu_kinetic=values.get("tire.mu_kinetic", robot.mu_kinetic),
            cable_stiffness=values.get("cable.stiffness_N_m", robot.cable_stiffness),
        )


def geometry_of(robot: Robot) -> Geometry:
    """h, c and a of (5.3); a² is the mean square distance of the axles, which is what (5.3) needs where a ≠ b."""
    return Geometry(robot.height, robot.half_track, float(np.sqrt(np.mean(robot.contact_points[:, 0] ** 2))))


def predicted_modes(robot: Robot, decoupled: bool) -> dict[str, tuple[float, float]]:
    """ω_n [rad/s] and ξ by motion, from pure rotations (5.3) or from the body on its tires."""
    if not decoupled:
        return body_modes(robot)
    natural, xi = rotation_modes(np.diag(robot.inertia), robot.stiffness, robot.damping, geometry_of(robot))
    return {motion: (float(natural[k]), float(xi[k])) for k, motion in enumerate(("roll", "pitch", "yaw"))}


def pick_mode(fit: DecayFit, expected: tuple[float, float] | None) -> Mode:
    """The mode a motion is known by: that of the largest displacement, or of comparable ones the expected one.

    Accelerometers show fast modes ω² times larger than they move the body, so the energy of the displacement
    decides: A²/(ω⁴λ). Roll and yaw lie close together and each shows in the other's log; modes with at least a
    third of the largest energy count as comparable, and then the nearest to the expected frequency is taken.
    """

    def energy(mode: Mode) -> float:
        return float(np.sum(mode.amplitudes**2)) / mode.omega_n**4 / max(mode.decay_rate, 1e-9)

    largest = max(fit.modes, key=energy)
    if expected is None:
        return largest
    strong = [mode for mode in fit.modes if energy(mode) > energy(largest) / 3]
    return min(strong, key=lambda mode: abs(math.log(mode.omega_n / expected[0])))


def combine_trials(modes: Mapping[str, Sequence[Mode]]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Mean (ω_n, ξ) of each motion over its trials, and the covariance of that mean.

    Parameters
    ----------
    modes : mapping of motion to its trials' modes

    Returns
    -------
    dict of motion to ((2,) float, (2, 2) float)

    Notes
    -----
    Trials differ by more than their own noise says (amplitude, placing), so the scatter between trials counts;
    it is taken relative to the mean and pooled over motions, for three trials alone say little of it. With few
    degrees of freedom the standard deviation is widened to Student's 95 % point.
    """
    scatter, freedom = np.zeros(2), 0
    for trials in modes.values():
        if len(trials) > 1:
            points = np.array([[mode.omega_n, mode.xi] for mode in trials])
            scatter += np.sum((points / points.mean(axis=0) - 1.0) ** 2, axis=0)
            freedom += len(trials) - 1
    widen = float(student.ppf(0.975, freedom) / 1.959964) if freedom else 1.0
    share = np.sqrt(scatter / freedom) * widen if freedom else np.zeros(2)
    combined = {}
    for motion, trials in modes.items():
        points = np.array([[mode.omega_n, mode.xi] for mode in trials])
        mean = points.mean(axis=0)
        own = np.mean([[mode.omega_n_std**2, mode.xi_std**2] for mode in trials], axis=0)
        floor = np.array([LINEAR_FREQUENCY, LINEAR_DAMPING]) * np.abs(mean)
        variance = np.maximum(own, (share * mean) ** 2) / len(trials) + floor**2
        combined[motion] = (mean, np.diag(variance))
    return combined


def modal_observations(
    modes: Mapping[str, Sequence[Mode]], builder: RobotBuilder, decoupled: bool
) -> list[Observation]:
    """One observation per motion: its mean ω_n and ξ."""
    observations = []
    for motion, (mean, covariance) in combine_trials(modes).items():

        def predict(values: Mapping[str, float], motion: str = motion) -> np.ndarray:
            found = predicted_modes(builder(values), decoupled).get(motion)
            # An over-damped motion has no mode: far from every measured one, so that the fit turns back.
            return np.array(found if found is not None else (1.0, 1.0))

        observations.append(Observation(motion, ("omega_n", "xi"), mean, covariance, predict))
    return observations


def slope_observation(
    name: str, slope: float, std: float, direction: str, height: float, gripping: tuple[int, ...],
    cable_stiffness: float | None, builder: RobotBuilder,
) -> Observation:  # fmt: skip
    """The first rise of a pull [N/m]."""

    def predict(values: Mapping[str, float]) -> np.ndarray:
        return np.array([pull_stiffness(builder(values), direction, height, gripping, cable_stiffness)])

    variance = std**2 + (SLOPE_SHARE * slope) ** 2
    return Observation(name, ("first rise N/m",), np.array([slope]), np.array([[variance]]), predict)


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
