"""Every effect against a law in closed form that shares no code with its kernel."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.signal import butter, lfilter, lfilter_zi
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.experiments.pull import pull
from ssmr_ident.experiments.straight import straight
from ssmr_ident.physics.effects import CATALOGUE, ground_roughness
from ssmr_ident.physics.element import STATES, element_advance, element_force, element_loaded
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.physics.slots import checked, effect_vector
from ssmr_ident.physics.tire import grip_shares
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.bench import compress_wheel, drag_wheel
from ssmr_ident.simulate.rig import simulate_rig

MASS, STIFFNESS = 8.0, 18000.0
OMEGA = math.sqrt(STIFFNESS / MASS)
HELD = {"mu_static": 1e9, "mu_kinetic": 1e9}
LAWS: set[str] = set()


def law(effect_id: str):  # type: ignore[no-untyped-def]
    """Mark a test as the law of an effect."""
    LAWS.add(effect_id)
    return lambda function: function


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended")).with_changes(slip_coupling=0.0)


def _swing(effects: dict[str, dict[str, float]], amplitude: float, damping: float = 0.0) -> np.ndarray:
    """Position of an undamped mass let go, (n,) [m], 8 kHz for 2 s, integrated at 64 kHz."""
    rig = Rig(MASS, damping, STIFFNESS)
    return simulate_rig(rig, np.zeros(16000), 8000.0, position=amplitude, oversampling=8, effects=effects)[:, 0]


def _period(course: np.ndarray, rate: float) -> float:
    up = np.flatnonzero((course[:-1] < 0) & (course[1:] >= 0))
    exact = up - course[up] / (course[up + 1] - course[up])
    return float((exact[-1] - exact[0]) / (len(exact) - 1) / rate)


def _extremes(course: np.ndarray) -> np.ndarray:
    """Heights of the turning points after the start, by a parabola through three samples."""
    k = np.flatnonzero(np.diff(np.sign(np.diff(course)))) + 1
    bend = course[k - 1] - 2 * course[k] + course[k + 1]
    return course[k] - (course[k + 1] - course[k - 1]) ** 2 / (8 * bend)


@law("nonlinear_stiffness")
def test_duffing_period_is_the_elliptic_integral() -> None:
    """x'' + a x + b x³ = 0 from A: T = 4 K(m)/√(a + bA²), m = bA²/(2(a + bA²)); Kovacic and Brennan, chapter 2."""
    for k3, amplitude in ((5e8, 6e-3), (-2e8, 5e-3)):
        a, b = STIFFNESS / MASS, k3 / MASS
        stiff = a + b * amplitude**2
        expected = 4.0 * ellipk(b * amplitude**2 / (2.0 * stiff)) / math.sqrt(stiff)
        for values in ({"k3_N_m3": k3}, {"k3_N_m3": 0.0, "k3_share_1_m2": k3 / STIFFNESS}):
            course = _swing({"nonlinear_stiffness": values}, amplitude)
            assert _period(course, 8000.0) == pytest.approx(expected, rel=1e-5)
        assert abs(expected * OMEGA / (2 * math.pi) - 1) > 0.05


@law("nonlinear_stiffness")
@pytest.mark.parametrize("share", [0.6, -0.4])
def test_a_knee_gives_the_period_of_two_slopes(share: float) -> None:
    """An arc at K up to the knee and one at (1 + a) K beyond it, each a part of its own circle."""
    knee, top = 2e-3, 6e-3
    beyond = OMEGA * math.sqrt(1.0 + share)
    centre = knee - knee / (1.0 + share)  # about which the outer arc swings
    radius = top - centre
    through = math.acos((knee - centre) / radius) / beyond
    speed = radius * beyond * math.sin(beyond * through)
    expected = 4.0 * (through + math.atan(knee * OMEGA / speed) / OMEGA)
    values = {"k3_N_m3": 0.0, "knee_share": share, "knee_m": knee}
    assert _period(_swing({"nonlinear_stiffness": values}, top), 8000.0) == pytest.approx(expected, rel=1e-5)


@law("nonlinear_stiffness")
def test_a_robot_stands_still_on_tires_that_harden_in_proportion() -> None:
    """The weight is the sum of K_z d + b K_z d³; upright too, every tire pushes by its own stiffness."""
    robot = robot_from_parameters(read_parameters("p3at-extended"))
    share = 2e5
    values = {"k3_N_m3": 0.0, "k3_share_1_m2": share}
    still = simulate(robot, free_response("roll", 0.0, 0.2), effects={"nonlinear_stiffness": values})
    assert np.ptp(still["z"]) < 1e-12
    attitude = Rotation.from_euler("xyz", [still["roll"][0], still["pitch"][0], 0.0])
    depth = -(still["z"][0] + attitude.apply(robot.contact_points)[:, 2])
    carried = robot.stiffness[2] * np.sum(depth + share * depth**3)
    assert carried == pytest.approx(robot.mass * GRAVITY, rel=1e-9)
    assert carried / (robot.stiffness[2] * np.sum(depth)) > 1.05


@law("dry_friction")
@pytest.mark.parametrize("slider", [0.0, 1.0])
def test_friction_takes_four_times_force_and_way_per_cycle(slider: float) -> None:
    """4 F (A - F/k) of a spring with a slider, exactly; of Dahl's law up to the rounding of its corners."""
    friction, stiffness, top = 2.0, 2e4, 1e-3
    e = effect_vector(
        checked({"dry_friction": {"F_c_N": friction, "element_stiffness_N_m": stiffness, "slider": slider}})
    )
    way = top * np.sin(2.0 * np.pi * np.linspace(0.0, 2.0, 8001))
    hidden, force = np.zeros(STATES), []
    for rate in np.diff(way):
        element_advance(hidden, rate, 1.0, True, e)
        force.append(element_force(0.0, 0.0, hidden, STIFFNESS, 1.0, 1.0, True, e))
    work = float(np.sum(np.array(force[4000:]) * np.diff(way)[4000:]))
    assert work == pytest.approx(4.0 * friction * (top - friction / stiffness), rel=2e-3 if slider else 2e-2)


@law("dry_friction")
def test_friction_without_travel_is_a_damper_far_below_its_rounding_and_coulombs_far_above() -> None:
    """ln(A0/A_n) = n pi 2 xi/√(1 - xi²) of a damper F/v_r; 4 F/K a cycle of Coulomb's; between, tanh."""
    friction, amplitude = 2.0, 5e-3
    slow = _extremes(_swing({"dry_friction": {"F_c_N": friction, "rounding_m_s": 40.0 * OMEGA * amplitude}}, amplitude))
    xi = friction / (40.0 * OMEGA * amplitude) / (2.0 * math.sqrt(STIFFNESS * MASS))
    assert math.log(slow[1] / slow[21]) == pytest.approx(20.0 * math.pi * xi / math.sqrt(1.0 - xi**2), rel=2e-3)
    fast = _extremes(_swing({"dry_friction": {"F_c_N": friction, "rounding_m_s": 2e-3 * OMEGA * amplitude}}, amplitude))
    assert (fast[1] - fast[11]) / 5.0 == pytest.approx(4.0 * friction / STIFFNESS, rel=2e-3)
    e = effect_vector(checked({"dry_friction": {"F_c_N": friction, "rounding_m_s": 0.1}}))
    rates = 0.2 * np.cos(np.linspace(0.0, 2.0 * np.pi, 2001))
    found = [element_force(0.0, rate, np.zeros(STATES), STIFFNESS, 1.0, 1.0, True, e) for rate in rates]
    grown = np.exp(2.0 * rates / 0.1)
    assert found == pytest.approx(friction * (grown - 1.0) / (grown + 1.0), abs=1e-12)


@law("dry_friction")
def test_a_push_leaves_what_its_own_laws_leave() -> None:
    """Dahl from rest: z = F/k (1 - exp(-s k/F)); Bouc and Wen with n = 2: y tanh(s/y); a dashpot has not moved."""
    push, reach, y = 4e-4, 5e-4, 3e-4
    e = effect_vector(
        checked({
            "dry_friction": {"F_c_N": reach * 3e3, "element_stiffness_N_m": 3e3},
            "hysteresis": {"alpha": 0.8, "yield_m": y},
            "viscoelastic_relaxation": {"K_m_N_m": 1e3, "tau_s": 1e-2},
        })
    )  # fmt: skip
    for share in (1.0, -0.3):
        found = element_loaded(push, share, True, e)
        exact = reach * (1.0 - math.exp(-push / reach)), y * math.tanh(push / y), push
        assert found == pytest.approx([share * z for z in exact], rel=1e-9)
    assert element_loaded(push, 1.0, False, e)[:2] == (0.0, 0.0)


@law("dry_friction")
def test_coulomb_swings_lose_four_times_friction_over_stiffness_in_each_cycle() -> None:
    friction = 4.0
    values = {"F_c_N": friction, "element_stiffness_N_m": 1e8}
    tops = np.abs(_extremes(_swing({"dry_friction": values}, 5e-3)))
    moving = tops[tops > 1.5 * friction / STIFFNESS]
    assert len(moving) > 6
    assert -np.diff(moving) == pytest.approx(2.0 * friction / STIFFNESS, rel=5e-3)
    assert tops[-1] < friction / STIFFNESS  # and it stops within the dead zone


@law("quadratic_damping")
def test_quadratic_damping_leads_from_one_turning_point_to_the_next() -> None:
    """First integral of x'' + w²x + b x'|x'| = 0: (1 + 2bA)e^(-2bA) = (1 - 2bA')e^(2bA'); Nayfeh and Mook 3.3."""
    d2 = 3000.0
    b = d2 / MASS
    tops = np.abs(_extremes(_swing({"quadratic_damping": {"d2_N_s2_m2": d2}}, 5e-3)))
    for now, later in itertools.pairwise(tops[:7]):
        left = (1 + 2 * b * now) * math.exp(-2 * b * now)
        root = brentq(lambda x, left=left: (1 - 2 * b * x) * math.exp(2 * b * x) - left, 1e-7, 0.9999 * now)
        assert later == pytest.approx(root, rel=5e-4)


@law("unlisted")
def test_a_damper_that_only_works_one_way_gives_back_what_it_took() -> None:
    """m x'' + c|x'| + k x = 0 is a linear swing of damping ∓c: down it grows by e^(pi xi/√(1 - xi²)), up it shrinks."""
    c = 60.0
    xi = c / (2.0 * math.sqrt(STIFFNESS * MASS))
    tops = _extremes(_swing({"unlisted": {"c_abs_v_N_s_m": c}}, 5e-3))
    growth = math.exp(math.pi * xi / math.sqrt(1.0 - xi**2))
    assert len(tops) > 20
    assert growth > 1.2
    assert tops[0::2] == pytest.approx(-5e-3 * growth, rel=5e-5)
    assert tops[1::2] == pytest.approx(5e-3, rel=5e-5)


@law("unlisted")
def test_under_a_root_damper_the_root_of_the_amplitude_falls_in_a_straight_line() -> None:
    """The work per period, c w^(1/2) A^(3/2) ∮|cos|^(3/2), over k A: an average, good to the second order in c."""
    c, amplitude = 1.5, 5e-3
    tops = np.sqrt(_extremes(_swing({"unlisted": {"c_root_v_N_s05_m05": c}}, amplitude))[1::2])
    loop = 2.0 * math.sqrt(math.pi) * math.gamma(1.25) / math.gamma(1.75)
    fall = c * math.sqrt(OMEGA) * loop / (2.0 * STIFFNESS)
    assert len(tops) > 10
    assert tops[0] - tops[10] > 0.05 * tops[0]
    assert (tops[0] - tops[10]) / 10.0 == pytest.approx(fall, rel=0.01)


@law("unlisted")
@pytest.mark.parametrize("seed", range(3))
def test_the_smooth_force_moves_a_shaken_mass_as_an_adaptive_solver_has_it(seed: int) -> None:
    """All terms at once, up to 5 N each, the formula written out again."""
    random = np.random.default_rng(seed)
    names = (
        "c_abs_v_N_s_m", "c_abs_s_N_m", "c_s2_N_m2", "c_v2_N_s2_m2", "c_sv_N_s_m2", "c_s2v_N_s_m3", "c_v3_N_s3_m3",
        "c_s_abs_v_N_s_m2", "c_root_v_N_s05_m05", "c_ts_N_m_s", "c_tv_N_m", "c_sin_s_N_m", "c_cos_s_N_m",
    )  # fmt: skip
    s, v = 5e-3, 0.2
    sizes = [v, s, s**2, v**2, s * v, s**2 * v, v**3, s * v, v**0.5, s, v, s, s]
    a, b, c, d, e, f, g, h, i, j, k, m, n = random.uniform(-5.0, 5.0, 13) / sizes
    place = float(random.uniform(-3e-3, 3e-3))
    push = lambda t: 60.0 * np.sin(2 * np.pi * 5.0 * t) * np.sin(2 * np.pi * 0.9 * t)  # noqa: E731

    def rate(t: float, state: np.ndarray) -> tuple[float, float]:
        x, u = state
        extra = (
            a * abs(u)
            + b * (abs(x - place) - abs(place))
            + c * x**2
            + d * u**2
            + e * x * u
            + f * x**2 * u
            + g * u**3
            + h * x * abs(u)
        )
        extra += i * u / (u**2 + 1e-6) ** 0.25
        extra += t * (j * x + k * u) + x * (m * np.sin(2 * np.pi * 1.7 * t) + n * np.cos(2 * np.pi * 1.7 * t))
        return u, (push(t) - 120.0 * u - STIFFNESS * x - extra) / MASS

    time = np.arange(2000) / 2000.0
    exact = solve_ivp(rate, (0.0, 1.0), (2e-3, 0.0), t_eval=time, rtol=1e-9, atol=1e-12, max_step=1e-3).y
    values = dict(zip(names, (a, b, c, d, e, f, g, h, i, j, k, m, n), strict=True)) | {
        "pulse_Hz": 1.7,
        "place_m": place,
    }
    rig = Rig(MASS, 120.0, STIFFNESS)
    found, plain = (simulate_rig(rig, push(time), 2000.0, 2e-3, effects=x) for x in ({"unlisted": values}, {}))
    for column in (0, 1):
        size = np.abs(exact[column]).max()
        assert np.abs(found[:, column] - exact[column]).max() < 2e-4 * size
        assert np.abs(plain[:, column] - exact[column]).max() > 0.03 * size


@law("unlisted")
@pytest.mark.parametrize("c", [0.0, 4e5], ids=["alone", "beside a force"])
def test_a_mass_that_rides_along_is_the_second_of_two(c: float) -> None:
    """Two bodies written out in their own places, under a force of many lines; nothing in common with the rider's y."""
    share, hertz, ratio = 0.12, 8.0, 0.04
    heavy, light, turning = (1.0 - share) * MASS, share * MASS, 2.0 * math.pi * hertz
    push = lambda t: 30.0 * np.sin(2 * np.pi * 5.0 * t) + 20.0 * np.sin(2 * np.pi * 9.3 * t)  # noqa: E731

    def rate(t: float, state: np.ndarray) -> tuple[float, float, float, float]:
        x, u, z, q = state
        pull = light * (turning**2 * (z - x) + 2.0 * ratio * turning * (q - u))
        return u, (push(t) - 40.0 * u - STIFFNESS * x - c * x**2 + pull) / heavy, q, -pull / light

    time = np.arange(1000) / 500.0
    exact = solve_ivp(rate, (0.0, time[-1]), (2e-3, 0.0, 2e-3, 0.0), t_eval=time, rtol=1e-9, atol=1e-12).y
    hard = np.array([rate(t, state)[1] for t, state in zip(time, exact.T, strict=True)])
    rig = Rig(MASS, 40.0, STIFFNESS)
    values = {"rider_share": share, "rider_Hz": hertz, "rider_ratio": ratio, "c_s2_N_m2": c}
    found, plain = (simulate_rig(rig, push(time), 500.0, 2e-3, effects=e) for e in ({"unlisted": values}, {}))
    for column, true in ((0, exact[0]), (1, exact[1]), (2, hard)):
        assert np.std(found[:, column] - true) < 5e-4 * np.std(true)
        assert np.std(plain[:, column] - true) > 0.1 * np.std(true)


def test_no_mass_rides_along_on_a_robot(robot: Robot) -> None:
    with pytest.raises(InputError, match=r"unlisted.rider_share.*rig's mass.*flexible_mast"):
        simulate(robot, free_response("roll"), effects={"unlisted": {"rider_share": 0.1}})


@law("unlisted")
def test_a_tire_has_the_same_smooth_force_along_both_axes_and_springs_in_proportion(robot: Robot) -> None:
    """With its contacts about the CoM and at its height, a robot that slides nowhere is one mass on four springs."""
    ahead = [robot.contact_points[:, 0].mean(), 0.0, 0.0]
    low = robot.with_changes(contact_points=(robot.contact_points - ahead) * [1.0, 1.0, 1e-6], **HELD)
    c, cubic = -60.0, 2e4
    stop, place = 900.0, 3e-4
    values = {"c_abs_v_N_s_m": c, "c_v3_N_s3_m3": cubic, "c_abs_s_N_m": stop, "place_m": place}
    for axis, name in enumerate(("x", "y")):
        k, d = low.stiffness[axis], low.damping[axis]

        def rate(t: float, state: np.ndarray, k: float = k, d: float = d) -> tuple[float, float]:
            s, v = state
            extra = c * abs(v) + cubic * v**3 + stop * k / low.stiffness[1] * (abs(s - place) - place)
            return v, -4.0 / low.mass * (k * s + d * v + extra)

        time = np.arange(500) / 1000.0
        exact = solve_ivp(rate, (0.0, 0.5), (1e-3, 0.0), t_eval=time, rtol=1e-9, atol=1e-13, max_step=1e-3).y[0]
        scenario = Scenario("free_response", 0.5, offset={name: 1e-3})
        found = simulate(low, scenario, 1000.0, effects={"unlisted": values})[name]
        plain = simulate(low, scenario, 1000.0)[name]
        assert np.abs(found - exact).max() < 1e-4 * 1e-3
        assert np.abs(plain - exact).max() > 0.05 * 1e-3


@law("free_play")
def test_play_adds_its_crossing_time_to_every_period() -> None:
    """T = 2 pi/w + 2 g/(w (A - g/2)): two crossings of the gap at full speed."""
    gap, amplitude = 4e-4, 2e-3
    found = _period(_swing({"free_play": {"gap_m": gap, "rounding": 1e-3}}, amplitude), 8000.0)
    assert found == pytest.approx(2 * math.pi / OMEGA + 2 * gap / (OMEGA * (amplitude - gap / 2)), rel=1e-4)


@law("viscoelastic_relaxation")
def test_a_held_maxwell_branch_relaxes_exponentially(robot: Robot) -> None:
    """Pressed at v for T and held: K_m v tau (1 - e^(-T/tau)) e^(-t/tau) beside the spring, in the ratio K_z/K_y."""
    step, speed, ramp, tau, branch = 1e-3, 2e-3, 0.5, 0.3, 5000.0
    time = np.arange(2000) * step
    head = speed * np.minimum(time, ramp)
    force = compress_wheel(robot, head, step, effects={"viscoelastic_relaxation": {"K_m_N_m": branch, "tau_s": tau}})
    held = time > ramp + step
    stiffness = robot.stiffness[2]
    taken = branch * stiffness / robot.stiffness[1] * speed * tau * (1 - math.exp(-ramp / tau))
    expected = stiffness * speed * ramp + taken * np.exp(-(time[held] - ramp) / tau)
    assert force[held] == pytest.approx(expected, rel=1e-4)


@law("load_dependent_friction")
@pytest.mark.parametrize("up", [1.0, -1.0])
def test_gears_ask_for_more_than_a_weight_to_lift_it_and_for_less_to_let_it_down(up: float) -> None:
    """tau (1 - c) = (1 + c) W on the way up, the other way round on the way down: weight and drive both load them."""
    weight, share, speed = 0.3, 0.2, up * 0.5
    balance = weight * ((1.0 + share) / (1.0 - share)) ** up
    soft = 1e-9  # N/m: pulled out so far that it is a weight
    values = {"F_c_N": 0.0, "c": share, "rounding_m_s": 1e-3}
    reached = [
        simulate_rig(
            Rig(0.01, 0.0, soft), np.full(60, more * balance), 200.0, weight / soft, speed, 8,
            effects={"load_dependent_friction": values},
        )[-1, 1]
        for more in (0.98, 1.0, 1.02)
    ]  # fmt: skip
    assert reached[0] < speed < reached[2]
    assert reached[1] == pytest.approx(speed, rel=1e-6)


@law("hysteresis")
def test_a_bouc_wen_loop_saturates_and_its_area_does_not_depend_on_speed() -> None:
    """F = aKs + (1-a)K y tanh(s/y) on first loading; a cycle of ±S costs 4(1-a)K (S y - (3/4 + ln2/2) y²)."""
    alpha, width, top = 0.6, 2e-4, 4e-3
    values = {"hysteresis": {"alpha": alpha, "yield_m": width}}
    areas = []
    for hertz in (0.05, 0.5):  # a mass so light that the force is the element's alone
        time = np.arange(int(2000 / hertz)) / 1000.0
        drive = (alpha * STIFFNESS * top + (1 - alpha) * STIFFNESS * width) * np.sin(2 * np.pi * hertz * time)
        position = simulate_rig(Rig(0.05, 12.0, STIFFNESS), drive, 1000.0, oversampling=16, effects=values)[:, 0]
        rise = time < 0.25 / hertz
        s = position[rise]
        law_of_loading = alpha * STIFFNESS * s + (1 - alpha) * STIFFNESS * width * np.tanh(s / width)
        viscous = 12.0 * np.gradient(position, time)[rise]
        assert drive[rise] - viscous == pytest.approx(law_of_loading, abs=0.02 * drive.max())
        cycle = time >= 1.0 / hertz
        force = drive - 12.0 * np.gradient(position, time)
        areas.append(float(np.trapezoid(force[cycle], position[cycle])))
        swing = np.abs(position).max()
        expected = 4 * (1 - alpha) * STIFFNESS * (swing * width - (0.75 + math.log(2) / 2) * width**2)
        assert areas[-1] == pytest.approx(expected, rel=0.01)
    assert areas[0] == pytest.approx(areas[1], rel=0.01)


@law("sensor_bandwidth")
def test_the_sensor_is_three_decibels_down_and_a_quarter_turn_late_at_its_bandwidth() -> None:
    time = np.arange(4000) / 2000.0
    drive = np.sin(2 * np.pi * 40.0 * time)
    rig = Rig(1.0, 5.0, 100.0)
    plain, slow = (
        simulate_rig(rig, drive, 2000.0, effects=e)[2000:, 2]
        for e in ({}, {"sensor_bandwidth": {"bandwidth_hz": 40.0}})
    )
    turn = np.exp(-2j * np.pi * 40.0 * time[2000:])
    ratio = (slow @ turn) / (plain @ turn)
    assert abs(ratio) == pytest.approx(1 / math.sqrt(2), rel=2e-3)
    assert np.angle(ratio) == pytest.approx(-math.pi / 2, abs=5e-3)


@law("sensor_delay")
def test_a_late_channel_is_the_same_one_some_samples_on() -> None:
    drive = np.sin(2 * np.pi * 3.0 * np.arange(800) / 1000.0)
    rig = Rig(1.0, 5.0, 100.0)
    plain, late = (simulate_rig(rig, drive, 1000.0, effects=e) for e in ({}, {"sensor_delay": {"delay_s": 0.005}}))
    assert late[5:] == pytest.approx(plain[:-5], abs=1e-9)


@law("sensor_saturation")
def test_every_channel_of_a_rig_clips_at_its_own_range() -> None:
    drive = np.sin(2 * np.pi * 3.0 * np.arange(800) / 1000.0)
    rig = Rig(1.0, 5.0, 100.0)
    plain = simulate_rig(rig, drive, 1000.0)
    limit = 0.5 * float(np.abs(plain[:, 0]).max())
    cut = simulate_rig(rig, drive, 1000.0, effects={"sensor_saturation": {"range_m": limit}})
    assert np.array_equal(cut[:, 0], np.clip(plain[:, 0], -limit, limit))
    assert np.array_equal(cut[:, 1:], plain[:, 1:])


@law("sensor_saturation")
def test_saturation_cuts_and_leaves_the_rest_alone(robot: Robot) -> None:
    plain, cut = (
        simulate(robot, free_response("pitch", 1e-3, 0.5), effects=e)
        for e in ({}, {"sensor_saturation": {"range_m_s2": 11.0}})
    )
    assert plain["az"].max() > 12.0
    for name in ("ax", "ay", "az"):
        assert np.array_equal(cut[name], np.minimum(np.maximum(plain[name], -11.0), 11.0))
    assert np.array_equal(cut["pitch"], plain["pitch"])


@law("sensor_misalignment")
def test_turned_axes_read_the_same_length_and_lean_on_gravity(robot: Robot) -> None:
    angle = 0.1
    plain, turned = (
        simulate(robot, free_response("roll", 1e-3, 0.5), effects=e)
        for e in ({}, {"sensor_misalignment": {"angle_x_rad": 0.0, "angle_y_rad": angle, "angle_z_rad": 0.0}})
    )
    a, b = (np.column_stack([r["ax"], r["ay"], r["az"]]) for r in (plain, turned))
    assert np.linalg.norm(a, axis=1) == pytest.approx(np.linalg.norm(b, axis=1), rel=1e-12)
    # turned forward about y, the x axis looks down: it reads minus g sin, and z is g cos
    assert b[:, 0] == pytest.approx(a[:, 0] * math.cos(angle) - a[:, 2] * math.sin(angle), abs=1e-12)
    assert np.array_equal(a[:, 1], b[:, 1])


@law("load_cell_drift")
def test_drift_is_a_straight_line_over_time(robot: Robot) -> None:
    plain, drifted = (
        simulate(robot, pull("lateral", 1.0, 5.0), 100.0, effects=e)
        for e in ({}, {"load_cell_drift": {"zero_drift_N_s": 0.7, "gain_drift_1_s": 0.01}})
    )
    t = plain.time
    assert drifted["force"] == pytest.approx(plain["force"] * (1 + 0.01 * t) + 0.7 * t, abs=1e-12)


def _slope(result, start: float, end: float) -> float:  # type: ignore[no-untyped-def]
    part = (result.time > start) & (result.time < end)
    return float(np.polyfit(result["head"][part], result["force"][part], 1)[0])


@law("cable_compliance")
def test_a_cable_adds_its_compliance_to_the_ramp(robot: Robot) -> None:
    """(3.9): 1/K = 1/K_0 + 1/K_cable, whatever K_0 is: two wheels or four, low or high."""
    for height in (0.0, 0.2):
        plain, soft = (
            _slope(simulate(robot, pull("lateral", 1.0, 2.0, height=height), 200.0, effects=e), 0.8, 1.8)
            for e in ({}, {"cable_compliance": {"K_cable_N_m": 3e4}})
        )
        assert 1 / soft - 1 / plain == pytest.approx(1 / 3e4, rel=0.01)


@law("motor_belt")
def test_belts_are_in_series_with_the_tires_they_drive(robot: Robot) -> None:
    """(4.14) for two tires on each belt; pulled at the height of the contacts, so that the robot does not nod."""
    belt, kx = 2e4, float(robot.stiffness[0])
    scenario = pull("longitudinal", 1.0, 6.0, height=0.0)
    stiff = _slope(simulate(robot, scenario, 200.0), 2.0, 5.5)
    soft = _slope(simulate(robot, scenario, 200.0, effects={"motor_belt": {"K_b_N_m": belt}}), 2.0, 5.5)
    assert stiff == pytest.approx(4 * kx, rel=0.02)  # the steel cable and nodding take a part
    assert 1 / soft - 1 / stiff == pytest.approx(1 / (2 * belt), rel=0.03)


@law("motor_belt")
def test_a_robot_is_let_go_with_belts_and_tires_in_equilibrium(robot: Robot) -> None:
    """As on tires that are softer by the series of both, with no ringing of the rims."""
    belt, kx = 3e4, float(robot.stiffness[0])
    share = belt / (belt + 2 * kx)  # of a slow strain, the tire's
    damping = share**2 * robot.damping[0] + (1 - share) ** 2 * 5.0 / 2
    soft = robot.with_changes(
        stiffness=np.array([kx * share, *robot.stiffness[1:]]), damping=np.array([damping, *robot.damping[1:]])
    )
    belts = {"motor_belt": {"K_b_N_m": belt, "D_b_N_s_m": 5.0, "rim_mass_kg": 0.1}}
    let_go = Scenario("free_response", 1.0, offset={"x": 1e-3}, velocity={"x": 0.02})
    made, series = simulate(robot, let_go, 1000.0, effects=belts), simulate(soft, let_go, 1000.0)
    away = np.std(made["ax"] - series["ax"]) / np.std(series["ax"])
    assert away < 0.04  # the rims' own mass is 0.6 % of the robot's


@law("stribeck")
def test_steady_sliding_costs_what_the_stribeck_curve_says(robot: Robot) -> None:
    """A light contact slides steadily where friction falls by less than D over speed, else it sticks and slips."""
    share, load = 0.7, robot.mass * GRAVITY / 4
    light = robot.with_changes(effective_mass=0.0)
    for speed, width, steady in ((0.2, 0.05, True), (0.02, 0.003, True), (0.2, 0.6, True), (0.2, 0.3, False)):
        head = np.linspace(0.0, 0.06, 3000)
        step = 0.06 / 3000 / speed
        effects = {"stribeck": {"kinetic_share": share, "stribeck_velocity_m_s": width}}
        force = drag_wheel(light, head, step, effects=effects)[-500:]
        fall = (1 - share) * math.exp(-((speed / width) ** 2))
        slope = robot.mu_static * load * fall * 2 * speed / width**2
        assert (slope < robot.damping[1]) == steady
        if steady:
            assert force == pytest.approx(robot.mu_static * load * (share + fall), rel=5e-3)
        else:
            assert np.ptp(force) > 0.2 * robot.mu_static * load  # stick-slip


@law("load_sensitive_friction")
def test_the_plateau_is_the_sum_over_unequal_loads(robot: Robot) -> None:
    """Coulomb sliding, all four wheels: F = sum of mu N (N/N_0)^-n with the loads of that moment."""
    n, smooth = 0.3, robot.with_changes(mu_static=0.8, mu_kinetic=0.8)
    scenario = pull("lateral", 2.0, 8.0, height=0.15)
    result = simulate(smooth, scenario, 100.0, effects={"load_sensitive_friction": {"exponent": n}})
    loads = np.column_stack([result[f"load_{i}"] for i in (1, 2, 3, 4)])[600:]
    assert np.ptp(loads) > 50.0
    expected = (0.8 * loads * (loads / (robot.mass * GRAVITY / 4)) ** -n).sum(axis=1)
    assert result["force"][600:] == pytest.approx(expected, rel=0.01)
    assert expected.mean() < 0.99 * 0.8 * robot.mass * GRAVITY


@law("slip_coupling")
def test_grip_shares_are_those_of_4_10_to_4_12() -> None:
    """Written out with lambda and the angle themselves, over a grid of wheel and slip speeds."""
    for rim in (0.05, -0.3):
        for slip_x in (0.002, -0.01, 0.2):
            for slip_y in (0.0, 0.003, -0.5):
                for limit in (0.01, 0.1, 1.0):
                    slipping = min(abs(slip_x / rim), 1.0)  # |lambda|, clamped
                    along = min(slipping / limit, 1.0)
                    across = min(abs(math.tan(math.atan2(slip_y, slip_x))) * along, 1.0)
                    share_x, share_y = grip_shares(rim, slip_x, slip_y, limit)
                    assert share_x == pytest.approx(along)
                    assert share_y == pytest.approx(across, rel=1e-9, abs=1e-12)
    assert grip_shares(0.0, 0.1, 0.1, 0.1) == (1.0, 1.0)


@law("rolling_resistance")
def test_the_slip_of_a_driven_wheel_carries_the_rolling_resistance(robot: Robot) -> None:
    """Steady straight driving with (4.10): the grip left at slip lambda, mu lambda/lambda_max, equals c_rr."""
    resistance, limit, mu = 0.05, 0.2, 0.8
    driven = robot.with_changes(slip_coupling=1.0, lambda_max=limit, mu_static=mu, mu_kinetic=mu)
    result = simulate(
        driven,
        straight(wheel_rates(robot, 0.4, 0.0), 6.0),
        100.0,
        effects={"rolling_resistance": {"c_rr": resistance}},
        release_drag=1.0,
    )
    slip = 1.0 - result["vx"][400:].mean() / 0.4
    assert slip == pytest.approx(limit * resistance / mu, rel=1e-6)


@law("ground_roughness")
def test_the_random_floor_has_the_height_and_correlation_asked_for() -> None:
    """rms exactly; correlation e^-(d/l)² averaged over floors, lines and columns alike."""
    length, height = 0.04, 3e-4
    floors = [height * ground_roughness.field(length, seed).reshape(2 * [ground_roughness.CELLS]) for seed in range(6)]
    for cells in (5, 10, 15):
        distance = cells * ground_roughness.CELL
        for axis in (0, 1):
            found = np.mean([np.mean(f * np.roll(f, cells, axis)) for f in floors]) / height**2
            assert found == pytest.approx(math.exp(-((distance / length) ** 2)), abs=0.04)
    assert [f.std() for f in floors] == pytest.approx([height] * 6, rel=1e-12)


def _line(course: np.ndarray, rate: float) -> float:
    """Frequency of the highest line [Hz], by a parabola over the windowed log spectrum."""
    spectrum = np.log(np.abs(np.fft.rfft((course - course.mean()) * np.hanning(len(course)))))
    k = int(np.argmax(spectrum[2:])) + 2
    shift = 0.5 * (spectrum[k - 1] - spectrum[k + 1]) / (spectrum[k - 1] - 2 * spectrum[k] + spectrum[k + 1])
    return float((k + shift) * rate / len(course))


@law("ground_joints")
@pytest.mark.parametrize("speed", [0.6, 0.8])
def test_joints_give_a_line_at_speed_over_pitch(robot: Robot, speed: float) -> None:
    scenario = straight(wheel_rates(robot, speed, 0.0), 10.0)
    values = {"pitch_m": 0.05, "depth_m": 1e-4, "width_m": 0.03}
    result = simulate(robot.with_changes(**HELD), scenario, 200.0, effects={"ground_joints": values})
    assert _line(result["az"][600:], 200.0) == pytest.approx(speed / 0.05, rel=2e-3)


@law("wheel_eccentricity")
@pytest.mark.parametrize("speed", [0.3, 0.8])
def test_a_wheel_out_of_round_gives_a_line_at_its_turning_rate(robot: Robot, speed: float) -> None:
    scenario = straight(wheel_rates(robot, speed, 0.0), 22.0)
    result = simulate(
        robot.with_changes(**HELD), scenario, 100.0, effects={"wheel_eccentricity": {"eccentricity_m": 1e-4}}
    )
    assert _line(result["pitch"][200:], 100.0) == pytest.approx(speed / robot.radius / (2 * np.pi), rel=5e-3)


@law("coriolis")
def test_a_thrown_robot_that_turns_flies_straight_only_with_coriolis(robot: Robot) -> None:
    """In turning axes a straight path needs M V^ V; without it the velocity turns along with the robot."""
    spin, speed = 2.0, 0.5
    flight = Scenario("free_response", 0.3, offset={"z": 2.0}, velocity={"x": speed, "yaw": spin})
    # inertia without products: it spins about a principal axis and does not tumble
    plain = robot.with_changes(inertia=np.diag(np.diag(robot.inertia)), effective_mass=0.0)
    lifted = {"wheel_lift": {}}
    for effects, x, y in (
        ({**lifted, "coriolis": {}}, speed * 0.299, 0.0),
        (lifted, speed / spin * math.sin(spin * 0.299), speed / spin * (1 - math.cos(spin * 0.299))),
    ):
        result = simulate(plain, flight, effects=effects)
        assert (result["x"][-1], result["y"][-1]) == pytest.approx((x, y), abs=1e-6)


@law("wheel_lift")
def test_lifted_wheels_carry_nothing_and_the_robot_falls_freely(robot: Robot) -> None:
    drop = 0.01
    result = simulate(robot, Scenario("free_response", 1.0, offset={"z": drop}), effects={"wheel_lift": {}})
    loads = np.column_stack([result[f"load_{i}"] for i in (1, 2, 3, 4)])
    sink = robot.mass * GRAVITY / (4 * robot.stiffness[2])
    landing = math.sqrt(2 * (drop - sink) / GRAVITY)
    assert loads.min() == 0.0
    assert loads[result.time < 0.98 * landing].max() == 0.0
    assert loads[(result.time > 1.05 * landing) & (result.time < 1.3 * landing)].min() > 0.0


@law("com_offset")
def test_loads_follow_the_displaced_centre(robot: Robot) -> None:
    """Four equal stiff springs at the corners of a rectangle: N = m g/4 (1 ± 2 d_x'/l ± 2 d_y/w)."""
    dx, dy, weight = 0.03, -0.02, robot.mass * GRAVITY
    stiff = robot.with_changes(stiffness=robot.stiffness * np.array([1.0, 1.0, 100.0]))
    effects = {"com_offset": {"offset_x_m": dx, "offset_y_m": dy}}
    result = simulate(stiff, Scenario("free_response", 0.01), 1000.0, step=2e-5, effects=effects)
    front, left = 2 * (0.15 + dx) / 0.28 - 1, 2 * (0.18 + dy) / 0.36 - 1
    shares = 0.25 * (1 + front * np.array([-1, 1, 1, -1]) + left * np.array([1, 1, -1, -1]))
    loads = [result[f"load_{i}"][0] for i in (1, 2, 3, 4)]
    assert loads == pytest.approx(weight * shares, rel=2e-3)


@law("translation_coupling")
def test_coupled_modes_are_roots_of_the_derived_5_11(robot: Robot) -> None:
    """Poles of the linear model, with damping, put into the determinants of section 5."""
    points = robot.contact_points.copy()
    points[:, 0] = np.sign(points[:, 0]) * 0.14
    even = robot.with_changes(contact_points=points, inertia=np.diag(np.diag(robot.inertia)))
    m, h, c, a = even.mass, 0.23, 0.18, 0.14
    (kx, ky, kz), (dx, dy, dz) = even.stiffness, even.damping
    poles = np.linalg.eigvals(linear_robot(even).state_matrix)
    poles = poles[poles.imag > 0]

    def determinant(s: complex, inertia: float, k: float, d: float, lever: float) -> complex:
        side = m * s**2 + 4 * d * s + 4 * k
        turn = inertia * s**2 + 4 * (h**2 * d + lever**2 * dz) * s + 4 * (h**2 * k + lever**2 * kz) - m * GRAVITY * h
        return (side * turn - (4 * h * (d * s + k)) ** 2) / abs(side * turn)

    for inertia, k, d, lever in ((even.inertia[0, 0], ky, dy, c), (even.inertia[1, 1], kx, dx, a)):
        at_poles = np.sort([abs(determinant(s, inertia, k, d, lever)) for s in poles])
        # the simulator's arms are those of the tires pressed by 1 mm, which moves roots by that over h
        assert np.all(at_poles[:2] < 0.02)
        assert at_poles[2] > 0.05


@law("flexible_mast")
def test_a_swaying_mast_follows_its_eight_by_eight_linear_system(robot: Robot) -> None:
    """Lagrange's equations of a point mass on horizontal springs, written out here, through the matrix exponential."""
    values = {"f_mast_Hz": 9.0, "mass_kg": 2.5, "height_above_com_m": 0.33, "damping_ratio": 0.03}
    mast, height, omega = 2.5, 0.33, 2 * np.pi * 9.0
    points = robot.contact_points.copy()
    points[:, 0] = np.sign(points[:, 0]) * 0.14  # even, so that it rests upright and the mast does not lean
    held = robot.with_changes(contact_points=points, **HELD)
    plain = linear_robot(held)
    mass, damping, stiffness = (np.zeros((8, 8)) for _ in range(3))
    for big, small in ((mass, plain.mass), (damping, plain.damping), (stiffness, plain.stiffness)):
        big[:6, :6] = small
    for axis, angle, sign in ((0, 4, 1.0), (1, 3, -1.0)):
        sway = 6 + axis
        mass[sway, sway] = mast
        mass[axis, sway] = mass[sway, axis] = mast
        mass[angle, sway] = mass[sway, angle] = sign * mast * height  # the tip moves by angle times height
        stiffness[sway, sway], damping[sway, sway] = mast * omega**2, 2 * 0.03 * omega * mast
        stiffness[angle, sway] = stiffness[sway, angle] = -sign * mast * GRAVITY  # a leaning mast falls further
    inverse = np.linalg.inv(mass)
    matrix = np.block([[np.zeros((8, 8)), np.eye(8)], [-inverse @ stiffness, -inverse @ damping]])
    offset = {"roll": 1e-5, "pitch": 1e-5}
    result = simulate(held, Scenario("free_response", 1.0, offset=offset), 500.0, effects={"flexible_mast": values})
    state = np.zeros(16)
    state[3] = state[4] = 1e-5
    step, rows = expm(matrix / 500.0), []
    for _ in result.time:
        rows.append(state)
        state = step @ state
    course = np.array(rows)
    for name, index in (("x", 0), ("y", 1), ("roll", 3), ("pitch", 4)):
        assert np.abs(result[name] - course[:, index]).max() < 2e-3 * np.abs(course[:, index]).max()
    frequencies = np.sort(np.abs(np.linalg.eigvals(matrix).imag)) / (2 * np.pi)
    before = np.sort(np.abs(np.linalg.eigvals(plain.state_matrix).imag)) / (2 * np.pi)
    assert len(set(frequencies.round(3))) == len(set(before.round(3))) + 2  # two further lines


def test_no_effect_is_without_a_law() -> None:
    assert set(CATALOGUE) == LAWS


@law("sensor_bandwidth")
@pytest.mark.parametrize("unseen", [0.0, 1.0, 0.4])
def test_a_slow_sensor_meets_the_release_as_a_butterworth_filter_does(robot: Robot, unseen: float) -> None:
    """Held for 0.4 s in the pose of the release, at rest, then let go: scipy's filter over both stretches."""
    rate, cutoff = 8000.0, 14.0
    offset = {"roll": 2e-3, "pitch": 1.5e-3, "yaw": 1e-3}
    open_robot = robot.with_changes(accelerometer=replace(robot.accelerometer, bandwidth_hz=math.inf))
    free = simulate(open_robot, Scenario("free_response", 0.3, offset=offset), rate)
    seen = Scenario("free_response", 0.3, offset={**offset, "unseen": unseen})
    slow = simulate(open_robot, seen, rate, effects={"sensor_bandwidth": {"bandwidth_hz": cutoff}})
    forward, back = butter(2, cutoff, fs=rate)
    pose = Rotation.from_euler("ZYX", [0.0, free["pitch"][0], free["roll"][0]])
    standing = pose.inv().apply([0.0, 0.0, GRAVITY])
    for axis, name in enumerate(("ax", "ay", "az")):
        before = free[name][0] - unseen * (free[name][0] - standing[axis])
        course = np.concatenate([np.full(3200, before), free[name]])
        exact = lfilter(forward, back, course, zi=lfilter_zi(forward, back) * before)[0][3200:]
        assert np.abs(slow[name] - exact).max() < 2e-3 * np.ptp(free[name])
        assert unseen == 0.0 or np.abs(slow[name][:80] - free[name][:80]).max() > 0.1 * np.ptp(free[name])
