"""A motor with gears: its torque, its controller, friction by load, and slopes of the fit that holds them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ssmr_ident.doctor.laws import simpler
from ssmr_ident.doctor.table import row_of
from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.motor import Given
from ssmr_ident.estimate.node import Member, Node
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.simulated import Compiled, simulate
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.voltage_drive import Controller, Course, VoltageDrive
from ssmr_ident.simulate.rig import simulate_rig

RIG = Rig(0.008, 0.004, 0.5, rotary=True)
MOTOR = VoltageDrive(0.02, 2.5, 2e-6, 20.0)
RATE = 200.0
GEARS = {"F_c_N": 0.01, "c": 0.25, "rounding_m_s": 0.05}
SINE = {"nonlinear_stiffness": {"k3_N_m3": 0.0, "sine_share": 1.0}}


def _course(seconds: float, controller: Controller | None) -> Course:
    time = np.arange(round(seconds * RATE)) / RATE
    signal = (0.9 if controller else 3.0) * np.sin(2.0 * np.pi * 0.6 * time)
    return Course(signal, (time < 0.8 * seconds).astype(float), controller)


@pytest.mark.parametrize("controller", [None, Controller(3.0, 1.2)])
def test_a_motors_angle_is_that_of_its_equation(controller: Controller | None) -> None:
    """J x'' = kt (u - kt n x') n/R - D x' - m g l sin x, none of it once the motor is open, by another integrator."""
    course = _course(3.0, controller)
    time = np.arange(len(course.signal)) / RATE
    found = simulate_rig(RIG, np.zeros(len(time)), RATE, 0.2, 0.0, 16, effects=SINE, motor=MOTOR, course=course)
    inertia = RIG.mass + 20.0**2 * 2e-6

    def rate(t: float, s: np.ndarray) -> list[float]:
        x, v = s
        volts = float(np.interp(t, time, course.signal))
        if controller is not None:
            volts = min(max(controller.gain * (volts - x), -controller.limit), controller.limit)
        current = (volts - 0.02 * 20.0 * v) / 2.5 * float(np.interp(t, time, course.on))
        return [v, (20.0 * 0.02 * current - RIG.damping * v - RIG.stiffness * math.sin(x)) / inertia]

    exact = solve_ivp(rate, (0.0, time[-1]), [0.2, 0.0], t_eval=time, max_step=1e-3, rtol=1e-8, atol=1e-10).y[0]
    assert np.abs(found[:, 0] - exact).max() < 1e-4 * np.ptp(exact)


def _problem(controller: Controller | None) -> tuple[Problem, Node, np.ndarray, Piece]:
    every, n = 4, 300
    time = np.arange(n) / RATE
    at = np.arange(n * every + 1) / every
    course = _course(n / RATE, controller)
    signal, on = (np.interp(at, np.arange(n), x) for x in (course.signal, course.on))
    held = controller or Controller(0.0)
    given = Given(signal, on, held.gain, held.limit, 1.0)
    piece = Piece(
        "a", 0, ("angle", "angular_rate"), np.array([0, 1]), time, np.zeros((n, 2)), np.ones((n, 2), dtype=bool),
        np.zeros(n * every + 1), False, True, 1.0 / (RATE * every), every, np.ones(2), motor=given,
    )  # fmt: skip
    values = (RIG.mass, RIG.damping, RIG.stiffness, MOTOR.constant, MOTOR.resistance, MOTOR.armature, MOTOR.ratio)
    baseline = tuple(Coordinate(f"p{k}", value) for k, value in enumerate(values))
    moved = tuple(Coordinate(name, value) for name, value in GEARS.items())
    law = Member("load_dependent_friction", "static_force", "tanh", moved, law={})
    sine = Member("nonlinear_stiffness", "static_force", "sine", (Coordinate("sine_share", 1.0),), law={"k3_N_m3": 0.0})
    node = Node(baseline, (law, sine))
    return Problem((piece,), baseline, (), 1.3, 0.3), node, np.ones(len(node.coordinates)), piece


@pytest.mark.slow
@pytest.mark.parametrize("controller", [None, Controller(3.0, 1.2)])
def test_the_fit_has_the_simulators_motion_and_its_slopes(controller: Controller | None) -> None:
    problem, node, point, piece = _problem(controller)
    start = np.array([[0.2, 0.1]])
    borders = np.array([0, len(piece.y)])

    def run(at: np.ndarray, begun: np.ndarray = start, zero: float = 0.0) -> np.ndarray:
        (found,) = simulate(Compiled.of(problem, node, at, [piece]), [begun], [borders], [zero])
        return found.y

    (one,) = simulate(Compiled.of(problem, node, point, [piece]), [start], [borders], [0.0])
    effects = {"load_dependent_friction": GEARS, **SINE}
    course = _course(len(piece.y) / RATE, controller)
    own = simulate_rig(RIG, np.zeros(len(piece.y)), RATE, 0.2, 0.1, 4, effects=effects, motor=MOTOR, course=course)
    assert np.abs(one.y - own[:, :2])[:-1].max(axis=0) == pytest.approx(0.0, abs=2e-3)
    for k, name in enumerate([*(c.name for c in node.coordinates), "zero"]):
        if name in ("p6",):  # a gear ratio is known exactly
            continue
        step = 1e-2  # where a step begins to count as near rest, motion jumps by 1e-5 of its size
        if name == "zero":
            apart = (run(point, zero=step) - run(point, zero=-step)) / (2.0 * step)
        else:
            aside = np.eye(len(point))[k] * step
            apart = (run(point + aside) - run(point - aside)) / (2.0 * step)
        size = np.abs(apart).max(axis=0)
        assert np.abs(one.dy[:, :, 2 + k] - apart).max(axis=0) == pytest.approx(0.0, abs=0.02 * size.max()), name


@pytest.mark.parametrize(("std", "name"), [(0.1, "load_dependent_friction"), (1.0, "dry_friction")])
def test_friction_in_which_no_load_is_seen_is_dry(std: float, name: str) -> None:
    problem, node, point, piece = _problem(None)
    covariance = np.diag([std**2 if c.name == "c" else 1e-6 for c in node.coordinates])
    fit = Fit(node, point, (np.zeros(2),), covariance, (np.zeros(piece.y.shape),), 600.0, 0.0, 5.0)
    assert row_of(fit, problem).ids == (name, "nonlinear_stiffness")
    (dry,) = [n for n in simpler(node) if n.members[0].id == "dry_friction"]
    assert [c.name for c in dry.members[0].coordinates] == ["F_c_N", "rounding_m_s"]
    assert (dry.members[0].variable, dry.members[1]) == ("v", node.members[1])
