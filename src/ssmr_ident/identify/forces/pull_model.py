"""What a pull's first rise should be: gripping tires, tilting body and cable in series."""

from __future__ import annotations

import numpy as np

from ssmr_ident.experiments.pull import FIXTURE, fixture_needed
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.robot import Robot


def pull_stiffness(
    robot: Robot,
    direction: str,
    height: float,
    gripping: tuple[int, ...] = (1, 2, 3, 4),
    cable_stiffness: float | None = None,
) -> float:
    """Force over machine travel while every gripping contact sticks [N/m].

    Parameters
    ----------
    direction : str
        ``lateral`` (hook on the left side) or ``longitudinal`` (hook at the rear).
    height : float [m]
        Of the cable above the floor.
    gripping : tuple of int
        The other wheels stand on oiled plates: they carry load and hold nothing sideways.
    cable_stiffness : float, optional [N/m]
        The robot's own cable when left out.

    Notes
    -----
    1/K = cᵀ S⁻¹ c + 1/K_cable (3.9), with S the stiffness about rest and c the cable's unit force and moment:
    the body tilts and yaws while it is pulled, which makes it softer than 4·K_tire. One gripping wheel alone would
    let the body turn about it, so such a pull is made in a fixture.
    """
    stiffness = linear_robot(robot).stiffness.copy()
    for wheel in range(1, 5):
        if wheel not in gripping:
            x, y, z = robot.contact_points[wheel - 1]
            motion = np.array([[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x]], float)
            stiffness -= motion.T @ (robot.stiffness[:2, None] * motion)
    if fixture_needed(gripping):
        stiffness[0, 0] += FIXTURE[0]
        stiffness[5, 5] += FIXTURE[1]
    if direction == "lateral":
        force, hook = np.array([0.0, 1.0, 0.0]), np.array([0.0, robot.half_track, height - robot.height])
    else:
        rear = float(robot.contact_points[:, 0].min())
        force, hook = np.array([-1.0, 0.0, 0.0]), np.array([rear, 0.0, height - robot.height])
    wrench = np.concatenate([force, np.cross(hook, force)])
    # With one side on plates nothing but the side's own springs resists yaw, which is still enough to solve.
    compliance = float(wrench @ np.linalg.lstsq(stiffness, wrench, rcond=1e-12)[0])
    cable = robot.cable_stiffness if cable_stiffness is None else cable_stiffness
    return 1.0 / (compliance + (0.0 if np.isinf(cable) else 1.0 / cable))
