"""The plant's robot as an MJCF model: a free body on twelve actuators that are its tires, with a mast and a hook."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.simulate.mjcf.bodies import POINT_INERTIA, steiner
from ssmr_ident.simulate.mjcf.build import AXES
from ssmr_ident.simulate.mjcf.text import row, six, text


@dataclass(frozen=True)
class Frame:
    """Part of the robot's mass on springs above the platform.

    Parameters
    ----------
    shape : str
        ``carriage``: a point mass that slides on two horizontal springs; ``rod``: a point mass at the end of a rod
        that leans about a joint of its own, 0.3 m below.
    frequency_hz : float [Hz]
        With the platform held.
    mass : float [kg]
    height : float [m]
        Of the mass above the robot's centre of mass.
    damping_ratio : float
    """

    shape: str
    frequency_hz: float
    mass: float
    height: float
    damping_ratio: float


@dataclass(frozen=True)
class Turned:
    """Angles of the accelerometer cube against the robot's axes [rad], turned about z, then y, then x."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


ROD = 0.3  # m


def robot_xml(
    robot: Robot, step: float, frame: Frame | None = None, turned: Turned | None = None, hook: np.ndarray | None = None
) -> str:
    """The model's XML.

    The tires' spring and damper act along the floor's axes at the contact points, as one actuator per wheel and axis
    that measures the way from a mark on the floor. What is no spring and damper comes in through the actuators'
    controls. There is no contact for the engine to find.

    Parameters
    ----------
    robot : Robot
    step : float [s]
    frame : Frame, optional
    turned : Turned, optional
    hook : (3,) float [m], optional
        Where a cable holds the robot, from the centre of mass.
    """
    mass, centre, inertia = platform(robot, frame)
    turned = turned or Turned()
    marks = "".join(
        f'    <site name="mark_{i}" pos="{text(p[0])} {text(p[1])} 0"/>\n' for i, p in enumerate(robot.contact_points)
    )
    feet = "".join(f'      <site name="foot_{i}" pos="{row(p)}"/>\n' for i, p in enumerate(robot.contact_points))
    springs = "".join(
        _spring(f"tire_{wheel}_{AXES[axis]}", wheel, axis, robot) for wheel in range(4) for axis in range(3)
    )
    held = "" if hook is None else f'      <site name="hook" pos="{row(hook)}"/>\n'
    pulled = "" if hook is None else "".join(_pull(axis) for axis in (0, 1))
    return f"""<mujoco model="plant">
  <compiler angle="radian" inertiafromgeom="false" eulerseq="zyx"/>
  <option timestep="{text(step)}" gravity="0 0 {-GRAVITY}" integrator="implicitfast">
    <flag contact="disable" constraint="disable" autoreset="disable"/>
  </option>
  <worldbody>
    <site name="origin"/>
{marks}    <body name="platform" pos="0 0 {text(robot.height)}">
      <freejoint name="platform"/>
      <inertial pos="{row(centre)}" mass="{text(mass)}" fullinertia="{row(six(inertia))}"/>
      <site name="sensor" pos="{row(robot.accelerometer.position)}" \
euler="{text(turned.z)} {text(turned.y)} {text(turned.x)}"/>
{feet}{held}{_frame(frame)}    </body>
  </worldbody>
  <actuator>
{springs}{pulled}  </actuator>
  <sensor>
    <accelerometer name="acceleration" site="sensor"/>
  </sensor>
</mujoco>
"""


def platform(robot: Robot, frame: Frame | None) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass [kg], centre [m] and inertia about it [kg m^2] of the robot without its frame: with the frame locked, the
    whole is the robot."""
    if frame is None:
        return robot.mass, np.zeros(3), robot.inertia
    place = np.array([0.0, 0.0, frame.height])
    mass = robot.mass - frame.mass
    centre = -frame.mass * place / mass
    inertia = robot.inertia - frame.mass * steiner(place) - mass * steiner(centre)
    moments = np.linalg.eigvalsh(inertia)
    if moments[0] <= 0.0 or moments[0] + moments[1] <= moments[2]:
        raise InputError("plant", "the frame holds more than the robot's inertia", "Give a lighter or lower frame")
    return mass, centre, inertia


def _spring(name: str, wheel: int, axis: int, robot: Robot) -> str:
    gear = " ".join("1" if i == axis else "0" for i in range(6))
    law = f'biasprm="0 {text(-robot.stiffness[axis])} {text(-robot.damping[axis])}"'
    return (
        f'    <general name="{name}" site="foot_{wheel}" refsite="mark_{wheel}" gear="{gear}" gainprm="1" '
        f'biastype="affine" {law}/>\n'
    )


def _pull(axis: int) -> str:
    gear = " ".join("1" if i == axis else "0" for i in range(6))
    return f'    <general name="pull_{AXES[axis]}" site="hook" refsite="origin" gear="{gear}" gainprm="1"/>\n'


def _frame(frame: Frame | None) -> str:
    if frame is None:
        return ""
    omega = 2.0 * math.pi * frame.frequency_hz
    inertial = f'mass="{text(frame.mass)}" diaginertia="{POINT_INERTIA} {POINT_INERTIA} {POINT_INERTIA}"'
    if frame.shape == "carriage":
        stiffness, damping, foot, top = frame.mass * omega**2, 2.0 * frame.damping_ratio * frame.mass * omega, 0.0, 0.0
        kind = "slide"
    else:  # upright, gravity works against the spring
        moment = frame.mass * ROD**2
        stiffness = moment * omega**2 + frame.mass * GRAVITY * ROD
        damping, foot, top, kind = 2.0 * frame.damping_ratio * moment * omega, -ROD, ROD, "hinge"
    joints = "".join(
        f'        <joint name="sway_{axis}" type="{kind}" axis="{direction}" stiffness="{text(stiffness)}" '
        f'damping="{text(damping)}"/>\n'
        for axis, direction in (("x", "1 0 0"), ("y", "0 1 0"))
    )
    return f"""      <body name="frame" pos="0 0 {text(frame.height + foot)}">
{joints}        <inertial pos="0 0 {text(top)}" {inertial}/>
      </body>
"""
