"""Where each kernel-level effect parameter sits in the simulator's effect vector."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import ParameterSet, effect_and_element
from ssmr_ident.core.rotary import rotary_name
from ssmr_ident.physics.effects import CATALOGUE, unlisted

SLOTS = (
    "nonlinear_stiffness.k3_N_m3",
    "nonlinear_stiffness.knee_share",
    "nonlinear_stiffness.knee_m",
    "nonlinear_stiffness.k3_share_1_m2",
    "nonlinear_stiffness.sine_share",
    "quadratic_damping.d2_N_s2_m2",
    "dry_friction.F_c_N",
    "dry_friction.element_stiffness_N_m",
    "dry_friction.slider",
    "dry_friction.rounding_m_s",
    "hysteresis.alpha",
    "hysteresis.yield_m",
    "hysteresis.exponent",
    "hysteresis.shape",
    "viscoelastic_relaxation.K_m_N_m",
    "viscoelastic_relaxation.tau_s",
    "free_play.gap_m",
    "free_play.rounding",
    "free_play.share_x",
    "stribeck.kinetic_share",
    "stribeck.stribeck_velocity_m_s",
    "stribeck.exponent",
    "load_sensitive_friction.exponent",
    "rolling_resistance.c_rr",
    "ground_joints.depth_m",
    "ground_joints.pitch_m",
    "ground_joints.width_m",
    "wheel_eccentricity.eccentricity_m",
    "ground_roughness.height_m",
    "wheel_lift.active",
    "coriolis.share",
    "flexible_mast.f_mast_Hz",
    "flexible_mast.mass_kg",
    "flexible_mast.height_above_com_m",
    "flexible_mast.damping_ratio",
    "motor_belt.K_b_N_m",
    "motor_belt.D_b_N_s_m",
    "motor_belt.rim_mass_kg",
    "load_dependent_friction.F_c_N",
    "load_dependent_friction.c",
    "load_dependent_friction.rounding_m_s",
    *(f"unlisted.{parameter.name}" for parameter in unlisted.EFFECT.parameters),
)
CUBIC, KNEE_SHARE, KNEE, CUBIC_SHARE, SINE_SHARE, QUADRATIC = range(6)
FRICTION_FORCE, FRICTION_STIFFNESS, SLIDER, FRICTION_ROUNDING = range(6, 10)
ALPHA, YIELD, LOOP_EXPONENT, LOOP_SHAPE = range(10, 14)
RELAXATION_STIFFNESS, RELAXATION_TIME, GAP, GAP_ROUNDING, GAP_SHARE_X = range(14, 19)
KINETIC_SHARE, STRIBECK_SPEED, STRIBECK_EXPONENT, LOAD_EXPONENT, ROLLING = range(19, 24)
JOINT_DEPTH, JOINT_PITCH, JOINT_WIDTH, ECCENTRICITY, ROUGHNESS = range(24, 29)
LIFT, CORIOLIS, MAST_HZ, MAST_MASS, MAST_HEIGHT, MAST_DAMPING = range(29, 35)
BELT_STIFFNESS, BELT_DAMPING, RIM_MASS = range(35, 38)
LOAD_FRICTION, LOAD_SHARE, LOAD_ROUNDING, UNLISTED = range(38, 42)
"""First of what no list holds; these are the last slots."""

Effects = Mapping[str, Mapping[str, float]]


def checked(effects: Effects) -> dict[str, dict[str, float]]:
    """All parameters of the given effects, nominal where none is given; of several that would switch an effect on, only
    those that are given do.

    Raises
    ------
    InputError
        An unknown effect or parameter, or a value out of bounds.
    """
    result = {}
    for key, given in effects.items():
        effect_id, _ = effect_and_element(key)
        if effect_id not in CATALOGUE:
            raise InputError(f"effects: {effect_id}", "is no known effect", did_you_mean(effect_id, CATALOGUE))
        effect = CATALOGUE[effect_id]
        bounds = {p.name: p for p in effect.parameters}
        turned = {rotary_name(p.name, p.unit): p.name for p in effect.parameters}
        plain = {turned.get(name, name): value for name, value in given.items()}
        for name, value in plain.items():
            if name not in bounds:
                where = f"effects: {effect_id}.{name}"
                raise InputError(where, "is no parameter of this effect", did_you_mean(name, bounds))
            if not bounds[name].lower <= value <= bounds[name].upper:
                limits = f"{bounds[name].lower:g} … {bounds[name].upper:g} {bounds[name].unit}"
                raise InputError(f"effects: {effect_id}.{name}", f"is {value:g}, expected {limits}")
        result[key] = effect.begun(plain)
    return result


def checked_for_robot(effects: Effects) -> dict[str, dict[str, float]]:
    """``checked``, for a robot or a wheel of it.

    Raises
    ------
    InputError
        As ``checked``, and where a part of the mass rides along as on a rig.
    """
    active = checked(effects)
    if active.get("unlisted", {}).get("rider_share"):
        raise InputError(
            "effects: unlisted.rider_share", "is a part of a rig's mass", "On a robot this is flexible_mast"
        )
    for name, values in active.items():
        if not (CATALOGUE[name].robot or CATALOGUE[name].is_off(values)):
            raise InputError(f"effects: {name}", "acts in the gears of a rig's drive", "A robot has no such joint")
    if active.get("sensor_bandwidth", {}).get("order", 2.0) < 2.0:
        raise InputError("effects: sensor_bandwidth.order", "is 1, of rigs alone", "Leave it out")
    if active.get("nonlinear_stiffness", {}).get("sine_share"):
        raise InputError("effects: nonlinear_stiffness.sine_share", "is of a rig that turns: a pendulum's moment")
    return active


def effect_values(parameters: ParameterSet) -> dict[str, dict[str, float]]:
    """The effects block of a parameter file as plain numbers, checked against the catalogue.

    Raises
    ------
    InputError
        An unknown effect or parameter, or a value out of bounds; names the file.
    """
    plain = {
        effect_id: {name: float(estimate.value) for name, estimate in block.items()}
        for effect_id, block in parameters.effects.items()
    }
    try:
        return checked(plain)
    except InputError as error:
        raise InputError(f"{parameters.file or parameters.name}: {error.where}", error.problem, error.mend) from None


def effect_vector(effects: Mapping[str, Mapping[str, float]]) -> np.ndarray:
    """(len(SLOTS),) float: everything off but the given effects, whose values are complete."""
    vector = _OFF.copy()
    for effect_id, values in effects.items():
        for index, name in _PLACES.get(effect_id, ()):
            vector[index] = values[name]
    return vector


def is_plain(vector: np.ndarray) -> bool:
    """Whether none of the effects that the simulator's loop knows acts, but for a rough floor."""
    return np.array_equal(np.delete(vector, ROUGHNESS), np.delete(_OFF, ROUGHNESS))


def _off(slot: str) -> float:
    effect_id, name = slot.split(".")
    parameter = next(p for p in CATALOGUE[effect_id].parameters if p.name == name)
    return parameter.nominal if parameter.off is None else parameter.off


_OFF = np.array([_off(slot) for slot in SLOTS])
_PLACES: dict[str, list[tuple[int, str]]] = {}
for _index, _slot in enumerate(SLOTS):
    _PLACES.setdefault(_slot.split(".")[0], []).append((_index, _slot.split(".")[1]))
