"""The robot as an MJCF model: a free body, four wheels on springs and dampers, a floor, a mast and a cable.

Nothing of the simulator's laws is used here but the robot's numbers; what the engine does with them is its own.
Wheels have a small mass and hang on three slide joints each, which are the tire's springs and dampers. They touch a
plane by the engine's stiffest contact. The chassis holds what remains of mass, first moment and inertia, so that
the whole has exactly the robot's. docs/theory/mujoco.md says which model answers which question.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.statics import rest_pose, tilt

WHEELS = ("rear_left", "front_left", "front_right", "rear_right")
AXES = ("x", "y", "z")
# A friction beyond what any motion here asks for: the wheels are as good as nailed to the floor.
GRIPPING = 100.0
ANCHOR = 100.0  # m; so far away that a pull keeps its direction to 1e-5 whatever the robot does


@dataclass(frozen=True)
class Mast:
    """A point mass on horizontal springs, as the effect flexible_mast has it.

    Parameters
    ----------
    frequency_hz : float [Hz]
        With the platform held.
    mass : float [kg]
    height : float [m]
        Above the CoM.
    damping_ratio : float [1]
    """

    frequency_hz: float
    mass: float
    height: float
    damping_ratio: float


@dataclass(frozen=True)
class Cable:
    """A cable to a winch far away, horizontal; it pulls and never pushes.

    Parameters
    ----------
    direction : str
        ``lateral`` pulls along +y, ``longitudinal`` along -x.
    height : float [m]
        Above the unloaded contact points.
    speed : float [m/s]
        Of the winch.
    stiffness, damping : float [N/m], [N s/m]
    """

    direction: str
    height: float
    speed: float
    stiffness: float
    damping: float


@dataclass(frozen=True)
class Build:
    """Choices that are the model's, not the robot's.

    Parameters
    ----------
    tires : str
        ``patch``: a plate that lies flat on the floor, hung in a ball joint at the contact point; springs along the
        floor's axes, as the simulator's law has them. ``strut``: a sphere on springs along the body's axes.
        ``rigid``: a sphere without springs, the plainest robot on four wheels, for measuring speed.
    driven : bool
        Spheres turn on hinges, driven at the motors' speed (6.1); otherwise they stand still.
    friction : str
        ``grip``: nailed to the floor; ``cone``: Coulomb's law with mu_static in every direction.
    wheel_mass : float [kg]
        Of each wheel; taken from the chassis.
    step : float [s]
    plain : bool
        The engine's own defaults for contact, cone and solver instead of the stiffest: quicker and softer.
    """

    tires: str = "patch"
    driven: bool = False
    friction: str = "cone"
    wheel_mass: float = 0.035
    step: float = 1e-4
    plain: bool = False

    @property
    def pinned(self) -> bool:
        """Standing wheels that hold for good are tied to the floor: no contact, so nothing that creeps or rattles."""
        return self.friction == "grip" and not self.driven

    def __post_init__(self) -> None:
        if self.tires not in ("patch", "strut", "rigid"):
            raise InputError("mujoco: tires", f"is {self.tires!r}", "Give patch, strut or rigid")
        if self.friction not in ("grip", "cone"):
            raise InputError("mujoco: friction", f"is {self.friction!r}", "Give grip or cone")
        if self.tires == "patch" and self.driven:
            raise InputError("mujoco: tires", "a plate does not turn", "Give strut")


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
    anchor = "" if cable is None else _anchor(robot, cable)
    return f"""<mujoco model="skid-steering robot">
  <compiler angle="radian" inertiafromgeom="false"/>
  <option timestep="{_text(build.step)}" gravity="0 0 {-GRAVITY}" {"" if build.plain else SOLVER}/>
  <worldbody>
    <geom name="floor" type="plane" size="50 50 1" contype="0" conaffinity="0"/>
{anchor}{_places(robot)}    <body name="chassis">
      <freejoint name="chassis"/>
      <inertial pos="{_row(centre)}" mass="{_text(mass)}" fullinertia="{_row(_six(inertia))}"/>
      <site name="centre"/>
      <site name="sensor" pos="{_row(robot.accelerometer.position)}"/>
{_hook(robot, cable)}{_mast(mast)}{"".join(_wheel(robot, build, i) for i in range(4))}    </body>
  </worldbody>
{_ties(robot, build) if build.pinned else _pairs(robot, build)}{_tendon(cable)}  <actuator>
{_motors(robot, build)}{_winch(robot, cable)}  </actuator>
  <sensor>
    <framepos name="position" objtype="site" objname="centre"/>
    <framequat name="attitude" objtype="site" objname="centre"/>
    <accelerometer name="acceleration" site="sensor"/>
    <gyro name="rate" site="sensor"/>
{_sensors(build, cable)}  </sensor>
</mujoco>
"""


def chassis(robot: Robot, build: Build, mast: Mast | None = None) -> tuple[float, np.ndarray, np.ndarray]:
    """What remains of the robot without its wheels and its mast.

    Returns
    -------
    (float [kg], (3,) float [m], (3, 3) float [kg m^2])
        Mass, centre of mass from the robot's, inertia about that centre.
    """
    own = wheel_inertia(robot, build) * np.eye(3)
    parts = [(build.wheel_mass, hub, own) for hub in hubs(robot, build)]
    if mast is not None:
        parts.append((mast.mass, np.array([0.0, 0.0, mast.height]), POINT_INERTIA * np.eye(3)))
    mass = robot.mass - sum(part for part, _, _ in parts)
    first = -sum((part * place for part, place, _ in parts), np.zeros(3))
    about_origin = robot.inertia - sum((own + part * _steiner(place) for part, place, own in parts), np.zeros((3, 3)))
    if mass > 0.0:
        centre = first / mass
        inertia = about_origin - mass * _steiner(centre)
        moments = np.linalg.eigvalsh(inertia)
        if moments[0] > 0.0 and moments[0] + moments[1] > moments[2]:
            return mass, centre, inertia
    raise InputError(
        "mujoco", "wheels and mast hold more than the robot's mass and inertia", "Give lighter wheels or a lighter mast"
    )


def hubs(robot: Robot, build: Build) -> np.ndarray:
    """Centres of the wheels, or plates, with unloaded tires, from the CoM, (4, 3) float [m]."""
    return robot.contact_points + np.array([0.0, 0.0, _rise(robot, build)])


def _rise(robot: Robot, build: Build) -> float:
    return PLATE_HALF_HEIGHT if build.tires == "patch" else robot.radius


def wheel_inertia(robot: Robot, build: Build) -> float:
    """Of one wheel, a solid sphere, or of one plate, about any axis [kg m^2]."""
    reach = PLATE_HALF_WIDTH if build.tires == "patch" else robot.radius
    return 0.4 * build.wheel_mass * reach**2


def start(robot: Robot, build: Build, offset: dict[str, float], mast: bool = False) -> np.ndarray:
    """Generalised positions of a robot that was set down unstressed at rest and then moved by ``offset``.

    The wheels stay where they stood on the floor.

    Parameters
    ----------
    robot : Robot
    build : Build
    offset : mapping
        ``x``, ``y``, ``z`` [m], ``roll``, ``pitch``, ``yaw`` [rad] away from rest.
    mast : bool
        Whether the model has one; it starts unbent.

    Returns
    -------
    (nq,) float
        In the order of the model's joints: chassis, mast, wheels.
    """
    height, roll, pitch = (robot.height, 0.0, 0.0) if build.tires == "rigid" else rest_pose(robot)
    centres = robot.contact_points if build.tires == "patch" else hubs(robot, build)
    stood = centres @ tilt(roll, pitch).T
    stood[:, 2] = 0.0 if build.tires == "patch" else robot.radius
    place = np.array([0.0, 0.0, height]) + [offset.get(axis, 0.0) for axis in AXES]
    roll, pitch, yaw = roll + offset.get("roll", 0.0), pitch + offset.get("pitch", 0.0), offset.get("yaw", 0.0)
    cos, sin = math.cos(yaw), math.sin(yaw)
    rotation = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ tilt(roll, pitch)
    turned = _quaternion(roll, pitch, yaw)
    own = [*place, *turned]
    for centre, foot in zip(centres, stood, strict=True):
        if build.tires == "patch":  # the ball joint undoes the body's turn: the plate lies as it was set down
            own += [turned[0], *(-part for part in turned[1:]), *(foot - place - rotation @ centre)]
        elif build.tires == "strut":
            own += [*((foot - place) @ rotation - centre)]
        own += [0.0] if build.driven else []
    if mast:
        own[7:7] = [0.0, 0.0]
    return np.array(own)


PLATE_HALF_WIDTH, PLATE_HALF_HEIGHT = 0.02, 0.002  # m
POINT_INERTIA = 1e-9  # kg m^2; the engine asks for some inertia where a body only slides


def _steiner(place: np.ndarray) -> np.ndarray:
    return float(place @ place) * np.eye(3) - np.outer(place, place)


def _quaternion(roll: float, pitch: float, yaw: float) -> list[float]:
    """Of Rz(yaw)·Ry(pitch)·Rx(roll), (w, x, y, z)."""
    cr, sr, cp, sp = math.cos(roll / 2), math.sin(roll / 2), math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return [
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ]


def _text(value: float) -> str:
    return repr(float(value))


def _row(values: np.ndarray) -> str:
    return " ".join(_text(value) for value in values)


def _six(tensor: np.ndarray) -> np.ndarray:
    return np.array([tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]])


def _wheel(robot: Robot, build: Build, i: int) -> str:
    name, patch = WHEELS[i], build.tires == "patch"
    joints = f'        <joint name="{name}_ball" type="ball"/>\n' if patch else ""
    for axis in () if build.tires == "rigid" else range(3):
        joints += f"""        <joint name="{name}_{AXES[axis]}" type="slide" axis="{_row(np.eye(3)[axis])}" \
stiffness="{_text(robot.stiffness[axis])}" damping="{_text(robot.damping[axis])}"/>
"""
    if build.driven:
        joints += f'        <joint name="{name}_axle" type="hinge" axis="0 1 0" armature="{ROTOR}"/>\n'
    shape = f'type="sphere" size="{_text(robot.radius)}"'
    if patch:
        shape = f'type="box" size="{PLATE_HALF_WIDTH} {PLATE_HALF_WIDTH} {PLATE_HALF_HEIGHT}"'
    # the ball joint of a plate sits at the contact point, the middle of its lower face
    body, middle = (robot.contact_points[i], PLATE_HALF_HEIGHT) if patch else (hubs(robot, build)[i], 0.0)
    spin, reach = _text(wheel_inertia(robot, build)), _text(0.1 if patch else 2.0 * robot.radius)
    return f"""      <body name="{name}" pos="{_row(body)}">
{joints}        <inertial pos="0 0 {middle}" mass="{_text(build.wheel_mass)}" diaginertia="{spin} {spin} {spin}"/>
        <geom name="{name}" pos="0 0 {middle}" {shape} contype="0" conaffinity="0"/>
        <site name="{name}" type="sphere" size="{reach}"/>
        <site name="foot_{name}" pos="0 0 {_text(middle - _rise(robot, build))}"/>
      </body>
"""


def _mast(mast: Mast | None) -> str:
    if mast is None:
        return ""
    omega = 2.0 * math.pi * mast.frequency_hz
    spring = (
        f'stiffness="{_text(mast.mass * omega**2)}" damping="{_text(2.0 * mast.damping_ratio * mast.mass * omega)}"'
    )
    return f"""      <body name="mast" pos="0 0 {_text(mast.height)}">
        <joint name="mast_x" type="slide" axis="1 0 0" {spring}/>
        <joint name="mast_y" type="slide" axis="0 1 0" {spring}/>
        <inertial pos="0 0 0" mass="{_text(mast.mass)}" diaginertia="{POINT_INERTIA} {POINT_INERTIA} {POINT_INERTIA}"/>
      </body>
"""


def _pairs(robot: Robot, build: Build) -> str:
    """Contacts of wheels and floor, as stiff as the engine has them."""
    stiff = "" if build.plain else _stiff(build)
    friction = _text(GRIPPING if build.friction == "grip" else robot.mu_static)
    lines = ""
    for name in WHEELS:
        lines += f"""    <pair geom1="floor" geom2="{name}" condim="3" friction="{friction} {friction} 0 0 0" {stiff}/>
"""
    return f"  <contact>\n{lines}  </contact>\n"


def _ties(robot: Robot, build: Build) -> str:
    """Every wheel where it was set down: plates welded, so that they stay level, spheres by their lowest point."""
    lines = ""
    for name, stood in zip(WHEELS, _stood(robot), strict=True):
        if build.tires == "patch":
            place = _row(np.array([*stood, 1.0, 0.0, 0.0, 0.0]))
            lines += f'    <weld body1="world" body2="{name}" relpose="{place}" {_stiff(build)}/>\n'
        else:
            lines += f'    <connect site1="stood_{name}" site2="foot_{name}" {_stiff(build)}/>\n'
    return f"  <equality>\n{lines}  </equality>\n"


def _stood(robot: Robot) -> np.ndarray:
    """Where the wheels touch the floor at rest, in the world, (4, 3) float [m]."""
    _, roll, pitch = rest_pose(robot)
    return (robot.contact_points @ tilt(roll, pitch).T) * np.array([1.0, 1.0, 0.0])


def _stiff(build: Build) -> str:
    return f'solref="{_text(CONTACT_STEPS * build.step)} 1" solimp="0.9999 0.9999 0.001 0.5 2"'


SOLVER = 'integrator="implicitfast" cone="elliptic" impratio="10" tolerance="1e-12"'
# Time constant of a contact in steps (the engine takes 2 at least, and rattles there); an impedance of 0.9999 is its
# upper limit.
CONTACT_STEPS = 4.0


def _motors(robot: Robot, build: Build) -> str:
    """Motors that obey (6.1) whatever the load: a rotor so heavy that the floor cannot slow it."""
    lines = ""
    for name in WHEELS if build.driven else ():
        lines += f"""    <velocity name="{name}" joint="{name}_axle" kv="{_text(robot.motor_gain * ROTOR)}"/>
"""
    return lines


ROTOR = 1e4  # kg m^2; 100 N at the rim shift a wheel's rate by 2e-4 rad/s


def _hook_place(robot: Robot, cable: Cable) -> np.ndarray:
    lateral = cable.direction == "lateral"
    x = 0.0 if lateral else float(robot.contact_points[:, 0].min())
    return np.array([x, robot.half_track if lateral else 0.0, cable.height - robot.height])


def _hook(robot: Robot, cable: Cable | None) -> str:
    return "" if cable is None else f'      <site name="hook" pos="{_row(_hook_place(robot, cable))}"/>\n'


def _hook_at_rest(robot: Robot, cable: Cable) -> np.ndarray:
    height, roll, pitch = rest_pose(robot)
    return tilt(roll, pitch) @ _hook_place(robot, cable) + np.array([0.0, 0.0, height])


def _anchor(robot: Robot, cable: Cable) -> str:
    direction = np.array([0.0, 1.0, 0.0] if cable.direction == "lateral" else [-1.0, 0.0, 0.0])
    return f'    <site name="winch" pos="{_row(_hook_at_rest(robot, cable) + ANCHOR * direction)}"/>\n'


def _places(robot: Robot) -> str:
    places = zip(WHEELS, _stood(robot), strict=True)
    return "".join(f'    <site name="stood_{name}" pos="{_row(place)}"/>\n' for name, place in places)


def _tendon(cable: Cable | None) -> str:
    if cable is None:
        return ""
    return """  <tendon>
    <spatial name="cable"><site site="hook"/><site site="winch"/></spatial>
  </tendon>
"""


def _winch(robot: Robot, cable: Cable | None) -> str:
    """The cable's force -K(l - l0 + travel) - D(l' + speed), never above 0; the travel is the actuator's state."""
    if cable is None:
        return ""
    k, d = cable.stiffness, cable.damping
    return f"""    <general name="cable" tendon="cable" dyntype="integrator" gainprm="{_text(-k)}" biastype="affine" \
biasprm="{_text(k * ANCHOR - d * cable.speed)} {_text(-k)} {_text(-d)}" forcelimited="true" forcerange="-1e9 0"/>
"""


def _sensors(build: Build, cable: Cable | None) -> str:
    lines = "".join(f'    <touch name="touch_{name}" site="{name}"/>\n' for name in WHEELS)
    for name in WHEELS if build.tires != "rigid" else ():
        for axis in AXES:
            lines += f'    <jointpos name="tire_{name}_{axis}" joint="{name}_{axis}"/>\n'
            lines += f'    <jointvel name="tire_rate_{name}_{axis}" joint="{name}_{axis}"/>\n'
    if cable is not None:
        lines += '    <actuatorfrc name="cable" actuator="cable"/>\n'
    return lines
