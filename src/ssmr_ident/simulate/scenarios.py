"""What is done to the robot: the experiments of the thesis as plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.physics.linear import COORDINATES, linear_robot
from ssmr_ident.physics.robot import Robot

ROPE_STIFFNESS = 6430.0  # N/m; (3.9) with 5 kN/m measured over a rope and 22.5 kN/m of tire
STEEL_STIFFNESS = 1e6  # N/m; thesis section 4
_PUSHING_HEIGHT = 0.5  # m above the CoM: the top of the frame
_TURNING_ARM = 0.5  # m
FIXTURE = (1e6, 1e5)  # N/m along x and N m/rad about z of the fixture that holds the robot (robot_kernel.py)


@dataclass(frozen=True, eq=False)
class Scenario:
    """One experiment for the robot.

    Parameters
    ----------
    experiment : str
        ``free_response``, ``pull``, ``swivel`` or ``straight``.
    duration : float [s]
    offset : mapping
        Start away from rest: ``x``, ``y``, ``z`` [m], ``roll``, ``pitch``, ``yaw`` [rad]; with a flexible mast also
        ``sway_x``, ``sway_y`` [m]. ``brace_x`` is how far the front tires are strained forward and the rear ones
        backward against each other, ``brace_y`` the same for left and right [m]: what a light wheel that slid while
        the robot was pushed leaves behind. ``loaded`` is the share of the state in which a quick push to this place
        leaves friction, loops and relaxing branches of the tires; 0 is at rest. ``unseen`` is the share of the first
        acceleration that the sensor's low-pass has not met yet: 1 where what held the robot lets go at once. Belts
        begin in equilibrium with the tires.
    velocity : mapping
        Start velocities: ``x``, ``y``, ``z`` [m/s], ``roll``, ``pitch``, ``yaw`` [rad/s], ``sway_x``, ``sway_y`` [m/s].
    wheel_rates : (k, 2) float [rad/s]
        Wanted rates of the left and right wheels at multiples of ``wheel_rate_step``, held in between.
    wheel_rate_step : float [s]
    head : (m,) float [m]
        Travel of the pulling head at multiples of ``head_step``; empty when nothing pulls.
    head_step : float [s]
    direction : str
        ``lateral`` pulls along +y, ``longitudinal`` along -x (backwards, as in section 3.3).
    height : float [m]
        Of the cable above the floor.
    wheels_gripping : tuple of int
        1 rear left, 2 front left, 3 front right, 4 rear right; the others stand on oiled plates.
    cable_stiffness, cable_damping : float or None
        None takes the robot's own.
    held : bool
        A fixture keeps the robot from driving off and turning while its wheels spin.
    """

    experiment: str
    duration: float
    offset: Mapping[str, float] = field(default_factory=dict)
    velocity: Mapping[str, float] = field(default_factory=dict)
    wheel_rates: np.ndarray = field(default_factory=lambda: np.zeros((1, 2)))
    wheel_rate_step: float = 1.0
    head: np.ndarray = field(default_factory=lambda: np.zeros(0))
    head_step: float = 1.0
    direction: str = "lateral"
    height: float = 0.05
    wheels_gripping: tuple[int, ...] = (1, 2, 3, 4)
    cable_stiffness: float | None = None
    cable_damping: float | None = None
    held: bool = False


def free_response(motion: str, amplitude: float = 0.001, duration: float = 4.096) -> Scenario:
    """Let go from a tilt or a turn and left to swing.

    Parameters
    ----------
    motion : str
        ``roll``: left tires pressed and right ones relieved by ``amplitude`` (thesis (6.5)); ``pitch``: rear
        and front; ``yaw``: the contact points turned sideways by ``amplitude``.
    amplitude : float [m]
        At the wheels.
    duration : float [s]
    """
    lever = {"roll": 0.18, "pitch": 0.14, "yaw": 0.18}  # Table 5.1: c, mean of a and b, c
    if motion not in lever:
        raise InputError("motion", f"is {motion!r}", "Give roll, pitch or yaw")
    return Scenario("free_response", duration, offset={motion: amplitude / lever[motion]})


def released(robot: Robot, motion: str, force: float, duration: float = 4.096) -> Scenario:
    """Pushed or turned by a steady force and let go: the start is the robot's own static deflection.

    Parameters
    ----------
    robot : Robot
    motion : str
        ``roll`` pushes sideways and ``pitch`` lengthwise at the height of the frame's top; ``yaw`` turns by the
        same force at half a metre.
    force : float [N]
    duration : float [s]
    """
    directions = {"roll": (0.0, 1.0), "pitch": (1.0, 0.0), "yaw": (0.0, 0.0)}
    if motion not in directions:
        raise InputError("motion", f"is {motion!r}", "Give roll, pitch or yaw")
    along, across = (force * share for share in directions[motion])
    turning = force * _TURNING_ARM if motion == "yaw" else 0.0
    wrench = np.array([along, across, 0.0, -across * _PUSHING_HEIGHT, along * _PUSHING_HEIGHT, turning])
    offset = np.linalg.solve(linear_robot(robot).stiffness, wrench)
    return Scenario("free_response", duration, offset=dict(zip(COORDINATES, map(float, offset), strict=True)))


def pull(
    direction: str = "lateral",
    speed_mm_s: float = 1.0,
    duration: float = 16.0,
    cable: str | Mapping[str, float] | None = "steel",
    **fields: object,
) -> Scenario:
    """Pulled at constant speed by a cable; ``fields`` are those of Scenario."""
    stiffness, damping = cable_properties(cable)
    head = np.array([0.0, speed_mm_s * 1e-3 * duration])
    return Scenario(
        "pull",
        duration,
        head=head,
        head_step=duration,
        direction=direction,
        cable_stiffness=stiffness,
        cable_damping=damping,
        **fields,  # type: ignore[arg-type]
    )


def fixture_needed(wheels_gripping: tuple[int, ...], wheel_rate: float = 0.0) -> bool:
    """Whether a pull is made in the fixture: spinning wheels drive off, and about one gripping wheel the body turns."""
    return wheel_rate != 0.0 or len(wheels_gripping) == 1


def cable_properties(cable: str | Mapping[str, float] | None) -> tuple[float | None, float | None]:
    """Stiffness [N/m] and damping [N s/m] of a named or described cable; None leaves it to the robot."""
    if cable is None or cable == "steel":
        return None, None
    if cable == "rope":
        return ROPE_STIFFNESS, None
    if isinstance(cable, str):
        raise InputError("cable", f"is {cable!r}", "Give steel, rope or {stiffness_N_m: …}")
    return cable.get("stiffness_N_m"), cable.get("damping_N_s_m")


def swivel(wheel_rates: np.ndarray, duration: float = 20.0) -> Scenario:
    """Turning on the spot: constant wanted rates of the left and right wheels, (2,) float [rad/s]."""
    return Scenario("swivel", duration, wheel_rates=np.atleast_2d(wheel_rates))


def straight(wheel_rates: np.ndarray, duration: float = 10.0) -> Scenario:
    """Driving straight on: constant wanted rates of the left and right wheels, (2,) float [rad/s]."""
    return Scenario("straight", duration, wheel_rates=np.atleast_2d(wheel_rates))
