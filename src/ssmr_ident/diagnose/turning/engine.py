"""From a campaign of swivels to explanations in order of their evidence."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np

from ssmr_ident.compare.turning import turning_robot
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.turning.alone import searched_again, without
from ssmr_ident.diagnose.turning.anchor import SEEDS, Anchor, scale_of, stiffness_known
from ssmr_ident.diagnose.turning.baseline import ROUNDS
from ssmr_ident.diagnose.turning.bench import STEP, Bench
from ssmr_ident.diagnose.turning.candidates import Candidate, candidates
from ssmr_ident.diagnose.turning.conditions import Condition, brief, conditions_of, held_back
from ssmr_ident.diagnose.turning.counter import Counter, Progress
from ssmr_ident.diagnose.turning.ensemble import ROUNDS as ENSEMBLE_ROUNDS
from ssmr_ident.diagnose.turning.ensemble import settled, settled_at_distances
from ssmr_ident.diagnose.turning.firm import STAGES as FIRM_ROUNDS
from ssmr_ident.diagnose.turning.firm import firm
from ssmr_ident.diagnose.turning.giving import screened_giving, slopes_alone
from ssmr_ident.diagnose.turning.grip import PATH, TRIED, GripProfile, grip_profile
from ssmr_ident.diagnose.turning.law import baseline_under_its_law
from ssmr_ident.diagnose.turning.likelihood import Score
from ssmr_ident.diagnose.turning.regimes import widened
from ssmr_ident.diagnose.turning.search import Explained, explained, freed, polished, refined, screened
from ssmr_ident.diagnose.turning.starts import ceilings, pitches
from ssmr_ident.diagnose.turning.wider import wider
from ssmr_ident.diagnose.turning.yaw_gain import YawGain, yaw_gain
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.robot import contact_named

REFINED = 5  # explanations whose own parameters are searched first, with calibration
FREED, FREED_LOOSE, FREED_STRAIGHT = 5, 3, 3
"""Explanations that get the baseline set free beside them: with calibration, without, and without from the file's
baseline."""
FIRST_STEPS = 3
HALVINGS = ((4, 4),)  # how many of the best get how many more steps, as long as they gain
ALONE = FIRST_STEPS + sum(more for _, more in HALVINGS)  # of the baseline by itself, without calibration
SETTLED = 2  # that an ensemble fits to the end
FINAL_SEEDS = (1, 2, 3, 4)
GAIN_LOOSE = 12.0
"""Evidence over the baseline that an explanation needs where no calibration holds the baseline."""
LEFT = 20.0
"""What the model's own error may add to the baseline's log likelihood where nothing is missing (docs/theory)."""
REFINE_FAR = 100.0
"""Of evidence: what lies further behind does not come first by being fitted (1.5 times the most seen)."""
DISTORTED_DB = 2.0
"""Own error of a baseline fitted on the targets by slopes, from which on it may be bent by what is missing."""
CLOSE = 100.0  # of evidence behind the first: as much as an ensemble was seen to add where slopes had ended
MANY = 3  # target conditions from which on one run each has to do while searching


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
    turned : YawGain or None
        Of the targets, where gyroscopes measured it.
    unread : str
        Why spectra were asked nothing; empty where they were.
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
    turned: YawGain | None = None
    unread: str = ""

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
    all_calibration = tuple(c for c in conditions if c.role == "calibration")
    all_targets = tuple(c for c in conditions if c.role == "target")
    heldout = tuple(c for c in conditions if c.role == "heldout")
    calibration, targets = (
        brief(part, len(all_calibration) + len(all_targets)) for part in (all_calibration, all_targets)
    )
    if not targets:
        raise InputError(
            str(campaign.session.folder), "holds no target swivel long enough to diagnose", "Give one role: target"
        )
    turned = yaw_gain([m for m in measurements if m.entry.role == "target"], known)
    if not calibration and not stiffness_known(known):
        return unread(known, turned, all_targets, heldout, (*kept_notes, *notes))
    fitted_on = calibration or targets
    seeds = tuple(1000 * seed + s for s in (SEEDS if len(targets) < MANY else SEEDS[:1]))

    count = Counter(show, "baseline", 1 + ROUNDS)
    scale = scale_of(fitted_on)
    anchor, law_notes = baseline_under_its_law(known, fitted_on, bool(calibration), scale, count.advance, seeds)
    bench = anchor.bench
    again = repeated(bench, calibration, targets, scale, seeds) if calibration else None
    quiet = again is not None and again.left <= LEFT
    count.finish()
    several = tuple(1000 * seed + s for s in FINAL_SEEDS)
    if calibration:
        count = Counter(show, "baseline fitted to the end", FIRM_ROUNDS)
        anchor = firm(anchor, calibration, seed, several, count.advance)
        count.finish()
    count = Counter(show, "lambda_max", len(TRIED))
    grip = grip_profile(anchor, fitted_on, count.advance)
    # on the targets themselves a larger lambda_max may be the very effect that is looked for
    if calibration and grip.moves(anchor) and grip.anchor is not None and PATH in known:
        anchor = grip.anchor
    if again is not None and not quiet:
        # is it that this robot shakes now in one way, now in another?
        targets, calibration = widened(anchor, targets), widened(anchor, calibration)
        anchor = replace(anchor, calibration=calibration)
        again = repeated(bench, calibration, targets, scale, seeds)
        quiet = again is not None and again.left <= LEFT
    seconds["baseline"] = time.perf_counter() - clock
    baseline = explained(anchor, None, {}, targets)
    assert baseline is not None
    distorted = not calibration and baseline.target.tau_db > DISTORTED_DB
    if not calibration:
        # as far as explanations are fitted later: what the parameters can bring about by themselves needs no effect
        count = Counter(show, "baseline fitted to the end", ALONE + ENSEMBLE_ROUNDS)
        begun = freed(baseline, targets, ALONE, count.advance, STEP)
        baseline = settled(begun, targets, seed, several, count.advance, everywhere=True)
        anchor = replace(baseline.anchor, fit=baseline.target, slopes=None)
        count.finish()

    # distances to simulated runs are told of conditions at their length
    whole = _at_length(all_calibration, calibration), _at_length(all_targets, targets)
    if quiet:  # the targets repeat the calibration: nothing is left that an effect could explain
        seconds["explanations"] = 0.0
        final = _final(baseline, targets, seed)
        return Outcome(
            bench, *whole, heldout, anchor, final, (), (), grip, (*kept_notes, *notes, *law_notes), seconds,
            turned,
        )  # fmt: skip

    every = candidates(pitches(anchor, targets), ceilings(targets), anchor.values.get("floor.height_m", 3e-5))
    pairs = _tried(anchor, every, targets, show)
    straight: list[Explained] = []
    if calibration:
        level = max(baseline.evidence, pairs[0][0].evidence) - REFINE_FAR
        pool = [one for pair in pairs[:FREED] for one in _both(pair) if one.evidence > level]
    else:
        pool = [one for pair in pairs[:FREED_LOOSE] for one in _both(pair)]
        if distorted:
            # fitted on the targets, the baseline may have bent itself round what is missing: once more from the file
            file = replace(anchor, z=np.zeros(len(anchor.priors)))
            straight = [pair[0] for pair in _tried(file, every, targets, show)[:FREED_STRAIGHT]]
            pool += straight
    seconds["explanations"] = time.perf_counter() - clock - seconds["baseline"]

    pooled = FIRST_STEPS * len(pool) + sum(most * more for most, more in HALVINGS)
    count = Counter(show, "baseline set free beside them", pooled + SETTLED * (1 + ENSEMBLE_ROUNDS))
    best = [replace(freed(one, targets, FIRST_STEPS, count.advance), slopes=None) for one in pool]
    for most, more in HALVINGS:
        best.sort(key=lambda one: one.evidence, reverse=True)
        reach = best[0].evidence - REFINE_FAR if best else 0.0
        for i, one in enumerate(best[:most]):
            if one.evidence > reach:
                best[i] = freed(one, targets, more, count.advance, STEP)
    best = _one_each(best)
    ahead = _ahead(best[:SETTLED], baseline)
    for fitted, i in enumerate(ahead):
        count.reach(pooled + (SETTLED - len(ahead) + fitted) * (1 + ENSEMBLE_ROUNDS))
        one = polished(best[i], targets, count.advance)
        best[i] = settled_at_distances(one, targets, seed, several, count.advance)
    count.finish()
    rough = _one_each([*best, *(pair[0] for pair in pairs)])
    best += wider(rough, targets, seed, several, show, [one.id for one in straight])
    finals = [_final(one, targets, seed) for one in [baseline, *_one_each(best)]]
    # a baseline that fits better, found beside an effect, is no merit of the effect's
    alone = max((finals[0], *without(finals[1:], targets)), key=lambda one: one.evidence)
    if not calibration:
        ahead_of_all = max((one.evidence for one in finals[1:]), default=-np.inf)
        alone = searched_again(alone, ahead_of_all, GAIN_LOOSE, targets, seed, several, show)
    finals[0] = replace(finals[0], evidence=max(alone.evidence, finals[0].evidence))
    rest = [one for one in _one_each([pair[0] for pair in pairs]) if one.id not in {other.id for other in finals}]
    ranked = sorted(finals[1:], key=lambda one: one.evidence, reverse=True)
    seconds["baseline beside explanations"] = time.perf_counter() - clock - sum(seconds.values())
    return Outcome(
        bench, *whole, heldout, anchor, finals[0], tuple(ranked), tuple(rest), grip, (*kept_notes, *notes, *law_notes),
        seconds, turned,
    )  # fmt: skip


def unread(
    known: ParameterSet,
    turned: YawGain | None,
    targets: tuple[Condition, ...],
    heldout: tuple[Condition, ...],
    notes: tuple[str, ...],
) -> Outcome:
    """What there is to say where neither file nor calibration knows any stiffness: slip, and spectra as they are.

    Every mode may then lie anywhere in the band, and whatever is added can be made up for.
    """
    grip = GripProfile(np.zeros(0), np.zeros(0), np.nan, None, None)
    fixed: dict[str, float] = {}
    if not contact_named(known):
        relay = turned is not None and turned.relay
        known = replace(known, choices={**known.choices, "tire.contact": "relay" if relay else "cone"})
    if turned is not None and turned.relay and turning_robot(known).sliding_speed == 0.0:
        own, *ends = (turned.lambda_max(gain) for gain in (turned.gain, turned.upper, turned.lower))
        grip, fixed = replace(grip, best=own, lower=ends[0], upper=ends[1]), {PATH: own}
    anchor = Anchor(Bench(known), scale_of(targets), (), np.zeros(0), (), Score(0.0, 0.0, 0.0), SEEDS[:1], fixed=fixed)
    baseline = explained(anchor, None, {}, targets)
    if baseline is None:
        raise InputError(known.file or known.name, "makes no robot that can be simulated", "Check its values")
    return Outcome(
        anchor.bench, (), targets, heldout, anchor, baseline, (), (), grip, notes, turned=turned,
        unread="what shakes the robot cannot be told: the parameter file does not know the stiffness of its tires "
        "(no std), and no calibration recording shows the robot without what is asked for",
    )  # fmt: skip


def _tried(
    anchor: Anchor, every: tuple[Candidate, ...], targets: tuple[Condition, ...], show: Progress
) -> list[list[Explained]]:
    """All candidates with this baseline, best first, each with a second start; anchored ones refined where promising.

    Without calibration the baseline gives way together with the effect instead.
    """
    count = Counter(show, "explanations tried", 2 * len(every))
    slopes = None if anchor.calibration else slopes_alone(anchor, targets)
    if slopes is None:
        found = (screened(anchor, c, targets, count.advance) for c in every)
    else:
        found = (screened_giving(anchor, c, targets, slopes, count.advance) for c in every)
    pairs = [pair for pair in found if pair]
    count.finish()
    pairs.sort(key=lambda pair: pair[0].evidence, reverse=True)
    if not anchor.calibration:
        return pairs
    level = pairs[0][0].evidence - REFINE_FAR
    promising = [pair for pair in pairs[:REFINED] if pair[0].evidence > level]
    count = Counter(show, "best explanations refined", len(promising) + 1)
    for pair in promising:
        pair.insert(0, refined(pair[0], targets, lambda: None))
        count.advance()
    count.finish()
    return sorted(pairs, key=lambda pair: pair[0].evidence, reverse=True)


def _both(pair: list[Explained]) -> list[Explained]:
    """The best of a candidate, and its second start where there is one."""
    return [pair[0]] if len(pair) == 1 or pair[-1].values == pair[0].values else [pair[0], pair[-1]]


def _ahead(ranked: list[Explained], baseline: Explained) -> list[int]:
    """Which are to be fitted to the end: near the first, or the baseline where that is ahead."""
    reach = max([baseline.evidence, *(one.evidence for one in ranked)]) - CLOSE
    return [i for i, one in enumerate(ranked) if one.evidence > reach]


def _at_length(conditions: tuple[Condition, ...], searched: tuple[Condition, ...]) -> tuple[Condition, ...]:
    """Conditions as long as they are, with the scatter found while searching."""
    return tuple(replace(c, wander=one.wander) for c, one in zip(conditions, searched, strict=True))


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
    return one if again is None else replace(again, spread=one.spread, slopes=one.slopes)
