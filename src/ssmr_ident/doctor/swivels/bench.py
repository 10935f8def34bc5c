"""Simulated runs under the conditions of a campaign, remembered."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ssmr_ident.compare.turning import turning_robot, with_floor
from ssmr_ident.core.errors import Impossible
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.simd import WIDTH
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.spectra import Look, average, levels_of, look
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.slots import Effects
from ssmr_ident.simulate.many import simulate_alike

RATE = 500.0  # Hz; what folds back from above 450 Hz has passed a sensor of 80 Hz
STEP = 5e-4  # s; frequencies to 2e-4, checked against 1.25e-4 s in the tests
Values = Mapping[str, float]
Job = tuple[Condition, Values, Effects, int]
"""Condition, baseline's parameters, effects, seed of floor and start."""

LOADS = ("load_1", "load_2", "load_3", "load_4")


@dataclass(frozen=True, eq=False)
class Run:
    """A simulated condition: its look without noise, and the yaw rate it turns with [rad/s]."""

    look: Look
    yaw_rate: float
    least_load: float


@dataclass(eq=False)
class Bench:
    """Simulates conditions with changed parameters, each once."""

    parameters: ParameterSet
    memory: dict[tuple, Run | None] = field(default_factory=dict)

    def run(
        self,
        condition: Condition,
        baseline: Values,
        effects: Effects,
        seeds: tuple[int, ...] = (1,),
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
        """
        runs = [self._one(condition, baseline, effects, seed) for seed in seeds]
        if any(one is None for one in runs):
            return None
        kept = [one for one in runs if one is not None]
        return Run(
            average([one.look for one in kept]),
            float(np.mean([one.yaw_rate for one in kept])),
            min(one.least_load for one in kept),
        )

    def prefetch(self, jobs: Iterable[Job]) -> None:
        """Run what is not yet remembered, what is alike in lanes (the compiled loop leaves the interpreter free)."""
        keyed = {self._key(*job): job for job in jobs}
        fresh = {key: job for key, job in keyed.items() if key not in self.memory}
        groups: dict[tuple, list[tuple]] = {}
        for key, (condition, _, effects, _) in fresh.items():
            groups.setdefault((condition.kind, tuple(sorted(effects))), []).append(key)
        parts = [keys[k : k + WIDTH] for keys in groups.values() for k in range(0, len(keys), WIDTH)]
        asked = [[fresh[key] for key in part] for part in parts]
        for part, runs in zip(parts, side_by_side(self._simulate, asked), strict=True):
            self.memory.update(zip(part, runs, strict=True))

    def _one(self, condition: Condition, baseline: Values, effects: Effects, seed: int) -> Run | None:
        key = self._key(condition, baseline, effects, seed)
        if key not in self.memory:
            (self.memory[key],) = self._simulate([(condition, baseline, effects, seed)])
        return self.memory[key]

    @staticmethod
    def _key(condition: Condition, baseline: Values, effects: Effects, seed: int) -> tuple:
        named = tuple((name, tuple(sorted(values.items()))) for name, values in sorted(effects.items()))
        return condition.kind, seed, tuple(sorted(baseline.items())), named

    def _simulate(self, jobs: Sequence[Job]) -> list[Run | None]:
        """Runs under one condition; None of a robot that falls over."""
        condition = jobs[0][0]
        seen = _seen(condition)
        made = [_scenario(self.parameters, *job) for job in jobs]
        there = [one for one in made if one is not None]
        ran = iter(simulate_alike(there, RATE, STEP, seen) if there else ())
        found: list[Run | None] = []
        for one, (*_, seed) in zip(made, jobs, strict=True):
            out = {} if one is None else dict(zip(seen, next(ran).T, strict=True))
            found.append(measure(out, condition, seed) if out and np.isfinite(out["wz"][0]) else None)
        return found


def _seen(condition: Condition) -> tuple[str, ...]:
    """Channels that are looked at."""
    return tuple(dict.fromkeys((*condition.names, "wz", *LOADS)))


def changed(parameters: ParameterSet, values: Values) -> ParameterSet:
    """The parameter set with some numbers replaced."""
    changes = {}
    for path, value in values.items():
        old = parameters.get(path)
        changes[path] = Estimate(float(value)) if old is None else replace(old, value=float(value))
    return parameters.updated(changes)


def _scenario(
    parameters: ParameterSet, condition: Condition, baseline: Values, effects: Effects, seed: int
) -> tuple[Robot, Effects, Scenario] | None:
    """What is simulated; None where the values make no robot."""
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
    try:
        return turning_robot(now), active, scenario
    except Impossible:
        return None


def measure(simulation: Mapping[str, np.ndarray], condition: Condition, seed: int) -> Run:
    """What the recording's sensor would have seen of a simulation, by its channels."""
    skip = round(condition.settling * RATE)
    samples = np.column_stack([simulation[name][skip:] for name in condition.names])
    one = look(samples, RATE)
    random = np.random.default_rng(seed)
    levels = levels_of(samples + condition.disturbance * random.standard_normal(samples.shape))
    loads = min(float(simulation[name][skip:].min()) for name in LOADS)
    bins = len(condition.mean.frequency)
    seen = replace(one, frequency=one.frequency[:bins], cross=one.cross[:bins], levels=levels)
    return Run(seen, float(simulation["wz"][skip:].mean()), loads)
