"""Parameters as a MuJoCo model: a rig's mass on a joint, or the robot on the springs of its tires."""

from __future__ import annotations

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.physics.rig import RIG_KEYS, rig_from_parameters
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.simulate.mjcf import Build, Mast, mjcf
from ssmr_ident.workflows.export.remarks import xml_comment

ROBOT_HELD = (
    "mass_kg", "inertia_kg_m2", "contact_points_m", "tire.stiffness", "tire.damping", "tire.radius", "tire.mu_static",
    "motor.gain", "accelerometer.position",
)  # fmt: skip
HARD = 'solreffriction="2e-4 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'
"""The engine's friction yields by some per cent at its defaults; these are its limits at a step of 0.1 ms."""
MAST_KEYS = ("f_mast_Hz", "mass_kg", "height_above_com_m", "damping_ratio")


def mjcf_of(parameters: ParameterSet) -> str:
    """The model as XML, with what it cannot hold as a comment.

    A rig is one joint with spring, damper and Coulomb friction (``frictionloss``); a robot a free body on four wheels,
    each on three slide joints that are its tire, and on a mast where the set has one.

    Raises
    ------
    InputError
        A parameter is missing.
    """
    if any(key in parameters for key in ("mass_kg", "inertia_kg_m2")) and "contact_points_m" not in parameters:
        return _rig(parameters)
    return _robot(parameters)


def _rig(parameters: ParameterSet) -> str:
    rig = rig_from_parameters(parameters)
    friction = float(effect_values(parameters).get("dry_friction", {}).get("F_c_N", 0.0))
    loss = f' frictionloss="{friction!r}" {HARD}' if friction else ""
    kind = "hinge" if rig.rotary else "slide"
    mass, moment = (1.0, rig.mass) if rig.rotary else (rig.mass, 1e-6)
    held = {*RIG_KEYS[rig.rotary], "effects.dry_friction.F_c_N"}
    return f"""{xml_comment(parameters, held, "MJCF")}<mujoco model="rig">
  <option timestep="1e-4" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="mass">
      <joint name="way" type="{kind}" axis="1 0 0" stiffness="{rig.stiffness!r}" damping="{rig.damping!r}"{loss}/>
      <inertial pos="0 0 0" mass="{mass!r}" diaginertia="{moment!r} {moment!r} {moment!r}"/>
    </body>
  </worldbody>
  <actuator><motor name="force" joint="way"/></actuator>
  <sensor><jointpos name="position" joint="way"/><jointvel name="velocity" joint="way"/></sensor>
</mujoco>
"""


def _robot(parameters: ParameterSet) -> str:
    values = effect_values(parameters).get("flexible_mast")
    mast = Mast(*(values[key] for key in MAST_KEYS)) if values else None
    held = {path for path in parameters if path.startswith(ROBOT_HELD)}
    held |= {f"effects.flexible_mast.{key}" for key in MAST_KEYS}
    model = mjcf(robot_from_parameters(parameters), Build(), mast)
    return xml_comment(parameters, held, "MJCF") + model
