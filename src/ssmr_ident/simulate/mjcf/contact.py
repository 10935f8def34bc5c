"""Wheels on the floor: pressed on it by the engine's stiffest contact, or tied to it."""

from __future__ import annotations

import numpy as np

from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.statics import rest_pose, tilt
from ssmr_ident.simulate.mjcf.build import WHEELS, Build
from ssmr_ident.simulate.mjcf.text import row, text

SOLVER = 'integrator="implicitfast" cone="elliptic" impratio="10" tolerance="1e-12"'
# Time constant of a contact in steps (the engine takes 2 at least, and rattles there); an impedance of 0.9999 is its
# upper limit.
CONTACT_STEPS = 4.0
# A friction beyond what any motion here asks for: the wheels are as good as nailed to the floor.
GRIPPING = 100.0


def pairs(robot: Robot, build: Build) -> str:
    """Contacts of wheels and floor, as stiff as the engine has them."""
    law = "" if build.plain else stiff(build)
    friction = text(GRIPPING if build.friction == "grip" else robot.mu_static)
    lines = ""
    for name in WHEELS:
        lines += f"""    <pair geom1="floor" geom2="{name}" condim="3" friction="{friction} {friction} 0 0 0" {law}/>
"""
    return f"  <contact>\n{lines}  </contact>\n"


def ties(robot: Robot, build: Build) -> str:
    """Every wheel where it was set down: plates welded, so that they stay level, spheres by their lowest point."""
    lines = ""
    for name, foot in zip(WHEELS, stood(robot), strict=True):
        if build.tires == "patch":
            place = row(np.array([*foot, 1.0, 0.0, 0.0, 0.0]))
            lines += f'    <weld body1="world" body2="{name}" relpose="{place}" {stiff(build)}/>\n'
        else:
            lines += f'    <connect site1="stood_{name}" site2="foot_{name}" {stiff(build)}/>\n'
    return f"  <equality>\n{lines}  </equality>\n"


def stood(robot: Robot) -> np.ndarray:
    """Where the wheels touch the floor at rest, in the world, (4, 3) float [m]."""
    _, roll, pitch = rest_pose(robot)
    result: np.ndarray = (robot.contact_points @ tilt(roll, pitch).T) * np.array([1.0, 1.0, 0.0])
    return result


def places(robot: Robot) -> str:
    places = zip(WHEELS, stood(robot), strict=True)
    return "".join(f'    <site name="stood_{name}" pos="{row(place)}"/>\n' for name, place in places)


def stiff(build: Build) -> str:
    return f'solref="{text(CONTACT_STEPS * build.step)} 1" solimp="0.9999 0.9999 0.001 0.5 2"'
