"""The plant against closed forms: it shares no law with the simulator, so both may be wrong in their own ways."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.identify.decays.fit import fit_decay
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.robot import GRAVITY
from ssmr_proof.lab.pulls import hook
from ssmr_proof.lab.robots import draw_robot
from ssmr_proof.plant.rig_bench import STEP, RigPlant, drive
from ssmr_proof.plant.robot_bench import DECAY_STEP, PULL_STEP, Bench, Plant, Push
from ssmr_proof.plant.robot_model import Frame, platform
from ssmr_proof.plant.sensing import Chain
from ssmr_proof.plant.spring_laws import HIDDEN, advance, beside, law_vector

ROBOT = draw_robot(np.random.default_rng(3)).robot


def _work(amplitude: float, cycles: int = 3, samples: int = 4000, **laws: float) -> float:
    """Energy that a law takes per slow cycle between ± amplitude [J], of the last cycle."""
    vector, hidden = law_vector(**laws), np.zeros(HIDDEN)
    way = amplitude * np.sin(2.0 * np.pi * np.linspace(0.0, cycles, samples * cycles + 1))
    force = []
    for s in way:
        advance(s, hidden, 1e-3, True, vector)
        force.append(beside(s, 0.0, 0.0, hidden, 2e4, 50.0, 1.0, 1.0, True, vector))
    last = slice(samples * (cycles - 1), None)
    return float(np.trapezoid(np.array(force)[last], way[last]))


def test_a_rig_rings_as_its_closed_form_says() -> None:
    rig = RigPlant(8.0, 2e4, 60.0)
    step_force = np.full(20000, 10.0)
    t = np.arange(20000) * STEP
    rate, omega = 60.0 / 16.0, np.sqrt(2e4 / 8.0 - (60.0 / 16.0) ** 2)
    exact = 10.0 / 2e4 * (1.0 - np.exp(-rate * t) * (np.cos(omega * t) + rate / omega * np.sin(omega * t)))
    position = drive(rig, step_force)[:, 0]
    assert np.abs(position - exact).max() < 5e-3 * exact.max()


@pytest.mark.slow
def test_a_second_mass_splits_the_line_where_two_masses_do() -> None:
    """Undamped frequencies from the 2 x 2 eigenvalue problem, against the peaks of the free vibration's spectrum."""
    share, hertz = 0.1, 8.0
    rig = RigPlant(8.0, 2e4, 2.0, absorber=(share * 8.0, hertz, 0.0))
    force = np.zeros(200_000)
    force[:50] = 1000.0
    spectrum = np.abs(np.fft.rfft(drive(rig, force)[:, 0] * np.hanning(len(force))))
    frequency = np.fft.rfftfreq(len(force), STEP)
    k2 = share * 8.0 * (2.0 * np.pi * hertz) ** 2
    stiffness, mass = np.array([[2e4 + k2, -k2], [-k2, k2]]), np.diag([7.2, 0.8])
    expected = np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real) / (2.0 * np.pi)
    for line in expected:
        near = np.abs(frequency - line) < 0.5
        assert frequency[near][np.argmax(spectrum[near])] == pytest.approx(line, abs=0.06)


def test_what_friction_and_loops_take_per_cycle() -> None:
    """A slider behind a spring: 4 F (A - F/k). Bouc-Wen: the area between the tanh of loading and the straight
    unloading, by quadrature of its own equation."""
    force, k, amplitude = 1.0, 3e5, 5e-4
    slider = _work(amplitude, friction=force, friction_stiffness=k)
    assert slider == pytest.approx(4.0 * force * (amplitude - force / k), rel=2e-3)
    dahl = _work(amplitude, friction=force, friction_stiffness=k, dahl=1.0)
    assert dahl == pytest.approx(4.0 * force * (amplitude - force / k), rel=1e-2)  # up to the rounding of its corners
    # a fast motion goes many times F/k in a step, and has the same friction
    for kind in (0.0, 1.0):
        fast = _work(20 * amplitude, samples=400, friction=force, friction_stiffness=k, dahl=kind)
        assert fast == pytest.approx(4.0 * force * 20 * amplitude, rel=1e-2)
    share, y = 0.2, 1e-4  # yields long before ± amplitude: z = y to 1e-4, elastic over y on the way back, then tanh
    grown = np.linspace(0.0, 2.0 * amplitude - y, 20001)
    loading = y * np.tanh(grown / y)
    area = 2.0 * (np.trapezoid(loading, grown) - 0.5 * y**2) * share * 2e4
    assert _work(amplitude, loop_share=share, loop_yield=y) == pytest.approx(area, rel=1e-2)
    for laws in ({"cubic": 1e9}, {"knee": 2e-4, "knee_share": 0.3}, {"gap": 2e-4, "gap_share_x": 1.0}):
        assert abs(_work(amplitude, **laws)) < 1e-12  # springs give back what they took


def test_a_decay_has_the_robots_natural_frequencies() -> None:
    bench = Bench(Plant(ROBOT), DECAY_STEP)
    modes = linear_robot(ROBOT).modes()[:, 0] / (2.0 * np.pi)
    log, loads = bench.decay(Push((0.0, 0.0, 0.0), (0.0, 0.0, 4.0)), 4.0)
    signal = log[::5, 1:2] + 1e-4 * np.random.default_rng(1).normal(size=(len(log[::5]), 1))
    fit = fit_decay(np.arange(len(signal)) * 5 * DECAY_STEP, signal, start_s=0.005, mains_hz=None, modes=1)
    assert np.abs(modes / (fit.modes[0].omega_n / (2.0 * np.pi)) - 1.0).min() < 0.01  # yaw
    assert loads.min() > 0.0
    assert log[-1] == pytest.approx([0.0, 0.0, GRAVITY], abs=0.02)


def test_a_sliding_robot_pulls_with_mu_m_g_and_one_pair_with_half() -> None:
    bench = Bench(Plant(ROBOT), PULL_STEP, hook(ROBOT, True, 0.05))
    weight = ROBOT.mu_static * ROBOT.mass * GRAVITY
    whole = bench.pull(True, 2e-3, 4.5, (1, 2, 3, 4), 0.0, 100.0)
    assert whole[-50:].mean() == pytest.approx(weight, rel=2e-3)
    left, right = (bench.pull(True, 2e-3, 4.0, wheels, 0.0, 100.0)[-50:].mean() for wheels in ((1, 2), (3, 4)))
    # the cable's height h presses the side that it pulls at: F = mu (m g/2 ± F h/2c)
    lever = ROBOT.mu_static * 0.05 / (2.0 * ROBOT.half_track)
    assert left == pytest.approx(0.5 * weight / (1.0 - lever), rel=5e-3)
    assert right == pytest.approx(0.5 * weight / (1.0 + lever), rel=5e-3)


def test_pushed_hard_a_wheel_leaves_the_floor() -> None:
    bench = Bench(Plant(ROBOT), DECAY_STEP)
    soft, hard = (bench.decay(Push((0.0, f, 0.0), (-0.5 * f, 0.0, 0.0)), 0.5)[1].min() for f in (40.0, 110.0))
    assert soft > 0.0
    assert hard == 0.0


def test_with_its_frame_locked_the_robot_is_the_robot() -> None:
    frame = Frame("rod", 9.0, 2.5, 0.33, 0.03)
    mass, centre, inertia = platform(ROBOT, frame)
    place = np.array([0.0, 0.0, 0.33])
    assert mass + 2.5 == pytest.approx(ROBOT.mass, rel=1e-14)
    assert mass * centre + 2.5 * place == pytest.approx(np.zeros(3), abs=1e-13)
    steiner = mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    steiner += 2.5 * (place @ place * np.eye(3) - np.outer(place, place))
    assert inertia + steiner == pytest.approx(ROBOT.inertia, abs=1e-12)


def test_a_sensor_halves_the_power_at_its_bandwidth() -> None:
    t = np.arange(100_000) / 1e4
    chain = Chain(0.0, bandwidth_hz=30.0)
    passed = chain.clean(np.sin(2.0 * np.pi * 30.0 * t), 1e4, 1)
    assert passed[20_000:].std() == pytest.approx(0.5, rel=1e-3)  # 1/√2 of the amplitude 1, whose rms is 1/√2
