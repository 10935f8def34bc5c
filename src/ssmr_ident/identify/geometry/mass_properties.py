"""Centre of mass from weighings, and inertia from components with parallel axes (5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.shown import Shown

Array = np.ndarray


@dataclass(frozen=True)
class Measured(Shown):
    """A length with its standard deviation [m]."""

    value: float
    std: float

    def __str__(self) -> str:
        return f"{self.value:.4f} ± {self.std:.1g} m"


def from_two_weighings(
    front: float, rear: float, distance: float, scale_std: float, distance_std: float = 0.0
) -> Measured:
    """Distance of the centre of mass from the rear support, from the loads on two supports.

    Parameters
    ----------
    front, rear : float [N] or [kg]
        What the scales under the two supports read.
    distance : float [m]
        Between the supports.
    scale_std : float
        Of one reading, in the unit of the readings.
    distance_std : float [m]

    Returns
    -------
    Measured

    Examples
    --------
    >>> print(from_two_weighings(15.0, 13.0, 0.28, 0.05))
    0.1500 ± 0.0004 m
    """
    total = front + rear
    value = distance * front / total
    by_front, by_rear = distance * rear / total**2, -distance * front / total**2
    std = np.sqrt((by_front**2 + by_rear**2) * scale_std**2 + (front / total * distance_std) ** 2)
    return Measured(float(value), float(std))


def height_from_tilting(
    angle_left: float, angle_right: float, half_track: float, angle_std: float, half_track_std: float = 0.0
) -> tuple[Measured, Measured]:
    """Height and sideways place of the centre of mass from the angles at which the robot tips over.

    Parameters
    ----------
    angle_left, angle_right : float [rad]
        Tilt at which it balances on its left and on its right wheels.
    half_track : float [m]
        Half the distance between the lines it tips about.
    angle_std : float [rad]
        Of one angle.
    half_track_std : float [m]

    Returns
    -------
    (height, offset to the left) : Measured

    Notes
    -----
    Tipping about the left edge it balances when tan(angle) = (c − y)/h, about the right one when it is (c + y)/h.
    """
    left, right = np.tan(angle_left), np.tan(angle_right)
    height = 2 * half_track / (left + right)
    offset = half_track - height * left
    slopes = np.array([1 / np.cos(angle_left) ** 2, 1 / np.cos(angle_right) ** 2]) * angle_std
    by_tan = -height / (left + right)
    height_std = np.sqrt(np.sum((by_tan * slopes) ** 2) + (height / half_track * half_track_std) ** 2)
    offset_by = np.array([-height - left * by_tan, -left * by_tan]) * slopes
    offset_std = np.sqrt(np.sum(offset_by**2) + (offset / half_track * half_track_std) ** 2)
    return Measured(float(height), float(height_std)), Measured(float(offset), float(offset_std))


@dataclass(frozen=True)
class Component:
    """A part of the robot.

    Parameters
    ----------
    mass : float [kg]
    place : (3,) float [m]
        Of its centre of mass, in any frame parallel to the body's.
    inertia : (3, 3) float [kg m^2]
        About its own centre of mass.
    """

    mass: float
    place: Array
    inertia: Array


def box(mass: float, size: Sequence[float], place: Sequence[float]) -> Component:
    """A homogeneous box.

    Parameters
    ----------
    mass : float [kg]
    size : (3,) float [m]
        Along x, y, z.
    place : (3,) float [m]
        Of its centre.
    """
    x, y, z = size
    return Component(mass, np.asarray(place, float), mass / 12 * np.diag([y**2 + z**2, x**2 + z**2, x**2 + y**2]))


def assemble(components: Sequence[Component]) -> Component:
    """The whole from its parts, by parallel axes: mass, centre of mass, inertia about it (5.1)."""
    mass = sum(part.mass for part in components)
    place = sum((part.mass * part.place for part in components), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in components:
        arm = part.place - place
        inertia += part.inertia + part.mass * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return Component(mass, place, inertia)
