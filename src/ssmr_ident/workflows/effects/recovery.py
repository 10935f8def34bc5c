"""Whether what was put in comes back: simulated with an effect, buried in noise, fitted from a start 30 % off."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2, norm

from ssmr_ident.experiments import EXPERIMENTS, Scenario
from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.robot import Robot
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.rig import simulate_rig
from ssmr_ident.workflows.effects.promises import Outcome, bench_of, scenarios

ACCELERATION_NOISE = 0.02
"""m/s^2, of the reference campaign's accelerometers."""

FORCE_NOISE = 0.5
"""N."""

WRONG = 0.3
KNOWN = 0.1
"""Share of itself to which an amplitude has to be known, for the recovery to say something."""

DRAWS = 2
"""Of noise."""

CHANCE = float(2.0 * norm.sf(3.0))
"""Three standard deviations, for all draws and parameters together."""

HELD: dict[str, float] = {"mu_static": 1e9, "mu_kinetic": 1e9}
"""No contact lets go."""

EVEN: dict[str, float] = {"mu_static": 0.8, "mu_kinetic": 0.8}
"""Coulomb: contacts slide without teeth."""

Effects = dict[str, dict[str, float]]
Measure = Callable[[Robot, Effects], np.ndarray]


@dataclass(frozen=True)
class Case:
    """One recovery: what is measured, the parameters fitted, and values that differ from nominal."""

    measure: Measure
    noise: float
    fitted: tuple[str, ...]
    true: Mapping[str, float] = field(default_factory=dict)


def clearest(effect: Effect, traces: Mapping[str, float]) -> Case | None:
    """The amplitudes in the experiment that shows the effect best, on a rig where it acts on one; None of switches."""
    nominal = effect.values()
    fitted = tuple(
        p.name for p in effect.amplitudes if nominal[p.name] != p.off and {p.off, p.nominal} != {p.lower, p.upper}
    )
    if not fitted or not traces:
        return None
    if effect.rig:
        return Case(decay_of_a_tire, ACCELERATION_NOISE, fitted)
    kind = EXPERIMENTS[max(traces, key=lambda name: traces[name])]
    if kind.of_one_wheel:
        return Case(_on_bench(bench_of(kind)), FORCE_NOISE, fitted)

    def first(robot: Robot) -> Scenario:
        return scenarios(robot, long=False)[kind.name][0]

    if kind.on_a_testing_machine:
        return Case(forces(first, **EVEN), FORCE_NOISE, fitted)
    return Case(accelerations(first, **HELD), ACCELERATION_NOISE, fitted)


def decay_of_a_tire(robot: Robot, effects: Effects) -> np.ndarray:
    """Acceleration of a quarter of the robot on one tire, let go from 3 mm; (1200,) float [m/s^2]."""
    rig = Rig(robot.mass / 4.0, float(robot.damping[1]), float(robot.stiffness[1]))
    return simulate_rig(rig, np.zeros(1200), 1000.0, position=3e-3, effects=effects)[:, 2]


def accelerations(scenario: Callable[[Robot], Scenario], **changes: object) -> Measure:
    """What a changed robot's accelerometer reads, its axes in a row."""

    def measure(robot: Robot, effects: Effects) -> np.ndarray:
        result = simulate(robot.with_changes(**changes), scenario(robot), effects=effects)
        return np.concatenate([result["ax"], result["ay"], result["az"]])

    return measure


def forces(scenario: Callable[[Robot], Scenario], **changes: object) -> Measure:
    """What the load cell of a pull reads, of a changed robot."""

    def measure(robot: Robot, effects: Effects) -> np.ndarray:
        return simulate(robot.with_changes(**changes), scenario(robot), 100.0, effects=effects)["force"]

    return measure


def _on_bench(run: Callable[..., np.ndarray]) -> Measure:
    return lambda robot, effects: run(robot, np.linspace(0.0, 0.012, 240), 0.05, effects=effects)


def recovered(effect: Effect, case: Case, robot: Robot) -> Outcome:
    """Amplitudes come back within their uncertainty, and what is left is the noise."""
    true = effect.values(case.true)
    clean = case.measure(robot, {effect.id: true})
    off = {p.name: p.off for p in effect.parameters}
    scale = np.array([_distance(true[name], off[name]) for name in case.fitted])
    apart, widest, left = 0.0, np.zeros(len(case.fitted)), 0.0
    for seed in range(DRAWS):
        data = clean + case.noise * np.random.default_rng(seed).standard_normal(clean.shape)

        def residual(factors: np.ndarray, data: np.ndarray = data) -> np.ndarray:
            trial = dict(true)
            for name, factor, size in zip(case.fitted, factors, scale, strict=True):
                trial[name] = _placed(off[name], factor, size)
            return np.asarray((case.measure(robot, {effect.id: trial}) - data) / case.noise)

        found = least_squares(residual, np.full(len(case.fitted), 1.0 - WRONG), diff_step=1e-3, x_scale="jac")
        information = found.jac.T @ found.jac
        if np.linalg.matrix_rank(information) < len(case.fitted):
            return Outcome("recovery", False, f"its recording says nothing of some of {', '.join(case.fitted)}")
        widest = np.maximum(widest, np.sqrt(np.diag(np.linalg.inv(information))))
        left = max(left, 2.0 * found.cost / len(data))
        apart += float((found.x - 1.0) @ information @ (found.x - 1.0))
    most = float(chi2.isf(CHANCE, DRAWS * len(case.fitted)))
    passed = bool(np.all(widest < KNOWN)) and left < 1.15 and apart < most
    known = ", ".join(f"{name} to {100.0 * share:.2g} %" for name, share in zip(case.fitted, widest, strict=True))
    return Outcome(
        "recovery", passed, f"{known}; chi-square {apart:.3g}, at most {most:.3g}; {left:.3g} of the noise is left"
    )


def _distance(value: float, off: float | None) -> float:
    """How far from off, in the parameter; the parameter itself where off is infinite."""
    return value if off is None or not np.isfinite(off) else value - off


def _placed(off: float | None, factor: float, size: float) -> float:
    return factor * size + (0.0 if off is None or not np.isfinite(off) else off)
