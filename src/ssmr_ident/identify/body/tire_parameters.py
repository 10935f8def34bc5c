"""From modes to tire and body parameters by the thesis' pure-rotation model: (5.3), (5.9), (5.10), and exactly.

(5.10) is kept as printed, for comparison; ``solve_damping`` is the same model without its short cut.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.shown import Shown

MOTIONS = ("roll", "pitch", "yaw")


@dataclass(frozen=True)
class Geometry:
    """Where the wheels touch the ground, seen from the centre of mass.

    Parameters
    ----------
    height : float [m]
        h, of the centre of mass.
    half_track : float [m]
        c.
    half_wheelbase : float [m]
        a = b of chapter 5; the mean of the two where they differ.
    """

    height: float = 0.23
    half_track: float = 0.18
    half_wheelbase: float = 0.14


@dataclass(frozen=True)
class TireParameters(Shown):
    """Result of (5.10), or of the exact 3×3 system.

    Parameters
    ----------
    inertia : (3,) float [kg m^2]
        I_x, I_y, I_z that the modes and stiffnesses ask for.
    damping : (3,) float [N s/m]
        D_x, D_y, D_z per tire.
    findings : tuple of str
        What is wrong with them, in words.
    """

    inertia: np.ndarray
    damping: np.ndarray
    findings: tuple[str, ...]

    def __str__(self) -> str:
        rows = [f"  I_{axis} = {value:8.3f} kg m^2" for axis, value in zip("xyz", self.inertia, strict=True)]
        rows += [f"  D_{axis} = {value:8.1f} N s/m" for axis, value in zip("xyz", self.damping, strict=True)]
        return "\n".join(["pure rotations (5.3)", *rows, *self.findings])


def natural_frequency(frequency_hz: float | np.ndarray, decay_rate: float | np.ndarray) -> np.ndarray:
    """ω_n = √(4π²f² + λ²) [rad/s] from the damped frequency and the decay rate [1/s] (5.9).

    >>> natural_frequency(np.array([6.04, 3.05, 7.51]), np.array([2, 3.5, 4.5])).round(4)
    array([38.0031, 19.4807, 47.4008])
    """
    result: np.ndarray = np.sqrt(4 * math.pi**2 * np.asarray(frequency_hz) ** 2 + np.asarray(decay_rate) ** 2)
    return result


def damping_ratio(frequency_hz: float | np.ndarray, decay_rate: float | np.ndarray) -> np.ndarray:
    """ξ = λ/ω_n (5.9)."""
    result: np.ndarray = np.asarray(decay_rate) / natural_frequency(frequency_hz, decay_rate)
    return result


def rotation_matrix(geometry: Geometry) -> np.ndarray:
    """Square arms of (5.3): rows roll, pitch, yaw; columns the tire's x, y, z; (3, 3) float [m^2].

    Times K (or D) per tire it is the rotational stiffness (or damping).
    """
    h, c, a = geometry.height, geometry.half_track, geometry.half_wheelbase
    return 4.0 * np.array([[0, h**2, c**2], [h**2, 0, a**2], [c**2, a**2, 0]])


def rotation_modes(
    inertia: np.ndarray, stiffness: np.ndarray, damping: np.ndarray, geometry: Geometry
) -> tuple[np.ndarray, np.ndarray]:
    """ω_n [rad/s] and ξ of the pure rotations (5.3), each (3,): roll, pitch, yaw.

    Parameters
    ----------
    inertia : (3,) float [kg m^2]
    stiffness : (3,) float [N/m]
    damping : (3,) float [N s/m]
    """
    arms = rotation_matrix(geometry)
    natural = np.sqrt(arms @ stiffness / inertia)
    return natural, (arms @ damping) / (2 * inertia * natural)


def rotation_inertia(natural: np.ndarray, stiffness: np.ndarray, geometry: Geometry) -> np.ndarray:
    """I = stiffness/ω_n² (5.10), (3,) float [kg m^2]."""
    result: np.ndarray = rotation_matrix(geometry) @ stiffness / np.asarray(natural) ** 2
    return result


def damping_as_printed(
    natural: np.ndarray, xi: np.ndarray, stiffness: np.ndarray, geometry: Geometry
) -> TireParameters:
    """(5.10) as the thesis prints it.

    Its D_x follows from subtracting the yaw from the pitch equation with D_y = D_z, an assumption that its own
    D_y and D_z then break, and it leaves the roll equation out.

    Parameters
    ----------
    natural, xi : (3,) float [rad/s], [1]
        Roll, pitch, yaw.
    stiffness : (3,) float [N/m]
        The thesis' numbers come with K_x = 6000, the sum of both belts, though (5.3) counts it per wheel.
    """
    inertia = rotation_inertia(natural, stiffness, geometry)
    h, c, a = geometry.height, geometry.half_track, geometry.half_wheelbase
    products = inertia * np.asarray(natural) * np.asarray(xi)
    d_x = (products[2] - products[1]) / (2 * (c**2 - h**2))
    d_y = (2 * products[2] - 4 * c**2 * d_x) / (4 * a**2)
    d_z = (2 * products[1] - 4 * h**2 * d_x) / (4 * a**2)
    damping = np.array([d_x, d_y, d_z])
    return TireParameters(inertia, damping, not_passive(damping))


def solve_damping(natural: np.ndarray, xi: np.ndarray, stiffness: np.ndarray, geometry: Geometry) -> TireParameters:
    """The three damping equations of (5.3), linear in D, solved exactly. Parameters as above."""
    inertia = rotation_inertia(natural, stiffness, geometry)
    damping = np.linalg.solve(rotation_matrix(geometry), 2 * inertia * np.asarray(natural) * np.asarray(xi))
    return TireParameters(inertia, damping, not_passive(damping))


def not_passive(damping: np.ndarray) -> tuple[str, ...]:
    """A sentence per negative damping: such a tire would feed the vibration."""
    return tuple(
        f"D_{axis} = {value:.0f} N s/m is negative: no passive tire has that, so the model behind it is wrong"
        for axis, value in zip("xyz", damping, strict=True)
        if value < 0
    )
