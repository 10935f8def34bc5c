"""Parameters as URDF links and joints, as robotics frameworks read them."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.physics.rig import RIG_KEYS, rig_from_parameters
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.simulate.mjcf import WHEELS
from ssmr_ident.workflows.export.remarks import xml_comment


def urdf_of(parameters: ParameterSet) -> str:
    """The model as XML; URDF knows no springs, which stand in the comment with all else that it cannot hold.

    Raises
    ------
    InputError
        A parameter is missing.
    """
    if "contact_points_m" not in parameters:
        return _rig(parameters)
    robot = robot_from_parameters(parameters)
    held = {path for path in parameters if path.startswith(("mass_kg", "inertia_kg_m2", "contact_points_m"))}
    held |= {"tire.radius_m"}
    wheels = "".join(_wheel(robot, name, place) for name, place in zip(WHEELS, robot.contact_points, strict=True))
    return f"""{xml_comment(parameters, held, "URDF")}<robot name="skid_steering_robot">
  <link name="chassis">
{_inertial(robot.mass, robot.inertia)}  </link>
{wheels}</robot>
"""


def _wheel(robot: Robot, name: str, contact: np.ndarray) -> str:
    hub = " ".join(repr(float(x)) for x in contact + np.array([0.0, 0.0, robot.radius]))
    return f"""  <link name="{name}">
    <collision><geometry><sphere radius="{robot.radius!r}"/></geometry></collision>
  </link>
  <joint name="{name}_axle" type="continuous">
    <parent link="chassis"/><child link="{name}"/>
    <origin xyz="{hub}"/><axis xyz="0 1 0"/>
  </joint>
"""


def _inertial(mass: float, inertia: np.ndarray) -> str:
    names = (("ixx", 0, 0), ("iyy", 1, 1), ("izz", 2, 2), ("ixy", 0, 1), ("ixz", 0, 2), ("iyz", 1, 2))
    moments = " ".join(f'{name}="{float(inertia[i, j])!r}"' for name, i, j in names)
    return f"""    <inertial>
      <mass value="{mass!r}"/>
      <inertia {moments}/>
    </inertial>
"""


def _rig(parameters: ParameterSet) -> str:
    rig = rig_from_parameters(parameters)
    friction = float(effect_values(parameters).get("dry_friction", {}).get("F_c_N", 0.0))
    kind = "continuous" if rig.rotary else "prismatic"
    limit = "" if rig.rotary else '\n    <limit lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"/>'
    mass, inertia = (1.0, rig.mass * np.eye(3)) if rig.rotary else (rig.mass, 1e-6 * np.eye(3))
    held = {RIG_KEYS[rig.rotary][0], RIG_KEYS[rig.rotary][1], "effects.dry_friction.F_c_N"}
    return f"""{xml_comment(parameters, held, "URDF")}<robot name="rig">
  <link name="ground"/>
  <link name="mass">
{_inertial(mass, inertia)}  </link>
  <joint name="way" type="{kind}">
    <parent link="ground"/><child link="mass"/>
    <axis xyz="1 0 0"/>{limit}
    <dynamics damping="{rig.damping!r}" friction="{friction!r}"/>
  </joint>
</robot>
"""
