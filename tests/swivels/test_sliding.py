"""A contact that slides along both axes together: closed forms, and what makes a swivel shake."""

import math

import numpy as np
import pytest

from ssmr_ident.physics.tire import combined_share, sliding_force, weakened

STIFFNESS, DAMPING, STEP = (3400.0, 18000.0), (60.0, 50.0), 1e-4


def drag(velocity, limit=40.0, seconds=3.0, mass=0.035):
    deflection, contact, force = np.zeros(2), (0.0, 0.0), (0.0, 0.0)
    for _ in range(round(seconds / STEP)):
        _, *result = sliding_force(
            (deflection[0], deflection[1]), contact, velocity, (0.0, 0.0), STIFFNESS, DAMPING, mass, limit, STEP
        )
        contact, force = (result[0], result[1]), (result[2], result[3])
        deflection += STEP * (np.array(velocity) - contact)
    return np.array(contact), np.array(force)


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2, 2.8])
def test_friction_opposes_the_motion_whatever_the_axes(angle):
    velocity = 0.1 * math.cos(angle), 0.1 * math.sin(angle)
    contact, force = drag(velocity)
    np.testing.assert_allclose(contact, velocity, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(force, -40.0 * np.array(velocity) / 0.1, rtol=1e-6, atol=1e-6)


def test_it_sticks_below_the_limit_and_takes_up_the_whole_motion():
    slides, vx, vy, fx, fy = sliding_force(
        (1e-3, 1e-3), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), STIFFNESS, DAMPING, 0.035, 18.4, STEP
    )
    assert not slides
    assert (vx, vy) == (0.0, 0.0)
    assert (fx, fy) == pytest.approx((-3.4, -18.0))
    assert math.hypot(fx, fy) < 18.4  # a cone: a box of 18.4 N per axis would hold far more
    assert sliding_force(
        (1e-3, 1e-3), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), STIFFNESS, DAMPING, 0.035, 18.2, STEP
    )[0]  # fmt: skip


def test_the_contact_speed_solves_its_own_equation():
    random = np.random.default_rng(5)
    for _ in range(200):
        s, v, u = random.normal(0, 3e-3, 2), random.normal(0, 0.1, 2), random.normal(0, 0.3, 2)
        limit, step = float(random.uniform(0, 60)), float(10 ** random.uniform(-5, -3))
        slides, vx, vy, *_ = sliding_force(
            tuple(s), tuple(v), tuple(u), (0.0, 0.0), STIFFNESS, DAMPING, 0.035, limit, step
        )
        now = np.array([vx, vy])
        carcass = np.array(STIFFNESS) * (s + 0.5 * step * (u - now)) + np.array(DAMPING) * (u - now)
        inertia = 0.035 * (now - v) / step
        if slides:
            np.testing.assert_allclose(carcass - inertia, limit * now / np.hypot(*now), rtol=1e-8, atol=1e-6)
        else:
            assert np.hypot(*(carcass - inertia)) <= limit * (1 + 1e-9)


def test_growth_on_a_belt_is_that_of_the_linearised_mass():
    """A mass on its carcass, dragged at V: x grows at the rate of the eigenvalue with the friction's slope at V."""
    mass, normal, speed, width, mu_s, mu_k = 7.0, 68.0, 0.15, 0.3, 0.83, 0.62
    k, d = STIFFNESS[1], DAMPING[1]
    slope = -(mu_s - mu_k) * 2 * speed / width**2 * math.exp(-((speed / width) ** 2)) * normal  # dF/du < 0
    spring = 2000.0  # from the mass to the ground, so that it can swing
    # mass M x'' = -spring x - F, contact F(u) = K s + D s', s' = V + x' - u: states x, x', u
    # F'(u) u' = K (x' - u + V) + D (x'' - u')
    system = np.zeros((3, 3))  # of the deviations x, x', u - V
    system[0, 1] = 1.0
    system[1] = [-spring / mass, 0.0, -slope / mass]
    system[2] = (np.array([0.0, k, -k]) + d * system[1]) / (slope + d)
    values = np.linalg.eigvals(system)
    expected = values[np.argmax(values.imag)]
    assert expected.real > 0.5  # it excites itself

    step, s, x, v = 5e-5, weakened(mu_s, mu_k, speed, width) * normal / k, 0.0, 0.0
    rest = -weakened(mu_s, mu_k, speed, width) * normal / spring
    x = rest + 1e-6
    contact, track = (0.0, speed), []
    for n in range(round(6.0 / step)):
        limit = weakened(mu_s, mu_k, math.hypot(*contact), width) * normal
        _, cx, cy, _, force = sliding_force(
            (0.0, s), contact, (0.0, speed + v), (0.0, 0.0), STIFFNESS, DAMPING, 0.0, limit, step
        )
        contact = (cx, cy)
        s += step * (speed + v - cy)
        v += step * (force - spring * x) / mass
        x += step * v
        if n % 20 == 0:
            track.append(x)
    track, time = np.array(track) - rest, np.arange(len(track)) * 20 * step
    small = track < 2e-4  # where the slope is that at V
    peaks = [i for i in range(200, len(track) - 1) if track[i - 1] < track[i] >= track[i + 1] and small[i]]
    assert len(peaks) >= 5
    rate = np.polyfit(time[peaks], np.log(track[peaks]), 1)[0]
    assert rate == pytest.approx(expected.real, rel=0.03)


def test_shares_of_the_grip_are_those_of_the_thesis_for_small_slips():
    rim, lam = 0.2, 0.5
    assert combined_share(rim, 0.03, 0.04, lam) == pytest.approx(0.05 / (rim * lam))
    assert combined_share(rim, 0.3, 0.4, lam) == 1.0
    assert combined_share(0.0, 0.0, 0.1, lam) == 1.0
