"""Masses and places of the parts, so that the whole has exactly the robot's, and where they start."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.statics import rest_pose, tilt
from ssmr_ident.simulate.mjcf.build import AXES, Build, Mast

PLATE_HALF_WIDTH, PLATE_HALF_HEIGHT = 0.02, 0.002  # m
POINT_INERTIA = 1e-9  # kg m^2; the engine asks for some inertia where a body only slides


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
    about_origin = robot.inertia - sum((own + part * steiner(place) for part, place, own in parts), np.zeros((3, 3)))
    if mass > 0.0:
        centre = first / mass
        inertia = about_origin - mass * steiner(centre)
        moments = np.linalg.eigvalsh(inertia)
        if moments[0] > 0.0 and moments[0] + moments[1] > moments[2]:
            return mass, centre, inertia
    raise InputError(
        "mujoco", "wheels and mast hold more than the robot's mass and inertia", "Give lighter wheels or a lighter mast"
    )


def hubs(robot: Robot, build: Build) -> np.ndarray:
    """Centres of the wheels, or plates, with unloaded tires, from the CoM, (4, 3) float [m]."""
    result: np.ndarray = robot.contact_points + np.array([0.0, 0.0, rise(robot, build)])
    return result


def rise(robot: Robot, build: Build) -> float:
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


def steiner(place: np.ndarray) -> np.ndarray:
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
