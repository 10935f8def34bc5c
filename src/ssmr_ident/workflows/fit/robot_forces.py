"""Forces of a robot's session: what each pull, press and drag gives to the common fit."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.body.builder import SHIFTS, RobotBuilder
from ssmr_ident.identify.decays.result import Mode
from ssmr_ident.identify.forces.curves import load_curve
from ssmr_ident.identify.forces.friction import friction_of, full_teeth, gripping_load
from ssmr_ident.identify.forces.observations import (
    SHARES,
    friction_observation,
    single_wheel_observation,
    slope_observation,
)
from ssmr_ident.identify.forces.sawtooth import machine_moves, mean_with_wander, take_apart
from ssmr_ident.identify.posterior.most_probable import Observation, Posterior, Unknown
from ssmr_ident.report.figures_fit import NamedBackbone, NamedDecay, NamedPull
from ssmr_ident.workflows.fit.robot_result import ON_FLOOR, ROPE
from ssmr_ident.workflows.fit.speeds import AtSpeed

STEADY = 3.0
"""Spread of the sliding force over the noise of the first rise, below which a contact slides steadily: then the two
friction coefficients cannot be told apart, and the level is both."""


TROUGHS_DIFFER = 0.05
"""Standard deviation, from pull to pull, of what troughs reach of µ_k·N: 0.97 to 1.14 in simulated pulls whose friction
is known, taken as uniform."""


@dataclass
class Gathered:
    """What the recordings gave so far."""

    observations: list[Observation] = field(default_factory=list)
    modes: dict[str, list[Mode]] = field(default_factory=dict)
    lines: dict[str, tuple[str, ...]] = field(default_factory=dict)
    results: dict[str, dict[str, Any]] = field(default_factory=dict)
    findings: list[str] = field(default_factory=list)
    slipping: dict[str, list[AtSpeed]] = field(default_factory=dict)
    floor: str | None = None
    other_floors: list[str] = field(default_factory=list)
    springs: dict[str, list[AtSpeed]] = field(default_factory=dict)
    teeth: dict[str, int] = field(default_factory=dict)
    shares: bool = False
    pulls: int = 0
    rope: bool = False
    shift_std: float = 0.0
    backbones: list[NamedBackbone] = field(default_factory=list)
    decays: list[NamedDecay] = field(default_factory=list)
    drawn_pulls: list[NamedPull] = field(default_factory=list)


def machine_position(measurement: Measurement) -> np.ndarray:
    """Position of the machine [m]: logged, or time times the stated speed.

    Raises
    ------
    InputError
        When neither is there.
    """
    recording, speed = measurement.recording, measurement.entry.speed_mm_s
    if "position" in recording:
        return recording["position"]
    if speed is None:
        raise InputError(
            recording.provenance.file,
            "has no position channel and session.yaml gives no speed_mm_s",
            "Give speed_mm_s for this recording",
        )
    return recording.time * speed * 1e-3


def gather_pull(measurement: Measurement, builder: RobotBuilder, gathered: Gathered) -> None:
    entry, recording = measurement.entry, measurement.recording
    where = recording.provenance.file
    for key in ("direction", "height_m"):
        if getattr(entry, key) is None:
            raise InputError(f"{where}: {key}", "is missing", f"A pull needs {key} in session.yaml")
    direction, height = str(entry.direction), float(entry.height_m or 0.0)
    gathered.pulls += 1
    try:
        pull = take_apart(machine_position(measurement), recording["force"])
    except ValueError as error:
        raise InputError(where, f"no pull found: {error}", "Look at the log with ident inspect") from None
    robot = builder({})
    name, gripping = measurement.name, entry.wheels_gripping
    position = machine_position(measurement)
    moving = machine_moves(position)
    gathered.drawn_pulls.append(NamedPull(name, position[moving], recording["force"][moving], pull))
    cable = entry.cable
    if cable == "rope":
        gathered.rope = True
        rigid = slope_observation(
            name, pull.first.slope, pull.first.slope_std, direction, height, gripping, float("inf"), builder
        )
        gathered.observations.append(
            replace(
                rigid,
                predict=lambda values: 1.0 / (1.0 / rigid.predict(values) + 1.0 / values[ROPE]),
            )
        )
    else:
        stiffness = cable.get("stiffness_N_m") if isinstance(cable, dict) else None
        gathered.observations.append(
            slope_observation(
                name, pull.first.slope, pull.first.slope_std, direction, height, gripping, stiffness, builder
            )
        )
    lines = [f"{direction} pull, {len(gripping)} wheel(s) gripping", *str(pull).splitlines()]
    result: dict[str, Any] = {
        "experiment": entry.experiment,
        "direction": direction,
        "first_rise_N_m": pull.first.slope,
        "first_rise_std_N_m": pull.first.slope_std,
        "stick_slip": pull.stick_slip,
        "teeth": len(pull.teeth),
    }
    if direction == "longitudinal" and len(gripping) == 4:
        lines.append(f"K_belt = {pull.first.slope / 2 / 1e3:.3g} N/mm by (3.8)")
    if pull.slides:
        load_share = load_uncertainty(builder, gripping, direction, height, pull.level, gathered.shift_std)

        def load(force: float) -> float:
            return gripping_load(robot, gripping, direction, height, force)

        friction = friction_of(pull, load, load_share * load(pull.level))
        lines.append(str(friction))
        result |= {"mu_static": friction.mu_static, "mu_kinetic": friction.mu_kinetic, "load_N": friction.load}
        if pull.stick_slip:
            troughs = np.array([tooth.trough for tooth in full_teeth(pull)])
            forces = {
                "tire.mu_static": (pull.peak, 0.03 * pull.peak),
                "tire.mu_kinetic": (troughs.mean(), np.hypot(troughs.std(), TROUGHS_DIFFER * troughs.mean())),
            }
            gathered.teeth[name] = len(pull.teeth)
        elif pull.wander > STEADY * pull.first.scatter:
            # No teeth to speak of, but no steady sliding either: the level counts with its whole wander.
            forces = {"tire.mu_kinetic": (pull.level, pull.wander)}
        else:
            forces = {key: (pull.level, pull.level_std) for key in ("tire.mu_static", "tire.mu_kinetic")}
        for key, (force, std) in forces.items():
            share = None
            if pull.stick_slip or len(forces) == 1:
                gathered.shares = True
                share = "share at peaks" if key == "tire.mu_static" else "share at troughs"
            key = _on_floor(key, entry.floor, gathered)
            gathered.observations.append(
                friction_observation(
                    name,
                    key,
                    float(force),
                    float(np.hypot(std, load_share * force)),
                    direction,
                    height,
                    gripping,
                    builder,
                    share,
                )
            )
    gathered.lines[name] = tuple(lines)
    gathered.results[name] = result


def load_uncertainty(
    builder: RobotBuilder, gripping: tuple[int, ...], direction: str, height: float, force: float, shift_std: float
) -> float:
    """Share of the gripping wheels' load that the centre of mass's place leaves open; 0 where all four grip.

    Parameters
    ----------
    builder : RobotBuilder
    gripping : tuple of int
    direction : str
    height, force : float [m], [N]
    shift_std : float [m]
        Of the centre of mass along x and y.
    """
    load = gripping_load(builder({}), gripping, direction, height, force)
    moved = [gripping_load(builder({name: shift_std}), gripping, direction, height, force) for name in SHIFTS]
    return float(np.hypot(*(np.array(moved) - load))) / load


def gather_spinning(measurement: Measurement, builder: RobotBuilder, gathered: Gathered) -> None:
    """A pull whose wheels spin: the level of its second half over the load, at slip speed r·ω."""
    entry, force = measurement.entry, measurement.recording["force"]
    robot = builder({})
    level, std = mean_with_wander(force[len(force) // 2 :])
    direction, height = entry.direction or "lateral", entry.height_m or 0.0
    load = gripping_load(robot, entry.wheels_gripping, direction, height, level)
    speed = abs(float(entry.wheel_rate_rad_s or 0.0)) * robot.radius
    at_speed = AtSpeed(measurement.name, speed, level / load, std / load)
    gathered.slipping.setdefault(entry.floor or "", []).append(at_speed)
    gathered.lines[measurement.name] = (
        f"{direction} pull with wheels spinning at {speed:.3g} m/s: mu {level / load:.3f} ± {std / load:.2g}",
    )
    gathered.results[measurement.name] = {
        "experiment": entry.experiment,
        "slip_speed_m_s": speed,
        "mu_kinetic": level / load,
        "mu_kinetic_std": std / load,
    }


def gather_wheel(measurement: Measurement, gathered: Gathered) -> None:
    entry, recording = measurement.entry, measurement.recording
    try:
        curve = load_curve(machine_position(measurement), recording["force"])
    except ValueError as error:
        raise InputError(
            recording.provenance.file, f"no stiffness in it: {error}", "Look at the log with ident inspect"
        ) from None
    vertical = measurement.experiment.vertical
    key = "tire.stiffness_z_N_m" if vertical else "tire.stiffness_y_N_m"
    gathered.observations.append(single_wheel_observation(measurement.name, key, curve.stiffness, curve.stiffness_std))
    line = next(law for law in curve.choice.laws if law.name == "linear")
    speed = np.nan if entry.speed_mm_s is None else entry.speed_mm_s * 1e-3
    gathered.springs.setdefault("pressed down" if vertical else "dragged sideways", []).append(
        AtSpeed(measurement.name, speed, curve.stiffness, line.stds["stiffness"])
    )
    best = curve.choice.best
    law = ", ".join(f"{name} {value:.4g} ± {best.stds[name]:.2g}" for name, value in best.values.items())
    lines = [
        f"{'pressed down' if vertical else 'dragged sideways'}: {curve.stiffness / 1e3:.4g} +/- "
        f"{curve.stiffness_std / 1e3:.2g} N/mm from {curve.force_from:.0f} to {curve.force_to:.0f} N",
        f"best law: {best.name} ({law})" + ("" if curve.choice.decisive else ", not decisive"),
    ]
    if best.name != "linear" and curve.choice.decisive:
        gathered.findings.append(f"{measurement.name}: the tire's spring is not straight: {best.name} ({law})")
    gathered.lines[measurement.name] = tuple(lines)
    gathered.results[measurement.name] = {
        "experiment": entry.experiment,
        "stiffness_N_m": curve.stiffness,
        "stiffness_std_N_m": curve.stiffness_std,
        "law": best.name,
        **{f"law_{name}": value for name, value in best.values.items()},
    }


def stick_slip_findings(gathered: Gathered) -> list[str]:
    if not gathered.teeth:
        return []
    listed = ", ".join(f"{name} ({count} teeth)" for name, count in gathered.teeth.items())
    return [
        f"stick-slip in {len(gathered.teeth)} of {gathered.pulls} pulls, so friction falls once a contact slides: "
        f"{listed}"
    ]


def _on_floor(key: str, floor: str | None, gathered: Gathered) -> str:
    """Name of a friction coefficient: the file's key for the first floor met, a name of its own for any other."""
    if floor is None:
        return key
    gathered.floor = gathered.floor or floor
    if floor == gathered.floor:
        return key
    if floor not in gathered.other_floors:
        gathered.other_floors.append(floor)
    return f"{key}{ON_FLOOR}{floor}"


def share_unknowns(gathered: Gathered) -> tuple[Unknown, ...]:
    """What teeth reach of µ·N, one unknown each for peaks and troughs, where there are teeth."""
    return tuple(Unknown(name, "1", 1.0, std) for name, std in SHARES.items() if gathered.shares)


def floor_unknowns(unknowns: tuple[Unknown, ...], gathered: Gathered) -> tuple[Unknown, ...]:
    """Friction coefficients of further floors: the file's prior, for want of another, three times as wide."""
    return tuple(
        replace(
            unknown,
            name=f"{unknown.name}{ON_FLOOR}{floor}",
            prior_std=None if unknown.prior_std is None else 3 * unknown.prior_std,
        )
        for floor in gathered.other_floors
        for unknown in unknowns
        if unknown.name in ("tire.mu_static", "tire.mu_kinetic")
    )


def floor_findings(posterior: Posterior, gathered: Gathered) -> list[str]:
    found = []
    for floor in gathered.other_floors:
        parts = []
        for key in ("tire.mu_static", "tire.mu_kinetic"):
            value, std = posterior[f"{key}{ON_FLOOR}{floor}"]
            parts.append(f"{key.split('.')[1]} {value:.3f} ± {std:.2g}")
        found.append(f"on {floor}: {', '.join(parts)}; the parameters hold those on {gathered.floor}")
    return found
