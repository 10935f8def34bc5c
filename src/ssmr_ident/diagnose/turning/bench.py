"""Simulated runs under the conditions of a campaign, remembered."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ssmr_ident.compare.turning import AXES, turning_robot, with_floor
from ssmr_ident.core.errors import Impossible, SimulationError
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.spectra import Look, average, levels_of, look
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.slots import Effects
from ssmr_ident.simulate.simulation import simulate

RATE = 500.0  # Hz; what folds back from above 450 Hz has passed a sensor of 80 Hz
STEP = 5e-4  # s; frequencies to 2e-4, checked against 1.25e-4 s in the tests
COARSE = 1e-3  # s; 0.2 to 2.4 dB off, most of it alike with and without an effect: for differences of spectra only
Values = Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Run:
    """A simulated condition: its look without noise, and the yaw rate it turns with [rad/s]."""

    look: Look
    yaw_rate: float
    least_load: float


@dataclass(eq=False)
class Bench:
    """Simulates conditions with changed parameters; ``count`` is how often it did, ``work`` how many steps it took."""

    parameters: ParameterSet
    count: int = 0
    work: float = 0.0
    memory: dict[tuple, Run | None] = field(default_factory=dict)

    def run(
        self,
        condition: Condition,
        baseline: Values,
        effects: Effects,
        seeds: tuple[int, ...] = (1,),
        step: float = STEP,
    ) -> Run | None:
        """The average of one run per seed; None where these values make no robot.

        Parameters
        ----------
        condition : Condition
        baseline : mapping of parameter path to value
            In place of the file's.
        effects : mapping of effect id to parameters
        seeds : tuple of int
            Of the floor's grain and of the start.
        step : float [s]
            Of the integration.
        """
        runs = [self._one(condition, baseline, effects, seed, step) for seed in seeds]
        if any(one is None for one in runs):
            return None
        kept = [one for one in runs if one is not None]
        return Run(
            average([one.look for one in kept]),
            float(np.mean([one.yaw_rate for one in kept])),
            min(one.least_load for one in kept),
        )

    def prefetch(self, jobs: Iterable[tuple[Condition, Values, Effects, int]], step: float = STEP) -> None:
        """Run what is not yet remembered, several at a time (the compiled loop leaves the interpreter free)."""
        keyed = {self._key(*job, step): job for job in jobs}
        fresh = {key: job for key, job in keyed.items() if key not in self.memory}
        if fresh:
            self.work += sum((job[0].settling + job[0].duration) / step for job in fresh.values())
            runs = side_by_side(lambda job: self._simulate(*job, step), list(fresh.values()))
            self.memory.update(zip(fresh, runs, strict=True))

    def _one(self, condition: Condition, baseline: Values, effects: Effects, seed: int, step: float) -> Run | None:
        key = self._key(condition, baseline, effects, seed, step)
        if key not in self.memory:
            self.work += (condition.settling + condition.duration) / step
            self.memory[key] = self._simulate(condition, baseline, effects, seed, step)
        return self.memory[key]

    @staticmethod
    def _key(condition: Condition, baseline: Values, effects: Effects, seed: int, step: float) -> tuple:
        named = tuple((name, tuple(sorted(values.items()))) for name, values in sorted(effects.items()))
        return condition.kind, seed, step, tuple(sorted(baseline.items())), named

    def _simulate(
        self, condition: Condition, baseline: Values, effects: Effects, seed: int, step: float = STEP
    ) -> Run | None:
        self.count += 1
        try:
            return measure(simulated(self.parameters, condition, baseline, effects, seed, step), condition, seed)
        except (Impossible, SimulationError):  # a robot that falls over
            return None


def changed(parameters: ParameterSet, values: Values) -> ParameterSet:
    """The parameter set with some numbers replaced."""
    changes = {}
    for path, value in values.items():
        old = parameters.get(path)
        changes[path] = Estimate(float(value)) if old is None else replace(old, value=float(value))
    return parameters.updated(changes)


def simulated(
    parameters: ParameterSet, condition: Condition, baseline: Values, effects: Effects, seed: int, step: float = STEP
):
    """The simulation itself; see ``Bench.run``."""
    now = changed(parameters, baseline)
    active = with_floor(effects, now)
    if "seed" not in effects.get("ground_roughness", {}):
        active["ground_roughness"]["seed"] = float(seed)
    scenario = Scenario(
        condition.experiment.name,
        condition.settling + condition.duration,
        offset={"y": 1e-7 * seed},
        wheel_rates=condition.rates,
        wheel_rate_step=condition.rate_step,
    )
    return simulate(turning_robot(now), scenario, RATE, step, active)


def measure(simulation, condition: Condition, seed: int) -> Run:
    """What the recording's sensor would have seen of a simulation."""
    skip = round(condition.settling * RATE)
    samples = np.column_stack([simulation[name][skip:] for name in condition.names])
    one = look(samples, RATE)
    random = np.random.default_rng(seed)
    levels = levels_of(samples + condition.disturbance * random.standard_normal(samples.shape))
    loads = min(float(simulation[f"load_{i}"][skip:].min()) for i in (1, 2, 3, 4))
    bins = len(condition.mean.frequency)
    seen = replace(one, frequency=one.frequency[:bins], cross=one.cross[:bins], levels=levels)
    return Run(seen, float(simulation["wz"][skip:].mean()), loads)


__all__ = ["AXES", "Bench", "Run", "changed", "measure", "simulated"]
