"""Energy of the body in a simulated run, and the power of the floor on it."""

from __future__ import annotations

import numpy as np

from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.statics import tilt
from ssmr_ident.simulate.simulation import Simulation


def body_energy(robot: Robot, run: Simulation) -> np.ndarray:
    """½·Vᵀ·M·V of (2.65) and m·g·z at each sample, (n,) float [J].

    The velocity of the CoM upward is the derivative of its height: samples must be close against the motion.
    """
    velocity = np.column_stack([run["vx"], run["vy"], np.gradient(run["z"], run.time)])
    rates = np.column_stack([run[name] for name in ("wx", "wy", "wz")])
    moving = 0.5 * robot.mass * np.sum(velocity**2, axis=1)
    turning = 0.5 * np.einsum("ni,ij,nj->n", rates, robot.inertia, rates)
    return moving + turning + robot.mass * GRAVITY * run["z"]


def floor_power(robot: Robot, run: Simulation) -> np.ndarray:
    """Power of the forces on the hubs at the contact points, Σ f_i·(v + ω × r_i) (2.53)-(2.55), (n,) float [W]."""
    upward = np.gradient(run["z"], run.time)
    power = np.zeros(len(run.time))
    for k, (roll, pitch) in enumerate(zip(run["roll"], run["pitch"], strict=True)):
        rotation = tilt(roll, pitch)
        arms = robot.contact_points @ rotation.T
        rates = rotation @ np.array([run["wx"][k], run["wy"][k], run["wz"][k]])
        hubs = np.array([run["vx"][k], run["vy"][k], upward[k]]) + np.cross(rates, arms)
        forces = np.array([[run[f"{axis}_{i}"][k] for axis in ("force_x", "force_y", "load")] for i in (1, 2, 3, 4)])
        power[k] = float(np.sum(forces * hubs))
    return power
