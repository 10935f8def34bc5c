"""What the load cell reads when a head pulls on a robot, a block or a wheel, as the simulator has it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments import PULL, Scenario
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.pull import cable_properties, fixture_needed
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.trials.trial import Array, Values
from ssmr_ident.physics.rig import Block, block_from_parameters
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.slots import Effects
from ssmr_ident.session import Entry
from ssmr_ident.simulate.bench import load_wheel, pull_block
from ssmr_ident.simulate.many import simulate_alike
from ssmr_ident.simulate.simulation import simulate

Head = tuple[Values, Effects, Array]
Forces = Callable[[Sequence[Head], float, float | None], Array]
"""``forces(asked, step, inner)``: what the load cell reads for each (values, effects, head), (k, n) [N], NaN where that
cannot be simulated; ``inner`` is the longest step of the integration, None for the simulator's own choice."""

QUICK = 2e-3
"""Integration step of fits [s]: averages of a pull without teeth then differ by 0.01 to 0.12 N rms from those at the
simulator's own choice (the body's swing after the start), of a dragged wheel by less than 0.1 N; a load cell's noise is
some 0.5 N."""

DAMPINGS = "tire.damping_"

SPINNING_STEP = 5e-4
"""The same where wheels spin, whose grip (4.12) changes with their slip: 2 ms would leave up to 0.8 N and a mean of
2 N, this leaves less than 0.1 N."""


def force_model(
    measurement: Measurement, parameters: ParameterSet, held: bool = False, unseen: tuple[str, ...] = ()
) -> Forces:
    """The simulator of a recording's experiment; ``held`` says that a dragged wheel does not let go, and ``unseen``
    which parameters a pull stays as the file has them in."""
    if "tire.stiffness_y_N_m" not in parameters:
        block = block_from_parameters(parameters)
        return _each(lambda values, effects, head, step, inner: pull_block(_block(block, values), head, step, effects))
    builder = RobotBuilder.of(parameters)
    experiment, entry = measurement.experiment, measurement.entry
    if experiment.of_one_wheel:
        free = entry.free_normal and not held
        return _each(
            lambda values, effects, head, step, inner: load_wheel(
                builder(values), experiment, head, step, free, effects, inner
            )
        )

    dampings = {name: parameters.number(name) for name in parameters if name.startswith(DAMPINGS)}

    def pulled(asked: Sequence[Head], step: float, inner: float | None) -> Array:
        pulls = []
        for values, effects, head in asked:
            seen = dampings | {name: value for name, value in values.items() if name not in unseen}
            seen = {name: _passive(name, value) for name, value in seen.items()}
            pulls.append((builder(seen), effects, _scenario(entry, head, step)))
        if inner is None:  # each has a step of its own
            return np.array([_by_its_own_step(*one, step) for one in pulls])
        longest = min(inner, SPINNING_STEP) if entry.wheel_rate_rad_s else inner
        return simulate_alike(pulls, 1.0 / step, longest, ("force",))[:, :, 0]

    return pulled


def _passive(name: str, value: float) -> float:
    """A tire's value, its damping at least none: decays may ask for less, and a robot that slides on it runs away."""
    return max(value, 0.0) if name.startswith(DAMPINGS) else value


def _by_its_own_step(robot: Robot, effects: Effects, scenario: Scenario, step: float) -> Array:
    try:
        return simulate(robot, scenario, 1.0 / step, effects=effects)["force"]
    except SimulationError:
        return np.full(len(scenario.head), np.nan)


def _each(force: Callable[[Values, Effects, Array, float, float | None], Array]) -> Forces:
    """Experiments that are quick, one after the other."""

    def forces(asked: Sequence[Head], step: float, inner: float | None) -> Array:
        found = []
        for values, effects, head in asked:
            try:
                found.append(force(values, effects, head, step, inner))
            except SimulationError:
                found.append(np.full(len(head), np.nan))
        return np.array(found)

    return forces


def _scenario(entry: Entry, head: Array, step: float) -> Scenario:
    stiffness, damping = cable_properties(entry.cable)
    rate = entry.wheel_rate_rad_s or 0.0
    return Scenario(
        PULL.name,
        len(head) * step,
        head=head,
        head_step=step,
        direction=entry.direction or "lateral",
        height=0.05 if entry.height_m is None else entry.height_m,
        wheels_gripping=entry.wheels_gripping,
        cable_stiffness=stiffness,
        cable_damping=damping,
        wheel_rates=np.full((1, 2), rate),
        held=fixture_needed(entry.wheels_gripping, rate),
    )


def _block(nominal: Block, values: Values) -> Block:
    mu_static = values.get("mu_static", nominal.mu_static)
    return Block(
        values.get("mass_kg", nominal.mass),
        mu_static,
        values.get("mu_kinetic", mu_static if nominal.mu_kinetic == nominal.mu_static else nominal.mu_kinetic),
        values.get("cable.stiffness_N_m", nominal.cable_stiffness),
        nominal.cable_damping,
    )
