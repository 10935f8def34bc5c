"""From a campaign of swivels to explanations in order of their evidence."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ssmr_ident.campaign import Campaign
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.turning.anchor import ROUNDS, SEEDS, Anchor, anchored, scale_of
from ssmr_ident.diagnose.turning.bench import Bench
from ssmr_ident.diagnose.turning.candidates import Candidate, candidates, pitches_heard
from ssmr_ident.diagnose.turning.conditions import Condition, conditions_of, held_back
from ssmr_ident.diagnose.turning.grip import PATH, TRIED, GripProfile, grip_profile
from ssmr_ident.diagnose.turning.likelihood import Score
from ssmr_ident.diagnose.turning.search import Explained, explained, freed, polished, refined, screened

REFINED, FREED, FREED_STRAIGHT = (
    5,
    3,
    6,
)  # explanations that are refined, and that get the baseline set free beside them
FINAL_SEEDS = (1, 2, 3, 4)
LAST_ROUNDS = 3  # of fitting the winner, with all of them
LEFT = 20.0
"""What the model's own error may add to the baseline's log likelihood where nothing is missing (docs/theory)."""
FAR = 40.0
"""Of evidence: setting the baseline free has gained 27 at most, so what lies further behind cannot come first."""
REFINE_FAR = 100.0
"""The same for refining a candidate's own parameters from the start of its search."""
DISTORTED_DB = 2.0
"""Own error of a baseline fitted on the targets from which on it may have been bent by what is missing."""
CLOSE = 30.0  # of evidence behind the first: who comes first may still be a matter of where the search began
MANY = 3  # target conditions from which on one run each has to do while searching
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, eq=False)
class Outcome:
    """All that was found.

    Parameters
    ----------
    calibration, targets, heldout : tuples of Condition
    anchor : Anchor
        Baseline before anything was added.
    baseline : Explained
    explanations : tuple of Explained
        Best first, at their final values; without the baseline.
    screened : tuple of Explained
        Those that were not followed further.
    grip : GripProfile
    notes : tuple of str
    seconds : dict
    """

    bench: Bench
    calibration: tuple[Condition, ...]
    targets: tuple[Condition, ...]
    heldout: tuple[Condition, ...]
    anchor: Anchor
    baseline: Explained
    explanations: tuple[Explained, ...]
    screened: tuple[Explained, ...]
    grip: GripProfile
    notes: tuple[str, ...]
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def calibrated(self) -> bool:
        return bool(self.calibration)

    @property
    def gain(self) -> float:
        """Evidence of the best explanation over the baseline's."""
        return self.explanations[0].evidence - self.baseline.evidence if self.explanations else -np.inf


def examine(
    campaign: Campaign, parameters: ParameterSet | None = None, seed: int = 0, progress: Progress | None = None
) -> Outcome:
    """Fit the baseline, try every explanation, and free the baseline beside the best few.

    Parameters
    ----------
    campaign : Campaign
        With at least one swivel or straight run of role target.
    parameters : ParameterSet, optional
        In place of the session's.
    seed : int
        Of the simulated floors.
    progress : callable, optional
        Called with the name of a stage, what of it is done, and of how much.
    """
    show = progress or (lambda stage, done, total: None)
    clock = time.perf_counter()
    seconds: dict[str, float] = {}
    known = campaign.parameters if parameters is None else parameters
    measurements, kept_notes = held_back(campaign)
    conditions, notes = conditions_of(campaign, known, measurements)
    calibration = tuple(c for c in conditions if c.role == "calibration")
    targets = tuple(c for c in conditions if c.role == "target")
    heldout = tuple(c for c in conditions if c.role == "heldout")
    if not targets:
        raise InputError(
            str(campaign.session.folder), "holds no target swivel long enough to diagnose", "Give one role: target"
        )
    bench = Bench(known)
    fitted_on = calibration or targets
    seeds = tuple(1000 * seed + s for s in (SEEDS if len(targets) < MANY else SEEDS[:1]))

    count = _Counter(show, "baseline", 1 + ROUNDS)
    scale = scale_of(fitted_on)
    again = repeated(bench, calibration, targets, scale, seeds) if calibration else None
    quiet = again is not None and again.left <= LEFT
    anchor = anchored(bench, fitted_on, bool(calibration), scale, count.advance, seeds=seeds)
    count.finish()
    count = _Counter(show, "lambda_max", len(TRIED))
    grip = grip_profile(anchor, fitted_on, count.advance)
    # on the targets themselves a larger lambda_max may be the very effect that is looked for
    if calibration and grip.lower is not None and grip.anchor is not None and PATH in known:
        anchor = grip.anchor
    seconds["baseline"] = time.perf_counter() - clock
    baseline = explained(anchor, None, {}, targets)
    assert baseline is not None

    every = candidates(_pitches(anchor, targets), _ceilings(targets), anchor.values.get("floor.height_m", 3e-5))
    tried, starts = _tried(anchor, every, targets, baseline, quiet, show)
    if not calibration and baseline.target.tau_db > DISTORTED_DB:
        # fitted on the targets, the baseline may have bent itself round what is missing: once more from the file
        straight = replace(anchor, z=np.zeros(len(anchor.priors)))
        more, others = _tried(straight, every, targets, baseline, quiet, show, refine=False)
        best_there = more[:FREED_STRAIGHT]
        tried, starts = [*tried[:FREED], *best_there, *tried[FREED:]], {**others, **starts}
        followed = tried[: FREED + len(best_there)]
    else:
        followed = tried[:FREED]
    seconds["explanations"] = time.perf_counter() - clock - seconds["baseline"]

    rounds = 2 if calibration else 3
    level = baseline.evidence if quiet else max(baseline.evidence, max(one.evidence for one in tried)) - FAR
    worth_it = [one for one in followed if one.evidence > level or one.anchor is not anchor]
    count = _Counter(show, "baseline set free beside them", len(worth_it) * rounds + 2 * (rounds + 1) + LAST_ROUNDS)
    best = [freed(one, targets, rounds * (1 + (one.anchor is not anchor)), count.advance) for one in worth_it]
    best.sort(key=lambda one: one.evidence, reverse=True)
    for i in _ahead(best[:2], baseline):
        best[i] = polished(best[i], starts[best[i].id], targets, rounds + 1, count.advance)
    if not calibration:  # the explanations had their baseline fitted further on the targets; so must it be
        baseline = freed(baseline, targets, 3 * rounds, lambda: None)
    finals = [_final(one, targets, seed) for one in [baseline, *_one_each(best)]]
    finals[1:] = sorted(finals[1:], key=lambda one: one.evidence, reverse=True)
    for i in _ahead(finals[1:3], finals[0]):
        finals[i + 1] = freed(finals[i + 1], targets, LAST_ROUNDS, count.advance)
    count.finish()
    rest = [one for one in _one_each(tried) if one.id not in {other.id for other in finals}]
    ranked = sorted(finals[1:], key=lambda one: one.evidence, reverse=True)
    seconds["baseline beside explanations"] = time.perf_counter() - clock - sum(seconds.values())
    return Outcome(
        bench, calibration, targets, heldout, anchor, finals[0], tuple(ranked), tuple(rest), grip,
        (*kept_notes, *notes), seconds,
    )  # fmt: skip


def _tried(
    anchor: Anchor,
    every: tuple[Candidate, ...],
    targets: tuple[Condition, ...],
    baseline: Explained,
    quiet: bool,
    show: Progress,
    refine: bool = True,
) -> tuple[list[Explained], dict[str, Explained]]:
    """All candidates with this baseline, best first and the promising ones refined; and a second start of each."""
    count = _Counter(show, "explanations tried", 2 * len(every))
    pairs = [pair for pair in (screened(anchor, c, targets, count.advance) for c in every) if pair]
    count.finish()
    tried = sorted((pair[0] for pair in pairs), key=lambda one: one.evidence, reverse=True)
    if not refine:
        return tried, {pair[0].id: pair[-1] for pair in pairs}
    level = baseline.evidence if quiet else tried[0].evidence - REFINE_FAR
    promising = [one for one in tried[:REFINED] if one.evidence > level]
    count = _Counter(show, "best explanations refined", len(promising) + 1)
    for i, one in enumerate(promising):
        tried[i] = refined(one, targets, lambda: None)
        count.advance()
    count.finish()
    tried.sort(key=lambda one: one.evidence, reverse=True)
    return tried, {pair[0].id: pair[-1] for pair in pairs}


def _ahead(ranked: list[Explained], baseline: Explained) -> list[int]:
    """Which of the first two are to be fitted to the end: ahead of the baseline, and near the first."""
    return [
        i for i, one in enumerate(ranked)
        if one.evidence > baseline.evidence and one.evidence > ranked[0].evidence - CLOSE
    ]  # fmt: skip


def _one_each(explanations: list[Explained]) -> list[Explained]:
    """The best of each id, in order."""
    best: dict[str, Explained] = {}
    for one in explanations:
        if one.id not in best or one.evidence > best[one.id].evidence:
            best[one.id] = one
    return sorted(best.values(), key=lambda one: one.evidence, reverse=True)


def repeated(
    bench: Bench, calibration: tuple[Condition, ...], targets: tuple[Condition, ...], scale: np.ndarray, seeds: tuple
) -> Score | None:
    """Targets against calibration of the same speeds, whatever the baseline; None where speeds differ."""
    plain = Anchor(bench, scale, (), np.zeros(0), calibration, Score(0.0, 0.0, 0.0), seeds)
    if not all(plain.at_calibrated_speed(c) for c in targets):
        return None
    found = plain.score(targets, {})
    return None if found is None else found[0]


def _final(one: Explained, targets: tuple[Condition, ...], seed: int) -> Explained:
    """The same values once more with more runs, so that chance in the simulation decides less."""
    many = replace(one.anchor, seeds=tuple(1000 * seed + s for s in FINAL_SEEDS))
    jobs = [(c, many.values, one.effects, s) for c in targets for s in many.seeds]
    jobs += [(c, many.values, {}, s) for c in many.calibration for s in many.seeds]
    many.bench.prefetch(jobs)
    again = explained(many, one.candidate, one.values, targets)
    return one if again is None else replace(again, spread=one.spread)


def _pitches(anchor: Anchor, targets: tuple[Condition, ...]) -> tuple[float, ...]:
    """Joint distances to try: what the excess over the baseline speaks for."""
    excess, speeds = [], []
    for c in targets:
        blocks = anchor.blocks((c,), {}, anchor.shares[0])
        run = anchor.bench.run(c, anchor.values, {}, anchor.seeds)
        if blocks is None or run is None:
            continue
        channels = blocks[0].residual.reshape(len(c.mean.frequency), -1)[:, : len(c.names)]
        excess.append(channels.mean(axis=1))
        speeds.append(abs(run.yaw_rate) * lever(anchor) if c.experiment == "swivel" else _forward(c, anchor))
    frequency = min((c.mean.frequency for c in targets), key=len)
    return pitches_heard(frequency, [course[: len(frequency)] for course in excess], speeds)


def lever(anchor: Anchor) -> float:
    """Mean distance of the contacts from the centre of mass [m]."""
    points = np.asarray(anchor.bench.parameters["contact_points_m"].value, dtype=float)
    return float(np.hypot(points[:, 0], points[:, 1]).mean())


def _forward(c: Condition, anchor: Anchor) -> float:
    return float(np.abs(c.rates).mean()) * anchor.bench.parameters.number("tire.radius_m")


def _ceilings(targets: tuple[Condition, ...]) -> tuple[float, ...]:
    """Levels at which a sensor may have clipped: near the largest readings of each channel."""
    levels = []
    for c in targets:
        n = len(c.names)
        top = np.maximum(
            c.mean.levels[:n] + np.exp(c.mean.levels[n : 2 * n]), np.exp(c.mean.levels[2 * n :]) - c.mean.levels[:n]
        )
        levels.append(np.abs(top))
    highest = np.max(levels, axis=0)
    return tuple(sorted({float(h * f) for h in highest for f in (0.93, 0.98, 1.03)}))


class _Counter:
    def __init__(self, show: Progress, stage: str, total: int) -> None:
        self.show, self.stage, self.total, self.done = show, stage, total, 0
        show(stage, 0, total)

    def advance(self) -> None:
        self.done = min(self.done + 1, self.total)
        self.show(self.stage, self.done, self.total)

    def finish(self) -> None:
        self.show(self.stage, self.total, self.total)
