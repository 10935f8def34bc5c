"""What was put in comes back: every effect is simulated, buried in noise, and fitted from a start 30 % off.

Amplitudes are fitted with the truth in everything else, in the cheapest experiment that shows the effect while the
motion is still deterministic. Switches (translation coupling, wheel lift) have no amplitude to fit: there the
likelihood of the data must choose the right side. A floor's seed cannot come back from any recording: another seed
is another floor, and the test says that no neighbouring seed explains the data.
"""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.experiments.pull import pull
from ssmr_ident.experiments.straight import straight
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.linear import LinearRobot, accelerometer_rows, linear_robot, responses
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.bench import drag_wheel
from ssmr_ident.workflows.effects.promises import robot_for_checks
from ssmr_ident.workflows.effects.recovery import (
    ACCELERATION_NOISE,
    EVEN,
    FORCE_NOISE,
    HELD,
    Case,
    Effects,
    accelerations,
    decay_of_a_tire,
    forces,
    recovered,
)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_for_checks()


def _fast_drag(robot: Robot, effects: Effects) -> np.ndarray:
    """A wheel dragged at 200 mm/s, so fast that the contact never catches up with the hub: it slides steadily."""
    return drag_wheel(robot, np.linspace(0.0, 0.04, 1000), 2e-4, effects=effects)


def _release(robot: Robot) -> Scenario:
    return Scenario("free_response", 1.0, offset={"roll": 2e-3, "pitch": 1e-3, "yaw": 2e-3})


def _rolling(robot: Robot) -> Scenario:
    return straight(wheel_rates(robot, 0.4, 0.0), 1.5)


def _spinning(robot: Robot) -> Scenario:
    return pull("lateral", 1.0, 3.0, wheel_rates=np.full((1, 2), 0.003 / robot.radius), held=True)


CASES = {
    "nonlinear_stiffness": Case(decay_of_a_tire, ACCELERATION_NOISE, ("k3_N_m3",), {}),
    "dry_friction": Case(decay_of_a_tire, ACCELERATION_NOISE, ("F_c_N",), {}),
    "load_dependent_friction": Case(decay_of_a_tire, ACCELERATION_NOISE, ("F_c_N", "c"), {}),
    "hysteresis": Case(decay_of_a_tire, ACCELERATION_NOISE, ("alpha",), {"alpha": 0.7}),
    "quadratic_damping": Case(decay_of_a_tire, ACCELERATION_NOISE, ("d2_N_s2_m2",), {}),
    "viscoelastic_relaxation": Case(decay_of_a_tire, ACCELERATION_NOISE, ("K_m_N_m",), {}),
    "unlisted": Case(
        decay_of_a_tire,
        ACCELERATION_NOISE,
        ("c_abs_v_N_s_m", "c_s2_N_m2", "c_sv_N_s_m2"),
        {"c_abs_v_N_s_m": 40.0, "c_s2_N_m2": 6e5, "c_sv_N_s_m2": 1e4},
    ),
    "free_play": Case(decay_of_a_tire, ACCELERATION_NOISE, ("gap_m",), {}),
    "sensor_bandwidth": Case(decay_of_a_tire, ACCELERATION_NOISE, ("bandwidth_hz",), {}),
    "sensor_delay": Case(decay_of_a_tire, ACCELERATION_NOISE, ("delay_s",), {}),
    "sensor_saturation": Case(decay_of_a_tire, ACCELERATION_NOISE, ("range_m_s2",), {"range_m_s2": 4.0}),
    "flexible_mast": Case(accelerations(_release, **HELD), ACCELERATION_NOISE, ("f_mast_Hz",), {}),
    "com_offset": Case(accelerations(_release, **HELD), ACCELERATION_NOISE, ("offset_x_m", "offset_y_m"), {}),
    "sensor_misalignment": Case(
        accelerations(_release), ACCELERATION_NOISE, ("angle_x_rad", "angle_y_rad", "angle_z_rad"), {}
    ),
    "motor_belt": Case(forces(lambda _: pull("longitudinal", 2.0, 4.0)), FORCE_NOISE, ("K_b_N_m",), {}),
    "cable_compliance": Case(forces(lambda _: pull("lateral", 1.0, 2.0)), FORCE_NOISE, ("K_cable_N_m",), {}),
    "load_cell_drift": Case(
        forces(lambda _: pull("longitudinal", 1.0, 16.0)),
        FORCE_NOISE,
        ("zero_drift_N_s", "gain_drift_1_s"),
        {"gain_drift_1_s": 0.01},
    ),
    "stribeck": Case(_fast_drag, FORCE_NOISE, ("kinetic_share",), {}),
    "load_sensitive_friction": Case(
        forces(lambda _: pull("lateral", 2.0, 6.0, height=0.2), **EVEN), FORCE_NOISE, ("exponent",), {}
    ),
    "slip_coupling": Case(forces(_spinning, **EVEN), FORCE_NOISE, ("weight",), {"weight": 0.8}),
    "rolling_resistance": Case(accelerations(_rolling, **EVEN), ACCELERATION_NOISE, ("c_rr",), {}),
    "ground_roughness": Case(accelerations(_rolling, **HELD), ACCELERATION_NOISE, ("height_m",), {}),
    "ground_joints": Case(accelerations(_rolling, **HELD), ACCELERATION_NOISE, ("depth_m",), {}),
    "wheel_eccentricity": Case(accelerations(_rolling, **HELD), ACCELERATION_NOISE, ("eccentricity_m",), {}),
    "coriolis": Case(
        accelerations(lambda robot: swivel(wheel_rates(robot, 0.2, 1.0), 1.0), **EVEN),
        ACCELERATION_NOISE,
        ("share",),
        {"share": 0.8},
    ),
}
SWITCHES = {"translation_coupling", "wheel_lift"}


def test_no_effect_is_passed_over() -> None:
    assert set(CASES) | SWITCHES == set(CATALOGUE)


@pytest.mark.slow
@pytest.mark.parametrize("effect_id", CASES)
def test_the_amplitude_comes_back_within_its_uncertainty(effect_id: str, robot: Robot) -> None:
    outcome = recovered(CATALOGUE[effect_id], CASES[effect_id], robot)
    assert outcome.passed, outcome.figure


@pytest.mark.parametrize("truth", [0.0, 1.0])
def test_the_data_tell_whether_wheels_lift(truth: float, robot: Robot) -> None:
    """A switch: no amplitude to fit."""

    def measure(active: float) -> np.ndarray:
        return simulate(robot, free_response("roll", 4e-3, 0.5), effects={"wheel_lift": {"active": active}})["az"]

    random = np.random.default_rng(5)
    data = measure(truth) + ACCELERATION_NOISE * random.standard_normal(500)
    right, wrong = (((data - measure(a)) ** 2).sum() / ACCELERATION_NOISE**2 for a in (truth, 1.0 - truth))
    assert right < 500 + 5 * np.sqrt(1000)
    assert wrong - right > 20.0


def test_the_data_tell_whether_translation_is_coupled(robot: Robot) -> None:
    """A switch whose off is the linear model of pure rotations; the data come from the simulator."""
    result = simulate(robot.with_changes(**HELD), free_response("roll", 2e-4, 1.0))
    random = np.random.default_rng(6)
    data = result["ay"] + ACCELERATION_NOISE * random.standard_normal(len(result.time))
    coupled = linear_robot(robot)
    stiffness, damping = coupled.stiffness.copy(), coupled.damping.copy()
    for matrix in (stiffness, damping):
        matrix[:3, 3:] = matrix[3:, :3] = 0.0
    costs = []
    sharp = robot.accelerometer.bandwidth_hz  # second-order low-pass: about √2/ω late
    for model in (coupled, LinearRobot(coupled.mass, damping, stiffness)):
        rows = accelerometer_rows(model, robot.accelerometer.position, GRAVITY)
        late = np.maximum(result.time - np.sqrt(2.0) / (2 * np.pi * sharp), 0.0)
        shape = responses(model.state_matrix, rows, late)[:, 1, 3]
        size = shape @ data / (shape @ shape)  # how far it was let go is free
        costs.append(((data - size * shape) ** 2).sum() / ACCELERATION_NOISE**2)
    assert costs[1] - costs[0] > 100.0


def test_a_floor_cannot_be_named_by_its_seed(robot: Robot) -> None:
    """The seed is a name, not a quantity: what neighbouring seeds give is no nearer than what any other gives."""

    def measure(seed: float) -> np.ndarray:
        return simulate(robot.with_changes(**HELD), _rolling(robot), effects={"ground_roughness": {"seed": seed}})["az"]

    course = measure(5.0)
    apart = [np.corrcoef(course, measure(seed))[0, 1] for seed in (4.0, 6.0, 1000.0)]
    assert np.abs(apart).max() < 0.9


def test_a_swivel_shows_the_floor_it_runs_over(robot: Robot) -> None:
    """Waveforms of swivels do not repeat, so features decide: joints stand out at path speed over their pitch."""
    slipping = robot.with_changes(slip_coupling=1.0, lambda_max=0.01)
    for wanted in (1.2, 2.0):
        joints: Effects = {"ground_joints": {"pitch_m": 0.05, "depth_m": 2e-4}}
        turning = swivel(wheel_rates(robot, 0.0, wanted), 12.0)
        result = simulate(slipping, turning, effects=joints, release_drag=1.0)
        part = slice(3000, None)
        course = result["az"][part] - result["az"][part].mean()
        spectrum = np.abs(np.fft.rfft(course * np.hanning(len(course))))
        frequency = np.fft.rfftfreq(len(course), 1e-3)
        v, u, w = (result[name][part] for name in ("vy", "vx", "wz"))
        rates = {round(np.mean(np.hypot(u - w * p[1], v + w * p[0])) / 0.05, 6) for p in robot.contact_points}
        lines = [k * rate for rate in rates for k in (1, 2, 3, 4)]
        away = np.min([np.abs(frequency - line) / line for line in lines], axis=0)
        band = (frequency > 5.0) & (frequency < 25.0)
        strongest = np.argsort(np.where(band, spectrum, 0.0))[::-1][:6]
        assert np.all(away[strongest] < 0.02), frequency[strongest]
        assert np.median(away[band]) > 0.04  # lines are narrow: chance would not hit them six times
