"""How long an integration step may be."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.slots import MAST_HZ

FREQUENCY_ERROR = 1e-5
"""Relative error of the fastest vibration's frequency that a step may make; decays are identified to 1e-4."""
TIME_CONSTANT_SHARE = 0.1
"""Share of the shortest decay time (a damper on its mass) that a step may be."""
LONGEST, SHORTEST = 2e-4, 5e-6  # s


@dataclass(frozen=True)
class StepChoice(Shown):
    """A step and what limits it.

    Parameters
    ----------
    step : float [s]
    fastest : float [rad/s]
        Fastest vibration, of the robot on its tires or of what is attached to it.
    shortest : float [s]
        Shortest decay time.
    error : float
        Relative frequency error at this step, (omega h)²/24 of the leapfrog.
    """

    step: float
    fastest: float
    shortest: float
    error: float

    def __str__(self) -> str:
        return (
            f"step {self.step:.3g} s: fastest vibration {self.fastest / (2 * math.pi):.3g} Hz, shortest decay time "
            f"{self.shortest:.3g} s, frequency error {self.error:.2g}"
        )


def choose_step(robot: Robot, scenario: Scenario, e: np.ndarray) -> StepChoice:
    """The longest step that keeps the leapfrog's error estimate within its limits.

    Parameters
    ----------
    robot : Robot
    scenario : Scenario
    e : (SLOTS,) float
        Effects. Those with states of their own (friction, loops, relaxation) are advanced exactly and ask for nothing.
    """
    linear = linear_robot(robot)
    values = np.linalg.eigvals(linear.state_matrix)
    fastest = float(np.abs(values).max())
    decay_rates = [float(np.abs(values.real).max())]
    if math.isfinite(e[MAST_HZ]):
        fastest = max(fastest, 2.0 * math.pi * float(e[MAST_HZ]))
    if scenario.pulled:
        stiffness = scenario.cable_stiffness or robot.cable_stiffness
        damping = robot.cable_damping if scenario.cable_damping is None else scenario.cable_damping
        fastest = max(fastest, math.sqrt(stiffness / robot.mass))
        decay_rates.append(damping / robot.mass)
    # a contact that lets go runs off within D/K
    decay_rates += [k / d for k, d in zip(robot.stiffness[:2], robot.damping[:2], strict=True) if d > 0.0]
    shortest = 1.0 / max(decay_rates)
    step = min(LONGEST, math.sqrt(24.0 * FREQUENCY_ERROR) / fastest, TIME_CONSTANT_SHARE * shortest)
    step = max(step, SHORTEST)
    return StepChoice(step, fastest, shortest, (fastest * step) ** 2 / 24.0)
