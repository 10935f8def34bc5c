"""Baseline and effect fitted together by an ensemble: what many runs about one place say of all parameters at once.

Spectra of stick-slip are no smooth functions of the parameters: a slope taken between two runs is half chance. Here
slopes are a regression over pairs of runs drawn on both sides of a place, every parameter of every run at another
value; what chance adds to their squares is known from what the regression leaves, and is taken off again, so that
steps and standard deviations are not those of chance. Steps are Gauss-Newton's, no longer than the draws reach, and
taken where they help on floors that the slopes have not seen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ssmr_ident.doctor.swivels.anchor import Anchor
from ssmr_ident.doctor.swivels.bench import Job
from ssmr_ident.doctor.swivels.candidates import Values
from ssmr_ident.doctor.swivels.conditions import BRIEFEST, Condition
from ssmr_ident.doctor.swivels.explained import Explained, explained
from ssmr_ident.doctor.swivels.likelihood import weight_of

SPARE = 13  # runs of a round beyond the number of parameters
LARGEST = 3.0  # of a residual, natural logarithm: beyond it densities differ by nothing that a slope describes
TAU_DB = (0.8, 6.0)
WIDE = 2.0  # of the draws, over the standard deviations that a round leaves
SPREAD = 0.7  # of the first draws, over the standard deviations of what is known
LENGTHS = (1.0, 0.5)  # of a step that are tried
OPEN = 10.0  # times an effect's own spread, by which it may end elsewhere
LEAST = 0.5  # of the first draws' spread, below which none are drawn
KEPT = 3  # rounds whose runs are regressed on
GAINED, IDLE = 5.0, 2  # of evidence, less than which is no gain, and rounds without one that end a search
FAR = 2.0  # times the usual misfit: a robot that sticks or falls over says nothing of slopes


class Ensemble:
    """One explanation led on, round by round, so that several may race.

    Parameters
    ----------
    start : Explained
    conditions : tuple of Condition
        That are compared.
    floors : tuple of int
        Over which places are compared.
    seed : int
        Of the draws, and of the floors that slopes are taken over.

    Attributes
    ----------
    now : Explained
        The best place so far.
    gained : float
        Of evidence by the last round.
    slopes : (n, p + q) float or None
        Of the residuals, where the last round was.
    precision : (p + q, p + q) float
        What the conditions and the priors leave, there.
    """

    def __init__(self, start: Explained, conditions: tuple[Condition, ...], floors: tuple[int, ...], seed: int) -> None:
        self.conditions, self.floors, self.seed = conditions, floors, seed
        self.briefly = tuple(
            tuple(replace(c, duration=min(c.duration, BRIEFEST)) if c.settling else c for c in part)
            for part in (start.anchor.calibration, conditions)
        )
        self.random = np.random.default_rng(seed)
        self.done, self.gained = 0, 0.0
        self.slopes: np.ndarray | None = None
        self.now = start
        own = [] if start.candidate is None else [free.spread for free in start.candidate.free]
        size = len(start.anchor.priors)
        self.about = np.concatenate([np.zeros(size), start.place[size:]])
        spread = np.concatenate([np.full(size, SPREAD), own])
        self.prior = np.diag(np.concatenate([np.ones(size), (OPEN * np.array(own)) ** -2.0]))
        self.first, self.draw = spread, np.diag(spread**2)
        self.precision = self.prior
        self.seen: list[tuple[np.ndarray, np.ndarray]] = []

    @property
    def promise(self) -> float:
        """Evidence after one more round that gains as much as the last one did."""
        return self.now.evidence + self.gained

    @property
    def count(self) -> int:
        """Runs of a round, in pairs."""
        return 2 * ((len(self.about) + SPARE) // 2)

    def advance(self) -> None:
        """One round: draws, slopes, and a step where it helps."""
        centre, before = self.now.place, self.now.evidence
        if not len(centre):
            return
        root = np.linalg.cholesky(self.draw)
        half = self.random.standard_normal((self.count // 2, len(centre))) @ root.T
        places = centre + np.concatenate([half, -half])
        there = [(at, one) for at, one in zip(places, self._residuals(places), strict=True) if one is not None]
        if len(there) <= len(centre) + 2:
            return
        data = np.clip([one for _, one in there], -LARGEST, LARGEST)
        size = np.sqrt(np.mean(data**2, axis=1))
        near = size < FAR * np.median(size)
        drawn = np.array([at for at, _ in there])
        self.seen = [*self.seen, (drawn[near], data[near])][-KEPT:]
        curvature, pull = self._regressed(centre)
        self.precision = curvature + self.prior
        change = -np.linalg.solve(self.precision, pull + self.prior @ (centre - self.about))
        reach = np.sqrt(len(centre)) / max(float(np.linalg.norm(np.linalg.solve(root, change))), 1e-12)
        change *= min(1.0, reach)
        spread = np.sqrt(np.diag(np.linalg.inv(self.precision)))[len(self.now.anchor.priors) :]
        self.draw = self._narrowed()
        best = drawn[int(np.argmin(np.where(near, size, np.inf)))]
        self._compare([centre, *(centre + length * change for length in LENGTHS), best])
        self.now = replace(self.now, spread=spread)
        self.gained = self.now.evidence - before
        self.done += 1

    def _narrowed(self) -> np.ndarray:
        """Covariance of the next draws: what the last round left, no wider than the first and no narrower than a share
        of them: over less, slopes would be those of chance."""
        scaled = np.linalg.inv(self.precision) / np.outer(self.first, self.first)
        values, vectors = np.linalg.eigh(scaled)
        kept = np.clip(WIDE**2 * values, LEAST**2, 1.0)
        return (vectors * kept) @ vectors.T * np.outer(self.first, self.first)

    def settle(self, most: int, advance: Callable[[], None]) -> None:
        """Rounds until two of them gain nothing, ``most`` at most."""
        idle = 0
        for _ in range(most):
            self.gained = 0.0
            self.advance()
            idle = 0 if self.gained > GAINED else idle + 1
            advance()
            if idle == IDLE:
                break

    def _residuals(self, places: np.ndarray) -> list[np.ndarray | None]:
        """Measured less simulated log densities of calibration and targets at places, over one floor."""
        floor = max(self.floors) + 1 + 100 * self.seed + self.done
        held = replace(self.now, anchor=replace(self.now.anchor, seeds=(floor,)))
        made = [held.at(place) for place in places]
        self._prefetch(made, (floor,), *self.briefly)
        found = []
        for anchor, values in made:
            direct = replace(anchor, calibration=())
            asked = zip(self.briefly, ({}, self._effects(values)), strict=True)
            parts = [direct.blocks(conditions, active, 0.0) for conditions, active in asked]
            there = [block.residual for part in parts if part is not None for block in part]
            found.append(None if None in parts else np.concatenate(there))
        return found

    def _regressed(self, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Curvature and gradient of half the weighed squares at a place, chance's share of the curvature taken off."""
        offsets = np.concatenate([at for at, _ in self.seen]) - centre
        data = np.concatenate([one for _, one in self.seen])
        design = np.column_stack([np.ones(len(offsets)), offsets])
        inverse = np.linalg.pinv(design.T @ design)
        fitted = inverse @ design.T @ data
        left = data - design @ fitted
        chance = float(np.sum(left**2)) / max(len(design) - design.shape[1], 1) * inverse[1:, 1:]
        self.slopes = fitted[1:].T
        weight = weight_of(float(np.clip(self.now.target.tau_db, *TAU_DB)))
        curvature = (self.slopes.T @ self.slopes - chance) * np.outer(self.first, self.first)
        values, vectors = np.linalg.eigh(0.5 * (curvature + curvature.T))
        back = vectors / self.first[:, None]
        return weight * (back * np.maximum(values, 0.0)) @ back.T, weight * self.slopes.T @ fitted[0]

    def _compare(self, places: list[np.ndarray]) -> None:
        """The best of places over the floors that all explanations are compared on."""
        several = replace(self.now, anchor=replace(self.now.anchor, seeds=self.floors))
        made = [several.at(place) for place in places]
        self._prefetch(made, self.floors, self.now.anchor.calibration, self.conditions)
        found = [explained(anchor, self.now.candidate, values, self.conditions) for anchor, values in made]
        self.now = max((one for one in found if one is not None), key=lambda one: one.evidence, default=self.now)

    def _effects(self, values: dict[str, float]) -> dict:
        return {} if self.now.candidate is None else self.now.candidate.effects(values)

    def _prefetch(
        self,
        made: list[tuple[Anchor, Values]],
        seeds: tuple[int, ...],
        calibration: tuple[Condition, ...],
        conditions: tuple[Condition, ...],
    ) -> None:
        jobs: list[Job] = []
        for anchor, values in made:
            jobs += [(c, anchor.values, {}, seed) for c in calibration for seed in seeds]
            jobs += [(c, anchor.values, self._effects(values), seed) for c in conditions for seed in seeds]
        self.now.anchor.bench.prefetch(jobs)
