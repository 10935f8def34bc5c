"""Longitudinal slip of each wheel over a simulated run."""

from __future__ import annotations

import numpy as np

from ssmr_ident.physics.robot import Robot
from ssmr_ident.simulate.simulation import Simulation


def wheel_slips(robot: Robot, run: Simulation) -> np.ndarray:
    """λ_i = (rω_i − v_ix)/(rω_i) within [−1, 1] (2.7), with v_ix the hub's velocity along the heading (2.55).

    Parameters
    ----------
    robot : Robot
    run : Simulation

    Returns
    -------
    (n, 4) float
        In the order of the contact points. A wheel that does not turn has −1 where its hub moves and 0 where not.
    """
    roll, pitch = run["roll"], run["pitch"]
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    rates = np.stack([run[name] for name in ("wx", "wy", "wz")])
    about_y, about_z = cr * rates[1] - sr * rates[2], -sp * rates[0] + cp * (sr * rates[1] + cr * rates[2])
    slips = np.empty((len(run.time), 4))
    for wheel, (a, b, c) in enumerate(robot.contact_points):
        across, up = cr * b - sr * c, -sp * a + cp * (sr * b + cr * c)
        hub = run["vx"] + about_y * up - about_z * across
        rim = robot.radius * run["rate_left" if b > 0.0 else "rate_right"]
        turning = rim != 0.0
        ratio = np.where(turning, (rim - hub) / np.where(turning, rim, 1.0), -1.0 * (hub != 0.0))
        slips[:, wheel] = np.clip(ratio, -1.0, 1.0)
    return slips
