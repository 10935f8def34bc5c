"""A robot's unknowns and what its recordings say of them, for ``most_probable``."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import t as student

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.body.builder import DAMPING, HEIGHT, SENSOR, SHIFTS, STIFFNESS, RobotBuilder
from ssmr_ident.identify.body.coupled import FURTHER, body_modes
from ssmr_ident.identify.body.tire_parameters import Geometry, rotation_modes
from ssmr_ident.identify.decays.result import DecayFit, Mode
from ssmr_ident.identify.posterior.most_probable import Observation, Unknown
from ssmr_ident.physics.robot import Robot

LINEAR_FREQUENCY = 0.001
LINEARDAMPING = 0.01
"""Shares by which modes of small motions may differ from those of the motions that were recorded (finite angles,
sensor, rest pose). Simulated decays whose robot is known differ by at most 0.04 % and 1.2 %."""

_KEYS = (
    *("mass_kg", "inertia_kg_m2.xx", "inertia_kg_m2.yy", "inertia_kg_m2.zz"),
    *("inertia_kg_m2.xz", "inertia_kg_m2.xy", "inertia_kg_m2.yz"),
    *STIFFNESS,
    *DAMPING,
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
        found.append(Unknown(HEIGHT, "m", height, _spread(contacts.std)))
        if contacts.std is not None:
            found += [Unknown(name, "m", 0.0, _spread(contacts.std), positive=False) for name in SHIFTS]
    position = parameters.get("accelerometer.position_m")
    if position is not None and position.std is not None and not position.fixed:
        place = np.asarray(position.value, float)
        found += [
            Unknown(name, "m", float(value), _spread(position.std), positive=False)
            for name, value in zip(SENSOR, place, strict=True)
        ]
    return tuple(found)


def _positive(key: str) -> bool:
    """Products of inertia have either sign; a damping that comes out negative is a finding, not to be hidden."""
    return key[-3:] not in (".xy", ".xz", ".yz") and not key.startswith("tire.damping")


def _spread(std: float | None) -> float | None:
    """A std of 0 in a file means exactly known; a millionth keeps the algebra regular."""
    return None if std is None else max(std, 1e-9)


def set_aside(unknowns: Sequence[Unknown], motions: Collection[str]) -> tuple[Unknown, ...]:
    """Unknowns for pure rotations as the thesis solves them (5.10): stiffness and geometry as known, the rest free.

    Parameters
    ----------
    unknowns : sequence of Unknown
    motions : collection of str
        That were recorded.

    Notes
    -----
    (5.10) asks which inertia and damping the modes need once the pulls have told the stiffness. Their own priors are
    set aside, so that what the model lacks shows where the thesis saw it, in the inertia, and not in all
    parameters a little.
    """
    axes = {"roll": "xx", "pitch": "yy", "yaw": "zz"}
    free = {f"inertia_kg_m2.{axes[motion]}" for motion in motions if motion in axes}
    if free:
        free |= {f"tire.damping_{axis}_N_s_m" for axis in "xyz"}
    return tuple(replace(u, prior_std=None) if u.name in free else u for u in unknowns)


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
        floor = np.array([LINEAR_FREQUENCY, LINEARDAMPING]) * np.abs(mean)
        variance = np.maximum(own, (share * mean) ** 2) / len(trials) + floor**2
        combined[motion] = (mean, np.diag(variance))
    return combined


def match_further(modes: Sequence[Mode], main: Mode, expected: Mapping[str, tuple[float, float]]) -> dict[str, Mode]:
    """Modes of a log beside its main one, by the further mode of the body that each is nearest to.

    Parameters
    ----------
    modes : sequence of Mode
    main : Mode
        Left out.
    expected : mapping of name to (ω_n, ξ)
        Of the body as it was known beforehand.

    Notes
    -----
    A mode counts when its frequency is known to 2 % and lies within 25 % of the expected one, which is what the
    stiffnesses are usually known to, and nearer to it than to any main mode: a roll's log may show the yaw as well.
    """
    found: dict[str, Mode] = {}
    for mode in modes:
        if mode is main or mode.omega_n_std > 0.02 * mode.omega_n or mode.xi_std > 0.2 * abs(mode.xi):
            continue
        distance = {name: abs(math.log(mode.omega_n / omega)) for name, (omega, _) in expected.items()}
        name = min(distance, key=lambda key: distance[key])
        if not name.startswith(FURTHER) or distance[name] > 0.25:
            continue
        if name not in found or mode.omega_n_std < found[name].omega_n_std:
            found[name] = mode
    return found


def modal_observations(
    modes: Mapping[str, Sequence[Mode]], builder: RobotBuilder, decoupled: bool
) -> list[Observation]:
    """One observation per motion or further mode: its mean ω_n and ξ; further modes only where two logs show them."""
    main = {name: trials for name, trials in modes.items() if not name.startswith(FURTHER)}
    further = {name: trials for name, trials in modes.items() if name.startswith(FURTHER) and len(trials) > 1}
    observations = []
    last: dict[tuple[float, ...], dict[str, tuple[float, float]]] = {}

    def modes_at(values: Mapping[str, float]) -> dict[str, tuple[float, float]]:
        """Asked once for every motion at the same values: worked out once."""
        key = tuple(values.values())
        if key not in last:
            last.clear()
            last[key] = predicted_modes(builder(values), decoupled)
        return last[key]

    for name, (mean, covariance) in (combine_trials(main) | ({} if decoupled else combine_trials(further))).items():

        def predict(values: Mapping[str, float], name: str = name) -> np.ndarray:
            found = modes_at(values).get(name)
            # An over-damped motion has no mode: far from every measured one, so that the fit turns back.
            return np.array(found if found is not None else (1.0, 1.0))

        observations.append(Observation(name, ("omega_n", "xi"), mean, covariance, predict))
    return observations
