"""A user's own rig: one mass on a spring and a damper, straight or rotary; and a block dragged over a surface."""

from __future__ import annotations

from dataclasses import dataclass

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet


@dataclass(frozen=True)
class Rig:
    """m x'' + d x' + k x = force. For a rotary rig read inertia, moment and angle.

    Parameters
    ----------
    mass : float [kg] or [kg m^2]
    damping : float [N s/m] or [N m s/rad]
    stiffness : float [N/m] or [N m/rad]
        0 for a mass that no spring holds.
    rotary : bool
    """

    mass: float
    damping: float
    stiffness: float
    rotary: bool = False


@dataclass(frozen=True)
class Block:
    """A block on a surface, pulled through a cable.

    Parameters
    ----------
    mass : float [kg]
    mu_static, mu_kinetic : float
    cable_stiffness, cable_damping : float [N/m, N s/m]
        Of drive and cable, in parallel; ``inf`` for a stiff one.
    """

    mass: float
    mu_static: float
    mu_kinetic: float
    cable_stiffness: float
    cable_damping: float = 0.0


RIG_KEYS = {
    False: ("mass_kg", "damping_N_s_m", "stiffness_N_m"),
    True: ("inertia_kg_m2", "damping_N_m_s_rad", "stiffness_N_m_rad"),
}


def rig_from_parameters(parameters: ParameterSet) -> Rig:
    """Build a rig; the keys decide whether it is rotary.

    Raises
    ------
    InputError
        A key is missing.
    """
    rotary = "inertia_kg_m2" in parameters
    mass, damping, stiffness = (_need(parameters, key) for key in RIG_KEYS[rotary])
    return Rig(mass, damping, stiffness, rotary)


def block_from_parameters(parameters: ParameterSet) -> Block:
    """Build a dragged block; the cable is stiff when the file has none.

    Raises
    ------
    InputError
        A key is missing.
    """
    return Block(
        _need(parameters, "mass_kg"),
        _need(parameters, "mu_static"),
        _need(parameters, "mu_kinetic"),
        parameters.number("cable.stiffness_N_m", float("inf")),
        parameters.number("cable.damping_N_s_m", 0.0),
    )


def _need(parameters: ParameterSet, key: str) -> float:
    if key not in parameters:
        where = f"{parameters.file or parameters.name}: {key}"
        raise InputError(where, "is missing", f"Write {key}: {{value: …, std: …}}")
    return float(parameters[key].value)
