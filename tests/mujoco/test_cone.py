"""A third, short integration settles whose the shaking is: on the same law a swivel under Coulomb's cone is steady.

Written down from (2.53), (2.65), (4.9), (4.15) for small tilts, with friction that opposes the slip smoothly (full from
0.1 mm/s on); it shares no line with the simulator.
"""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from ssmr_ident.physics.robot import GRAVITY, Robot

pytestmark = pytest.mark.slow

STEP = 5e-6  # s
SMOOTH = 1e-4  # m/s


@njit(error_model="numpy")
def _swivel(cone, rate, half_track, gain, points, stiffness, damping, patch, mu, mass, moments, steps, out):
    z, roll, pitch = -points[0, 2] - mass * 9.8 / (4.0 * stiffness[2]), 0.0, 0.0
    u = v = w = p = q = r = rim = 0.0
    carcass, contact = np.zeros((4, 2)), np.zeros((4, 2))
    every = steps // out.shape[0]
    for n in range(steps):
        rim += STEP * gain * (rate * half_track - rim)
        force, torque = np.zeros(3), np.zeros(3)
        for i in range(4):
            x, y, h = points[i]
            hub = np.array([u + q * h - r * y + (rim if y > 0.0 else -rim), v + r * x - p * h, w + p * y - q * x])
            load = max(0.0, -stiffness[2] * (z + h + roll * y - pitch * x) - damping[2] * hub[2])
            both = np.sqrt(contact[i, 0] ** 2 + contact[i, 1] ** 2)
            pull = np.zeros(2)
            for j in range(2):
                slip = np.sqrt((both if cone else contact[i, j]) ** 2 + SMOOTH**2)
                driving = stiffness[j] * carcass[i, j] + damping[j] * (hub[j] - contact[i, j])
                contact[i, j] = (contact[i, j] + STEP / patch * driving) / (1.0 + STEP / patch * mu * load / slip)
                pull[j] = -stiffness[j] * carcass[i, j] - damping[j] * (hub[j] - contact[i, j])
                carcass[i, j] += STEP * (hub[j] - contact[i, j])
            force += np.array([pull[0], pull[1], load])
            torque += np.array([y * load - h * pull[1], h * pull[0] - x * load, x * pull[1] - y * pull[0]])
        if n % every == 0:
            out[n // every] = r, force[1] / mass
        u, v = u + STEP * (force[0] / mass + r * v), v + STEP * (force[1] / mass - r * u)
        w += STEP * (force[2] / mass - 9.8)
        p, q, r = (
            p + STEP * torque[0] / moments[0],
            q + STEP * torque[1] / moments[1],
            r + STEP * torque[2] / moments[2],
        )
        z, roll, pitch = z + STEP * w, roll + STEP * p, pitch + STEP * q


@pytest.mark.parametrize("degrees", [6.0, 45.0])
def test_the_cone_turns_steadily_at_its_closed_form_and_the_relay_at_the_wheels(even: Robot, degrees: float) -> None:
    assert GRAVITY == 9.8
    rate, a, c = np.radians(degrees), 0.14, 0.18
    for cone, expected, tolerance in ((True, 1.0 / (1.0 + (a / c) ** 2), 1e-4), (False, 1.0, 0.01)):
        out = np.empty((5000, 2))
        _swivel(
            cone, rate, c, even.motor_gain, even.contact_points, even.stiffness, even.damping, even.effective_mass,
            even.mu_static, even.mass, np.diag(even.inertia).copy(), 1_000_000, out,
        )  # fmt: skip
        last = out[4000:]
        assert last[:, 0].mean() / rate == pytest.approx(expected, rel=tolerance)
        assert last[:, 1].std() < 1e-3
