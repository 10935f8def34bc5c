"""A robot with its effects as the compiled loop takes them, and how it is let go."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.recent import Recent
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics import slots
from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE, ground_roughness, unlisted
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.slots import (
    CUBIC,
    CUBIC_SHARE,
    ECCENTRICITY,
    JOINT_DEPTH,
    ROUGHNESS,
    Effects,
    checked_for_robot,
    effect_vector,
    is_plain,
)
from ssmr_ident.physics.statics import rest_pose
from ssmr_ident.simulate import layout as k
from ssmr_ident.simulate.mast import inverse_mass_matrix

LOADED, POINTS, UNSEEN = k.LOADED, k.POINTS, k.UNSEEN
FLAT = np.zeros(1)
_AS_IT_IS = [1.0, 1.0, 1.0]
_UNEVEN = np.array([JOINT_DEPTH, ECCENTRICITY, ROUGHNESS])
_POSE = ("x", "y", "z", "roll", "pitch", "yaw")
AWAY = (*_POSE, "brace_x", "brace_y", "sway_x", "sway_y", "loaded", "unseen")
MOVING = (*_POSE, "sway_x", "sway_y")
"""Order of a scenario's ``offset`` and ``velocity`` as numbers in a row."""


_SWITCHES = np.array(
    [
        slots.CUBIC, slots.KNEE_SHARE, slots.CUBIC_SHARE, slots.QUADRATIC, slots.FRICTION_FORCE, slots.SLIDER,
        slots.FRICTION_ROUNDING, slots.ALPHA, slots.RELAXATION_STIFFNESS, slots.GAP, slots.GAP_SHARE_X,
        slots.KINETIC_SHARE, slots.LOAD_EXPONENT, slots.ROLLING, slots.LIFT, slots.CORIOLIS, slots.MAST_HZ,
        slots.BELT_STIFFNESS, JOINT_DEPTH, ECCENTRICITY, ROUGHNESS,
        *range(slots.UNLISTED, slots.UNLISTED + len(unlisted.TERMS)),
    ]
)  # fmt: skip
"""What the loop asks of all lanes in common: whether these are off."""

_OFF = effect_vector({})[_SWITCHES]
_OFF[_SWITCHES == slots.GAP_SHARE_X] = 0.0


@dataclass(frozen=True, eq=False)
class Body:
    """What does not depend on where a robot starts.

    Parameters
    ----------
    robot : Robot
        As effects have changed it.
    active : mapping of effect id to complete parameters
    e : (SLOTS,) float
    floor : (n²,) float
        In units of its roughness.
    mast : (8, 8) float
    beyond : bool
        False where the baseline, on a floor that may be rough, is all there is.
    read_otherwise : bool
        Sensor effects change the channels.
    """

    robot: Robot
    active: Effects
    e: np.ndarray
    floor: np.ndarray
    mast: np.ndarray
    beyond: bool
    read_otherwise: bool

    @cached_property
    def uneven(self) -> np.ndarray | None:
        """The floor where anything makes it uneven; None where it is flat."""
        return self.floor if any(self.e[_UNEVEN].tolist()) else None

    @cached_property
    def alike(self) -> tuple[object, ...]:
        """What bodies have in common that go in lanes: which effects are off, and what the loop asks of all wheels."""
        p = self.packed
        switches, ahead = self.e[_SWITCHES] != _OFF, p[POINTS : POINTS + 12 : 3] > 0.0
        return (
            self.beyond, switches.tobytes(), ahead.tobytes(), p[k.SLIDING_SPEED] > 0.0, p[k.SLIP_COUPLING] != 0.0,
            p[k.AS_PRINTED] > 0.0, self.uneven is None,
        )  # fmt: skip

    @cached_property
    def scaled(self) -> np.ndarray | None:
        """By what all outputs are read too large, (outputs,) float; None where they are read as they are."""
        gain = self.robot.accelerometer.gain
        return None if gain.tolist() == _AS_IT_IS else np.append(gain, np.ones(len(k.OUTPUTS) - 3))

    @cached_property
    def rest(self) -> np.ndarray:
        """Height, roll and pitch at rest, (3,) float."""
        return rest_pose(self.robot, float(self.e[CUBIC] + self.e[CUBIC_SHARE] * self.robot.stiffness[2]))

    @cached_property
    def packed(self) -> np.ndarray:
        """The loop's parameter vector where all wheels grip."""
        return pack_robot(self.robot)

    def start(self, scenario: Scenario) -> np.ndarray:
        """Rest, displaced and pushed as the scenario says; the tires were set down unstressed at rest."""
        offset, velocity = scenario.offset, scenario.velocity
        away = np.array([offset.get(name, 0.0) for name in AWAY])
        moving = np.array([velocity.get(name, 0.0) for name in MOVING])
        out = np.zeros(k.START)
        let_go(self.packed, self.rest, away, moving, out)
        return out


def body_of(robot: Robot, effects: Effects) -> Body:
    """A robot with effects.

    Raises
    ------
    InputError
        An unknown effect or parameter, or a mast heavier than the robot.
    """
    # by the effect itself: one of a file may be another under the same id, once its author has changed it
    key = robot, *((CATALOGUE.get(effect_id), effect_id, *values.items()) for effect_id, values in effects.items())
    return _BODIES.of(key, lambda: _body(robot, checked_for_robot(effects)))


_BODIES: Recent[Body] = Recent()
"""One robot is let go from many starts."""


def _body(robot: Robot, active: Effects) -> Body:
    e = effect_vector(active)
    for effect_id, values in active.items():
        acts = CATALOGUE[effect_id].acts
        change = acts.get(Site.ROBOT) or acts.get(Site.SENSOR)
        if change and not CATALOGUE[effect_id].is_off(values):
            robot = change(robot, **values)
    mast = inverse_mass_matrix(robot, active)
    read_otherwise = any(Site.OUTPUT in CATALOGUE[effect_id].acts for effect_id in active)
    return Body(robot, active, e, _floor(active), mast, not is_plain(e), read_otherwise)


def _floor(active: Effects) -> np.ndarray:
    values = active.get("ground_roughness")
    if not values or values["height_m"] == 0.0:
        return FLAT
    return ground_roughness.field(values["length_m"], int(values["seed"]))


def pack_robot(robot: Robot) -> np.ndarray:
    """The loop's parameter vector for a robot on four wheels that grip."""
    p = np.zeros(k.PARAMETERS)
    p[k.MASS], p[k.PATCH_MASS], p[k.RADIUS] = robot.mass, robot.effective_mass, robot.radius
    p[k.KX : k.KZ + 1], p[k.DX : k.DZ + 1] = robot.stiffness, robot.damping
    p[k.MU_STATIC], p[k.MU_KINETIC], p[k.LAMBDA_MAX] = robot.mu_static, robot.mu_kinetic, robot.lambda_max
    p[k.SLIP_COUPLING], p[k.MOTOR_GAIN], p[k.GRAVITY_G] = robot.slip_coupling, robot.motor_gain, GRAVITY
    p[k.SENSOR : k.SENSOR + 3] = robot.accelerometer.position
    p[k.POINTS : k.POINTS + 12] = robot.contact_points.ravel()
    p[k.INVERSE_INERTIA : k.INVERSE_INERTIA + 9] = np.linalg.inv(robot.inertia).ravel()
    p[k.INERTIA : k.INERTIA + 9] = robot.inertia.ravel()
    p[k.GRIPPING : k.GRIPPING + 4] = 1.0
    p[k.SLIDING_SPEED], p[k.AS_PRINTED] = robot.sliding_speed, float(robot.contact == "printed_6_4")
    return p


@kernel
def let_all_go(p, rest, away, moving, out):
    """``let_go`` for every row of its arguments."""
    for j in range(len(p)):
        let_go(p[j], rest[j], away[j], moving[j], out[j])


@kernel
def let_go(p, rest, away, moving, out):
    """Fill the loop's starting state.

    Parameters
    ----------
    p : (PARAMETERS,) float
    rest : (3,) float
        Height, roll and pitch at rest.
    away, moving : (12,) and (8,) float
        In the order of ``AWAY`` and ``MOVING``.
    out : (START,) float
        Zeros.
    """
    for j in range(6):
        out[j], out[6 + j] = away[j], moving[j]
    out[2] += rest[0]
    out[3] += rest[1]
    out[4] += rest[2]
    cosine, sine = math.cos(out[5]), math.sin(out[5])
    for i in range(4):
        a, b, c = p[POINTS + 3 * i], p[POINTS + 3 * i + 1], p[POINTS + 3 * i + 2]
        set_x, set_y, set_z = _tilted(rest[1], rest[2], a, b, c)
        now_x, now_y, now_z = _tilted(out[3], out[4], a, b, c)
        moved_x = cosine * now_x - sine * now_y + out[0] - set_x
        moved_y = sine * now_x + cosine * now_y + out[1] - set_y
        out[14 + 2 * i] = cosine * moved_x + sine * moved_y + np.sign(a) * away[6]
        out[15 + 2 * i] = cosine * moved_y - sine * moved_x + np.sign(b) * away[7]
        out[LOADED + 1 + i] = rest[0] + set_z - (out[2] + now_z)
    out[22], out[23], out[24], out[25] = away[8], away[9], moving[6], moving[7]
    out[LOADED], out[UNSEEN] = away[10], away[11]


@kernel
def _tilted(roll, pitch, a, b, c):
    """A body vector along the heading axes."""
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    raised = sr * b + cr * c
    return cp * a + sp * raised, cr * b - sr * c, cp * raised - sp * a
