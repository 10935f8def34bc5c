"""Baseline and effect fitted together by an ensemble: what many runs about one place say of all parameters at once.

Spectra of stick-slip are no smooth functions of the parameters. A slope taken between two runs is half chance, and
steps along such slopes end in the first hollow that they come to, often one that only these speeds and these runs
have. An ensemble spread over what is known takes its slopes from all of its members (ensemble Kalman inversion with
the priors as data: Iglesias, Law and Stuart 2013; Chada, Stuart and Tong 2020), so that hollows narrower than itself
do not hold it; it draws together as the data's weight is turned up from round to round.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.turning.anchor import Anchor
from ssmr_ident.diagnose.turning.bench import COARSE, STEP
from ssmr_ident.diagnose.turning.candidates import Candidate
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.likelihood import Score, weight_of
from ssmr_ident.diagnose.turning.search import PITCH, SPREAD_FACTOR, Explained, explained, other_pitches

ROUNDS, ROUGH = 6, 3  # all, and the first ones, that are simulated with coarse steps
MOST, FEWEST, RUNS = 40, 24, 240
"""Members at most and at least (more than twice the parameters), and runs of one round that decide between."""
SPREAD = 0.5  # of the first ensemble, in standard deviations of the priors
SHRUNK = 0.5  # of the way that a fit has gone from the file's values: what slopes began may have led astray
OUTLIERS = 0.25  # of the members, the worst, give way to copies of others: robots that stick or fall over
LARGEST = 3.0  # of a residual, natural logarithm: beyond it densities differ by nothing that a slope describes
TAU_DB = (0.8, 6.0)
WEIGHTS = (0.15, 0.25, 0.5, 1.0)  # of the data in the first rounds, and from then on
ALIKE = 20.0  # of evidence, that ensembles about one place were seen to end apart
KEPT = 4  # best members that are compared, with their mean, over several runs per speed


def settled(
    start: Explained, targets: tuple[Condition, ...], seed: int, final: tuple[int, ...], advance: Callable[[], None],
    everywhere: bool = False,
) -> Explained:  # fmt: skip
    """The explanation where an ensemble about it ends, if that is better.

    Parameters
    ----------
    start : Explained
    targets : tuple of Condition
    seed : int
        Of the draws, and of the simulated floors.
    final : tuple of int
        Floors over which start, mean, and best members are compared; other ones than the ensemble runs over.
    advance : callable
        Called once per round.
    everywhere : bool
        The effect's own parameters begin spread over all of the candidate's starts, the baseline's, where there is no
        effect or no calibration, over what is known of them; by twice as many members.
    """
    ensemble = Ensemble(start, targets, seed, final, everywhere)
    for _ in range(ROUNDS):
        ensemble.advance()
        advance()
    return ensemble.best()


class Ensemble:
    """An ensemble about an explanation, round by round, so that several may race; see ``settled``.

    ``level`` is the best evidence in the last round: those of one round, on the same floor, can be compared.
    """

    def __init__(
        self, start: Explained, targets: tuple[Condition, ...], seed: int, final: tuple[int, ...], everywhere: bool
    ) -> None:
        self.start, self.targets, self.final = start, targets, final
        self.random = np.random.default_rng(seed)
        self.done, self.level = 0, -np.inf
        self.seen: list[tuple[float, np.ndarray]] = []
        candidate, size = start.candidate, len(start.anchor.priors)
        conditions = len(start.anchor.calibration) + len(targets)
        self.own = np.zeros(0) if candidate is None else candidate.position(start.values)
        # a baseline that was bent round an effect says little of where it belongs beside it: from half the way there,
        # three ensembles about a mast ended 190 to 220 behind its truth, from what is known 6, 70 and 220. One that
        # calibration holds is where it belongs.
        loose = everywhere and candidate is not None and not start.anchor.calibration
        about = np.concatenate([(0.0 if loose else SHRUNK) * start.anchor.z, self.own])
        # a baseline has no starts of its own to be spread over: its ensemble begins as wide as the priors
        wide = 1.0 if loose or (everywhere and candidate is None) else SPREAD
        spread = np.concatenate([np.full(size, wide), [] if candidate is None else [f.spread for f in candidate.free]])
        count = _members(conditions) * (2 if everywhere else 1)
        self.members = about + spread * self.random.standard_normal((count, len(about)))
        if everywhere and candidate is not None and candidate.free:
            self.members[:, size:] = _everywhere(candidate, count, self.random)

    def advance(self) -> None:
        """One round; nothing where no members are left that can be simulated."""
        if not len(self.members):
            return
        step = COARSE if self.done < ROUGH else self.start.anchor.step
        anchor = replace(self.start.anchor, seeds=(max(self.final) + 1 + self.done,), step=step)
        weight = WEIGHTS[min(self.done, len(WEIGHTS) - 1)]
        self.seen, self.members = _moved(self.start, anchor, self.members, self.targets, self.random, weight)
        self.level = max((evidence for evidence, _ in self.seen), default=-np.inf)
        self.done += 1

    def best(self) -> Explained:
        """The best of start, mean and the best members, on floors that the ensemble has not seen."""
        start, candidate, size = self.start, self.start.candidate, len(self.start.anchor.priors)
        if not len(self.members):
            return start
        several = replace(start.anchor, seeds=self.final)
        self.seen.sort(key=lambda pair: pair[0], reverse=True)
        began = np.concatenate([start.anchor.z, self.own])
        places = [began, self.members.mean(axis=0), *(at for _, at in self.seen[:KEPT])]
        _prefetch(start, several, places, self.targets)
        found = [one for at in places if (one := _at(start, several, at, self.targets)) is not None]
        best = max(found, key=lambda one: one.evidence, default=start)
        left = None if candidate is None else self.members[:, size:].std(axis=0)
        known = left if start.spread is None or left is None else np.maximum(start.spread, left)
        return replace(best, anchor=replace(best.anchor, seeds=start.anchor.seeds), spread=known)


def _members(conditions: int) -> int:
    return int(np.clip(RUNS // max(conditions, 1), FEWEST, MOST))


def work_of(conditions: tuple[Condition, ...]) -> float:
    """Steps that an ensemble from all starts simulates."""
    seconds = sum(c.settling + c.duration for c in conditions)
    return 2 * _members(len(conditions)) * seconds * (ROUGH / COARSE + (ROUNDS - ROUGH) / STEP)


def _everywhere(candidate: Candidate, count: int, random: np.random.Generator) -> np.ndarray:
    """(count, p) float: places about a candidate's starts, as far from them as half of what those differ by."""
    starts = np.array([candidate.position(values) for values in candidate.starts])
    apart = np.maximum(0.5 * starts.std(axis=0), [free.spread for free in candidate.free])
    places = starts[random.integers(len(starts), size=count)]
    return places + apart * random.standard_normal(places.shape)


def settled_at_distances(
    start: Explained, targets: tuple[Condition, ...], seed: int, final: tuple[int, ...], advance: Callable[[], None]
) -> Explained:
    """``settled``; an effect with a distance also from the likeliest other one, and the better of both.

    No ensemble goes from one comb of lines to another. Where both end alike, the distance is known no better than they
    lie apart.
    """
    best = settled(start, targets, seed, final, advance)
    for values in other_pitches(best, targets)[:1]:
        again = explained(best.anchor, best.candidate, values, targets)
        if again is None:
            continue
        other = settled(replace(again, spread=best.spread), targets, seed, final, lambda: None)
        if other.evidence > best.evidence:
            best, other = other, best
        if other.evidence > best.evidence - ALIKE and best.candidate is not None and best.spread is not None:
            named = np.array([free.name == PITCH for free in best.candidate.free])
            apart = abs(float(np.log(best.values[PITCH] / other.values[PITCH])))
            best = replace(best, spread=np.where(named, np.maximum(best.spread, apart / SPREAD_FACTOR), best.spread))
    return best


def _moved(
    start: Explained, anchor: Anchor, members: np.ndarray, targets: tuple[Condition, ...],
    random: np.random.Generator, weight: float,
) -> tuple[list[tuple[float, np.ndarray]], np.ndarray]:  # fmt: skip
    """One round: evidence and place of every member that could be simulated, and where they go."""
    size = len(anchor.priors)
    _prefetch(start, anchor, list(members), targets)
    results = [(one, _residual(start, anchor, at, targets), at)
               for at in members if (one := _at(start, anchor, at, targets)) is not None]  # fmt: skip
    kept = [(one, residual, at) for one, residual, at in results if residual is not None]
    if len(kept) < FEWEST // 2:
        return [], np.empty((0, members.shape[1]))
    evidence = np.array([one.evidence for one, _, _ in kept])
    tau = float(np.clip(np.median([one.target.tau_db for one, _, _ in kept]), *TAU_DB))
    place = np.array([at for _, _, at in kept])
    data = np.sqrt(weight_of(tau)) * np.clip([residual for _, residual, _ in kept], -LARGEST, LARGEST)
    data = np.column_stack([data, place[:, :size]])  # the priors' own residuals
    good = np.flatnonzero(evidence >= np.quantile(evidence, OUTLIERS))
    chosen = np.where(np.isin(np.arange(len(kept)), good), np.arange(len(kept)), random.choice(good, len(kept)))
    deviation = [(x[good] - x[good].mean(axis=0)) / np.sqrt(len(good) - 1) for x in (data, place)]
    noisy = data[chosen] + random.standard_normal(data.shape) / np.sqrt(weight)
    gain = np.linalg.solve(deviation[0] @ deviation[0].T + np.eye(len(good)) / weight, deviation[0] @ noisy.T)
    return list(zip(evidence.tolist(), place, strict=True)), place[chosen] - gain.T @ deviation[1]


def _effects(start: Explained, own: np.ndarray) -> tuple[dict[str, float], dict]:
    if start.candidate is None:
        return {}, {}
    values = start.candidate.values(own)
    return values, start.candidate.effects(values)


def _prefetch(start: Explained, anchor: Anchor, places: list[np.ndarray], targets: tuple[Condition, ...]) -> None:
    jobs = []
    for at in places:
        values, (_, effects) = anchor.at(at[: len(anchor.priors)]), _effects(start, at[len(anchor.priors) :])
        pairs = [*((c, {}) for c in anchor.calibration), *((c, effects) for c in targets)]
        jobs += [(c, values, active, seed) for c, active in pairs for seed in anchor.seeds]
    anchor.bench.prefetch(jobs, anchor.step)


def _at(start: Explained, anchor: Anchor, at: np.ndarray, targets: tuple[Condition, ...]) -> Explained | None:
    """The explanation with other values; None where they make no robot."""
    z = at[: len(anchor.priors)]
    moved = replace(anchor, z=z)
    if anchor.calibration:
        found = replace(anchor, calibration=()).score(anchor.calibration, {}, anchor.at(z))
        if found is None:
            return None
        fit = found[0]
        moved = replace(moved, fit=Score(fit.log_likelihood - 0.5 * float(z @ z), fit.tau_db, fit.rms_db))
    return explained(moved, start.candidate, _effects(start, at[len(z) :])[0], targets)


def _residual(start: Explained, anchor: Anchor, at: np.ndarray, targets: tuple[Condition, ...]) -> np.ndarray | None:
    """Measured less simulated log densities of calibration and targets, nothing carried over."""
    size = len(anchor.priors)
    values, direct = anchor.at(at[:size]), replace(anchor, calibration=())
    effects = _effects(start, at[size:])[1]
    parts = [direct.blocks(anchor.calibration, {}, 0.0, values), direct.blocks(targets, effects, 0.0, values)]
    if any(part is None for part in parts):
        return None
    return np.concatenate([block.residual for part in parts if part is not None for block in part])
