"""Parts of the model as XML: wheels, motors, mast, cable, sensors."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.statics import rest_pose, tilt
from ssmr_ident.simulate.mjcf.bodies import (
    PLATE_HALF_HEIGHT,
    PLATE_HALF_WIDTH,
    POINT_INERTIA,
    hubs,
    rise,
    wheel_inertia,
)
from ssmr_ident.simulate.mjcf.build import AXES, WHEELS, Build, Cable, Mast
from ssmr_ident.simulate.mjcf.text import row, text

ROTOR = 1e4  # kg m^2; 100 N at the rim shift a wheel's rate by 2e-4 rad/s
ANCHOR = 100.0  # m; so far away that a pull keeps its direction to 1e-5 whatever the robot does


def wheel_text(robot: Robot, build: Build, i: int) -> str:
    name, patch = WHEELS[i], build.tires == "patch"
    joints = f'        <joint name="{name}_ball" type="ball"/>\n' if patch else ""
    for axis in () if build.tires == "rigid" else range(3):
        joints += f"""        <joint name="{name}_{AXES[axis]}" type="slide" axis="{row(np.eye(3)[axis])}" \
stiffness="{text(robot.stiffness[axis])}" damping="{text(robot.damping[axis])}"/>
"""
    if build.driven:
        joints += f'        <joint name="{name}_axle" type="hinge" axis="0 1 0" armature="{ROTOR}"/>\n'
    shape = f'type="sphere" size="{text(robot.radius)}"'
    if patch:
        shape = f'type="box" size="{PLATE_HALF_WIDTH} {PLATE_HALF_WIDTH} {PLATE_HALF_HEIGHT}"'
    # the ball joint of a plate sits at the contact point, the middle of its lower face
    body, middle = (robot.contact_points[i], PLATE_HALF_HEIGHT) if patch else (hubs(robot, build)[i], 0.0)
    spin, reach = text(wheel_inertia(robot, build)), text(0.1 if patch else 2.0 * robot.radius)
    return f"""      <body name="{name}" pos="{row(body)}">
{joints}        <inertial pos="0 0 {middle}" mass="{text(build.wheel_mass)}" diaginertia="{spin} {spin} {spin}"/>
        <geom name="{name}" pos="0 0 {middle}" {shape} contype="0" conaffinity="0"/>
        <site name="{name}" type="sphere" size="{reach}"/>
        <site name="foot_{name}" pos="0 0 {text(middle - rise(robot, build))}"/>
      </body>
"""


def mast_text(mast: Mast | None) -> str:
    if mast is None:
        return ""
    omega = 2.0 * math.pi * mast.frequency_hz
    spring = f'stiffness="{text(mast.mass * omega**2)}" damping="{text(2.0 * mast.damping_ratio * mast.mass * omega)}"'
    return f"""      <body name="mast" pos="0 0 {text(mast.height)}">
        <joint name="mast_x" type="slide" axis="1 0 0" {spring}/>
        <joint name="mast_y" type="slide" axis="0 1 0" {spring}/>
        <inertial pos="0 0 0" mass="{text(mast.mass)}" diaginertia="{POINT_INERTIA} {POINT_INERTIA} {POINT_INERTIA}"/>
      </body>
"""


def motors(robot: Robot, build: Build) -> str:
    """Motors that obey (6.1) whatever the load: a rotor so heavy that the floor cannot slow it."""
    lines = ""
    for name in WHEELS if build.driven else ():
        lines += f"""    <velocity name="{name}" joint="{name}_axle" kv="{text(robot.motor_gain * ROTOR)}"/>
"""
    return lines


def hook(robot: Robot, cable: Cable | None) -> str:
    return "" if cable is None else f'      <site name="hook" pos="{row(_hook_place(robot, cable))}"/>\n'


def anchor(robot: Robot, cable: Cable) -> str:
    direction = np.array([0.0, 1.0, 0.0] if cable.direction == "lateral" else [-1.0, 0.0, 0.0])
    return f'    <site name="winch" pos="{row(_hook_at_rest(robot, cable) + ANCHOR * direction)}"/>\n'


def tendon(cable: Cable | None) -> str:
    if cable is None:
        return ""
    return """  <tendon>
    <spatial name="cable"><site site="hook"/><site site="winch"/></spatial>
  </tendon>
"""


def winch(robot: Robot, cable: Cable | None) -> str:
    """The cable's force -K(l - l0 + travel) - D(l' + speed), never above 0; the travel is the actuator's state."""
    if cable is None:
        return ""
    k, d = cable.stiffness, cable.damping
    return f"""    <general name="cable" tendon="cable" dyntype="integrator" gainprm="{text(-k)}" biastype="affine" \
biasprm="{text(k * ANCHOR - d * cable.speed)} {text(-k)} {text(-d)}" forcelimited="true" forcerange="-1e9 0"/>
"""


def sensors(build: Build, cable: Cable | None) -> str:
    lines = "".join(f'    <touch name="touch_{name}" site="{name}"/>\n' for name in WHEELS)
    for name in WHEELS if build.tires != "rigid" else ():
        for axis in AXES:
            lines += f'    <jointpos name="tire_{name}_{axis}" joint="{name}_{axis}"/>\n'
            lines += f'    <jointvel name="tire_rate_{name}_{axis}" joint="{name}_{axis}"/>\n'
    if cable is not None:
        lines += '    <actuatorfrc name="cable" actuator="cable"/>\n'
    return lines


def _hook_place(robot: Robot, cable: Cable) -> np.ndarray:
    lateral = cable.direction == "lateral"
    x = 0.0 if lateral else float(robot.contact_points[:, 0].min())
    return np.array([x, robot.half_track if lateral else 0.0, cable.height - robot.height])


def _hook_at_rest(robot: Robot, cable: Cable) -> np.ndarray:
    height, roll, pitch = rest_pose(robot)
    result: np.ndarray = tilt(roll, pitch) @ _hook_place(robot, cable) + np.array([0.0, 0.0, height])
    return result
