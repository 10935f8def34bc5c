"""The baseline at its best, and how recordings are predicted from it with calibration recordings as an anchor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.compare.turning import FLOOR_HEIGHT, turning_robot
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.doctor.swivels.bench import Bench, Run
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.likelihood import Block, Score, log_variance, score
from ssmr_ident.physics.robot import SLIDING_SPEED
from ssmr_ident.physics.slots import Effects

SEEDS = (1, 2)
ZERO_STD = 0.13  # m/s^2 between two logs of one sensor: 0.02 V at 0.15 V s^2/m
EXTREME_STD = 0.02
MODEL_EXTREME_STD = 0.15  # of extremes that no calibration recording anchors
YAW_STD = 0.03
WIDE = 0.6  # standard deviation of the logarithm of what the file does not know
FITTED = (
    "tire.sliding_speed_m_s", "floor.height_m", "tire.mu_static", "tire.mu_kinetic",
    "tire.stiffness_x_N_m", "tire.stiffness_y_N_m", "tire.stiffness_z_N_m",
    "tire.damping_x_N_s_m", "tire.damping_y_N_s_m", "tire.damping_z_N_s_m",
    "inertia_kg_m2.xx", "inertia_kg_m2.yy", "inertia_kg_m2.zz",
)  # fmt: skip


@dataclass(frozen=True)
class Prior:
    """Log-normal: the file's value, and the standard deviation of its logarithm."""

    path: str
    value: float
    std: float


def priors_of(parameters: ParameterSet) -> tuple[Prior, ...]:
    """What the file knows of the parameters that a swivel depends on, wide where it does not say."""
    found = []
    relay = turning_robot(parameters).sliding_speed == 0.0  # which knows no speed of sliding
    defaults = {"tire.sliding_speed_m_s": SLIDING_SPEED, "floor.height_m": FLOOR_HEIGHT}
    for path in FITTED:
        if relay and path == "tire.sliding_speed_m_s":
            continue
        known = parameters.get(path)
        if known is None and path in defaults:
            found.append(Prior(path, defaults[path], WIDE))
        elif known is not None and not known.fixed and float(known.value) > 0.0:
            value = float(known.value)
            std = WIDE if known.std is None else min(float(known.std) / value, WIDE)
            if std > 0.0:
                found.append(Prior(path, value, std))
    return tuple(found)


def stiffness_known(parameters: ParameterSet) -> bool:
    """Whether the file knows any stiffness of the tires: a standard deviation of it, or that it is fixed."""
    every = (parameters.get(path) for path in FITTED if path.startswith("tire.stiffness_"))
    return any(one is not None and (one.fixed or one.std is not None) for one in every)


def values_at(priors: tuple[Prior, ...], z: np.ndarray) -> dict[str, float]:
    """Parameters at ``z`` standard deviations from the priors; friction never rises with speed."""
    values = {p.path: p.value * float(np.exp(p.std * shift)) for p, shift in zip(priors, z, strict=True)}
    if "tire.mu_kinetic" in values and "tire.mu_static" in values:
        values["tire.mu_kinetic"] = min(values["tire.mu_kinetic"], values["tire.mu_static"])
    return values


@dataclass(frozen=True, eq=False)
class Anchor:
    """A fitted baseline, and by how much it misses each calibration condition.

    Parameters
    ----------
    bench : Bench
    scale : (c,) float [m/s^2]
    priors, z : tuple of Prior, (p,) float
    calibration : tuple of Condition
        Empty where the baseline was fitted on the targets.
    fit : Score
        On what it was fitted on.
    """

    bench: Bench
    scale: np.ndarray
    priors: tuple[Prior, ...]
    z: np.ndarray
    calibration: tuple[Condition, ...]
    fit: Score
    seeds: tuple[int, ...] = SEEDS
    shares: tuple[float, ...] = field(default=(1.0, 0.5, 0.0))
    fixed: Mapping[str, float] = field(default_factory=dict)

    def log_prior(self) -> float:
        return -0.5 * float(self.z @ self.z)

    def at(self, z: np.ndarray) -> dict[str, float]:
        """Parameters at ``z`` standard deviations from the priors, and those that are held elsewhere."""
        return {**values_at(self.priors, z), **self.fixed}

    @property
    def values(self) -> dict[str, float]:
        return self.at(self.z)

    def log_density(self, run: Run, condition: Condition) -> np.ndarray:
        return run.look.log_density(self.scale, condition.noise)

    def missed(
        self, condition: Condition, seeds: tuple[int, ...]
    ) -> tuple[np.ndarray, np.ndarray, float, np.ndarray] | None:
        """By how much calibration lies above the baseline at this condition's speed, between the nearest speeds.

        Returns
        -------
        (k, m) float, (s,) float, float, (s,) float
            Of log densities, of levels, and the variances of both that come from the calibration recordings; None
            without any.
        """
        known = [c for c in self.calibration if c.names == condition.names and c.experiment == condition.experiment]
        if not known:
            return None
        weights = between(np.array([abs(c.turning) for c in known]), abs(condition.turning))
        densities, levels, variance, spread = 0.0, 0.0, 0.0, 0.0
        for c, weight in zip(known, weights, strict=True):
            if weight == 0.0:
                continue
            run = self.bench.run(c, self.values, {}, seeds)
            assert run is not None
            densities = densities + weight * (c.mean.log_density(self.scale) - self.log_density(run, c))
            levels = levels + weight * (c.mean.levels - run.look.levels)
            variance += weight**2 * (log_variance(c.mean.dof) + c.wander)
            spread = spread + weight**2 * c.mean.level_variance
        return np.asarray(densities), np.asarray(levels), variance, np.asarray(spread)

    def at_calibrated_speed(self, condition: Condition) -> bool:
        return any(np.isclose(abs(c.turning), abs(condition.turning), rtol=1e-3) for c in self.calibration)

    def blocks(
        self,
        conditions: tuple[Condition, ...],
        effects: Effects,
        share: float,
    ) -> list[Block] | None:
        """Measured less predicted, with ``share`` of what the baseline misses carried over; None where nothing runs."""
        result = [self._block(condition, effects, share, self.seeds) for condition in conditions]
        there = [block for block in result if block is not None]
        return there if len(there) == len(result) else None

    def alternatives(
        self,
        conditions: tuple[Condition, ...],
        effects: Effects,
        share: float,
    ) -> list[list[Block]] | None:
        """Of each condition the block by the mean over all floors, and by each of several floors alone."""
        result = []
        several = [self.seeds, *((seed,) for seed in self.seeds)] if len(self.seeds) > 1 else [self.seeds]
        for condition in conditions:
            blocks = [self._block(condition, effects, share, seeds) for seeds in several]
            there = [block for block in blocks if block is not None]
            if len(there) < len(blocks):
                return None
            result.append(there)
        return result

    def _block(
        self,
        condition: Condition,
        effects: Effects,
        share: float,
        seeds: tuple[int, ...],
    ) -> Block | None:
        run = self.bench.run(condition, self.values, effects, seeds)
        if run is None:
            return None
        measured, predicted = condition.mean.log_density(self.scale), self.log_density(run, condition)
        missed = self.missed(condition, seeds)
        variance = log_variance(condition.mean.dof) + condition.wander
        level = condition.mean.levels - run.look.levels
        channels = len(condition.names)
        floor = np.concatenate([np.full(channels, ZERO_STD**2), np.full(2 * channels, EXTREME_STD**2)])
        level_variance = condition.mean.level_variance + floor
        if missed is None:
            level_variance = level_variance + np.concatenate(
                [np.zeros(channels), np.full(2 * channels, MODEL_EXTREME_STD**2)]
            )
            share = 0.0
        else:
            level = level - missed[1]
            level_variance = level_variance + missed[3] + floor
            predicted = predicted + share * missed[0]
            variance += share**2 * missed[2]
        if effects or missed is None or not self.at_calibrated_speed(condition):
            variance += log_variance(run.look.dof) * (1.0 if missed is None else 1.0 + share**2)
            level_variance = level_variance + run.look.level_variance
        if condition.yaw_rate is not None and condition.yaw_rate * run.yaw_rate > 0.0:
            level = np.append(level, np.log(condition.yaw_rate / run.yaw_rate))
            level_variance = np.append(level_variance, YAW_STD**2)
        return Block((measured - predicted).ravel(), variance, level, level_variance)

    def score(self, conditions: tuple[Condition, ...], effects: Effects) -> tuple[Score, float] | None:
        """The best share to carry over, and the score with it."""
        best: tuple[Score, float] | None = None
        shares = self.shares if self.calibration else (0.0,)
        if not effects and self.calibration:
            shares = (1.0,)
        for share in shares:
            asked = self.alternatives(conditions, effects, share)
            if asked is None:
                return None
            found = score(asked)
            if best is None or found.log_likelihood > best[0].log_likelihood:
                best = (found, share)
        return best


def between(positions: np.ndarray, wanted: float) -> np.ndarray:
    """Weights of linear interpolation at ``wanted`` between known positions, the nearest one beyond their ends."""
    order = np.argsort(positions)
    weights = np.zeros(len(positions))
    low, high = positions[order[0]], positions[order[-1]]
    clipped = float(np.clip(wanted, low, high))
    for j in range(len(order)):
        unit = np.zeros(len(order))
        unit[j] = 1.0
        weights[order[j]] = np.interp(clipped, positions[order], unit)
    same = np.isclose(positions, wanted, rtol=1e-3)
    return same / same.sum() if same.any() else weights


def scale_of(conditions: tuple[Condition, ...]) -> np.ndarray:
    """Rms of each channel within the band over all conditions, (c,) float [m/s^2]."""
    power = [np.einsum("kii->i", c.mean.cross) for c in conditions]
    return np.sqrt(np.mean(power, axis=0))
