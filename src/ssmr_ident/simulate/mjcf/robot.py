"""The robot as an MJCF model: a free body, four wheels on springs and dampers, a floor, a mast and a cable.

Nothing of the simulator's laws is used here but the robot's numbers; what the engine does with them is its own.
Wheels have a small mass and hang on three slide joints each, which are the tire's springs and dampers. They touch a
plane by the engine's stiffest contact. The chassis holds what remains of mass, first moment and inertia, so that
the whole has exactly the robot's. docs/theory/mujoco.md says which model answers which question.
"""

from __future__ import annotations

from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.simulate.mjcf.bodies import chassis
from ssmr_ident.simulate.mjcf.build import Build, Cable, Mast
from ssmr_ident.simulate.mjcf.contact import SOLVER, pairs, places, ties
from ssmr_ident.simulate.mjcf.parts import anchor, hook, mast_text, motors, sensors, tendon, wheel_text, winch
from ssmr_ident.simulate.mjcf.text import row, six, text


def mjcf(robot: Robot, build: Build, mast: Mast | None = None, cable: Cable | None = None) -> str:
    """The model as XML.

    Parameters
    ----------
    robot : Robot
    build : Build
    mast : Mast, optional
    cable : Cable, optional

    Raises
    ------
    InputError
        Wheels and mast hold more than the robot's mass and inertia.
    """
    mass, centre, inertia = chassis(robot, build, mast)
    return f"""<mujoco model="skid-steering robot">
  <compiler angle="radian" inertiafromgeom="false"/>
  <option timestep="{text(build.step)}" gravity="0 0 {-GRAVITY}" {"" if build.plain else SOLVER}/>
  <worldbody>
    <geom name="floor" type="plane" size="50 50 1" contype="0" conaffinity="0"/>
{"" if cable is None else anchor(robot, cable)}{places(robot)}    <body name="chassis">
      <freejoint name="chassis"/>
      <inertial pos="{row(centre)}" mass="{text(mass)}" fullinertia="{row(six(inertia))}"/>
      <site name="centre"/>
      <site name="sensor" pos="{row(robot.accelerometer.position)}"/>
{hook(robot, cable)}{mast_text(mast)}{"".join(wheel_text(robot, build, i) for i in range(4))}    </body>
  </worldbody>
{ties(robot, build) if build.pinned else pairs(robot, build)}{tendon(cable)}  <actuator>
{motors(robot, build)}{winch(robot, cable)}  </actuator>
  <sensor>
    <framepos name="position" objtype="site" objname="centre"/>
    <framequat name="attitude" objtype="site" objname="centre"/>
    <accelerometer name="acceleration" site="sensor"/>
    <gyro name="rate" site="sensor"/>
{sensors(build, cable)}  </sensor>
</mujoco>
"""
