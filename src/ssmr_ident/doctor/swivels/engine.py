"""From a campaign of swivels to explanations in order of their evidence."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest

import numpy as np

from ssmr_ident.compare.turning import turning_robot
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.doctor.swivels.anchor import SEEDS, Anchor, scale_of, stiffness_known
from ssmr_ident.doctor.swivels.baseline import FIRST, LAST, REACH, fitted_baseline
from ssmr_ident.doctor.swivels.bench import Bench
from ssmr_ident.doctor.swivels.candidates import candidates
from ssmr_ident.doctor.swivels.conditions import Condition, brief, conditions_of, held_back
from ssmr_ident.doctor.swivels.counter import Counter, Progress
from ssmr_ident.doctor.swivels.ensemble import Ensemble
from ssmr_ident.doctor.swivels.explained import Explained, explained
from ssmr_ident.doctor.swivels.grip import PATH, TRIED, GripProfile, grip_profile
from ssmr_ident.doctor.swivels.likelihood import Score
from ssmr_ident.doctor.swivels.outcome import Outcome
from ssmr_ident.doctor.swivels.regimes import widened
from ssmr_ident.doctor.swivels.screen import screened
from ssmr_ident.doctor.swivels.starts import ceilings, pitches
from ssmr_ident.doctor.swivels.verdict import LEFT
from ssmr_ident.doctor.swivels.yaw_gain import YawGain, yaw_gain
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.robot import contact_named

RACE = (8, 5)  # starts that are led on, round by round
SETTLED = 3  # that go on while they gain
FINAL_SEEDS = (1, 2, 3, 4)


def examine(
    campaign: Campaign, parameters: ParameterSet | None = None, seed: int = 0, progress: Progress | None = None
) -> Outcome:
    """Fit the baseline, try every start of every explanation, and let the best race.

    Parameters
    ----------
    campaign : Campaign
        With at least one swivel or straight run of role target.
    parameters : ParameterSet, optional
        In place of the session's.
    seed : int
        Of the draws, and of the simulated floors.
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
    floors = tuple(1000 * seed + s for s in SEEDS)

    count = Counter(show, "baseline", FIRST + LAST)
    fitted = fitted_baseline(known, fitted_on, scale_of(fitted_on), floors, seed, count.advance)
    alone = fitted.ensemble
    count.finish()
    grip = GripProfile(np.zeros(0), np.zeros(0), np.nan, None, None)
    quiet = False
    if calibration:
        grip = _profile(alone, fitted_on, show)
        if grip.anchor is not None and grip.moves(alone.now) and PATH in known:
            alone = Ensemble(replace(alone.now, anchor=grip.anchor), fitted_on, floors, seed)
            alone.settle(LAST, lambda: None)
        anchor = replace(alone.now.anchor, fit=alone.now.target, calibration=calibration)
        targets, calibration, quiet = _repeated(anchor, targets, np.linalg.inv(alone.precision))
    anchor = replace(alone.now.anchor, fit=alone.now.target, calibration=calibration)
    seconds["baseline"] = time.perf_counter() - clock

    begun = explained(anchor, None, {}, targets)
    assert begun is not None
    with_it = () if calibration else (alone,)
    rows = [] if quiet else _screened(((anchor, None),) if calibration else fitted.places, targets, show)
    ended = [] if quiet else _raced(rows, with_it, targets, floors, seed, show)
    finals = [_final(one, targets, heldout, seed) for one in _one_each(ended)]
    baseline = _final(begun if calibration else alone.now, targets, heldout, seed)
    if not calibration:
        grip = _profile(alone, targets, show)
        baseline = _offered(baseline, finals, targets, heldout)
        anchor = replace(baseline.anchor, fit=baseline.target)
    ranked = _one_each(finals)
    others = _one_each([one for row in rows for _, one in row])
    rest = [_kept_back(one, heldout) for one in others if one.id not in {other.id for other in ranked}]
    seconds["explanations"] = time.perf_counter() - clock - seconds["baseline"]
    # distances to simulated runs are told of conditions at their length
    whole = _at_length(all_calibration, calibration), _at_length(all_targets, targets)
    return Outcome(
        anchor.bench, *whole, heldout, anchor, baseline, tuple(ranked), tuple(rest), grip,
        (*kept_notes, *notes, *fitted.notes), seconds, turned,
    )  # fmt: skip


def _profile(baseline: Ensemble, fitted_on: tuple[Condition, ...], show: Progress) -> GripProfile:
    count = Counter(show, "lambda_max", len(TRIED))
    found = grip_profile(baseline.now, baseline.slopes, fitted_on, count.advance)
    count.finish()
    return found


def _repeated(
    anchor: Anchor, targets: tuple[Condition, ...], covariance: np.ndarray
) -> tuple[tuple[Condition, ...], tuple[Condition, ...], bool]:
    """Targets and calibration, their scatter widened where it decides, and whether the ones repeat the others."""
    calibration = anchor.calibration
    again = repeated(anchor.bench, calibration, targets, anchor.scale, anchor.seeds)
    if again is None or again.left <= LEFT:
        return targets, calibration, again is not None
    # is it that this robot shakes now in one way, now in another?
    targets, calibration = (widened(anchor, part, covariance) for part in (targets, calibration))
    again = repeated(anchor.bench, calibration, targets, anchor.scale, anchor.seeds)
    return targets, calibration, again is not None and again.left <= LEFT


def _screened(
    places: Sequence[tuple[Anchor, np.ndarray | None]], targets: tuple[Condition, ...], show: Progress
) -> list[list[tuple[float, Explained]]]:
    """The best starts of every explanation, what gains most first."""
    anchor = places[0][0]
    every = candidates(pitches(anchor, targets), ceilings(targets), anchor.values.get("floor.height_m", 3e-5))
    count = Counter(show, "explanations tried", len(every))
    rows = [found for c in every if (found := screened(places, c, targets, count.advance))]
    count.finish()
    return sorted(rows, key=lambda row: row[0][0], reverse=True)


def _raced(
    rows: list[list[tuple[float, Explained]]],
    with_them: tuple[Ensemble, ...],
    targets: tuple[Condition, ...],
    floors: tuple[int, ...],
    seed: int,
    show: Progress,
) -> list[Explained]:
    """Where the best explanations end: fewer from round to round, and all along what runs with them (the baseline)."""
    starts = interleaved([row[0][1] for row in rows], _one_each([one for row in rows for _, one in row]))
    alive = [Ensemble(one, targets, floors, seed + 1) for one in starts[: RACE[0]]]
    count = Counter(show, "explanations fitted", len(RACE) + (SETTLED + len(with_them)) * LAST)
    for most in (*RACE[1:], SETTLED):
        for one in (*alive, *with_them):
            one.advance()
        alive.sort(key=lambda one: one.promise, reverse=True)
        alive = [one for one in alive[:most] if one.promise > alive[0].promise - REACH]
        count.advance()
    for one in (*alive, *with_them):
        one.settle(LAST, count.advance)
    count.finish()
    return [one.now for one in alive]


def interleaved(first: Sequence[Explained], second: Sequence[Explained]) -> list[Explained]:
    """One of each in turn, each once: what gains most over the baseline at its place, what is ahead as it stands."""
    return list({id(one): one for pair in zip_longest(first, second) for one in pair if one is not None}.values())


def _offered(
    baseline: Explained, finals: list[Explained], targets: tuple[Condition, ...], heldout: tuple[Condition, ...]
) -> Explained:
    """The baseline, or one that was found beside an effect: a better baseline is no merit of the effect's."""
    beside = [explained(one.anchor, None, {}, targets) for one in finals]
    better = max((one for one in beside if one is not None), key=lambda one: one.evidence, default=baseline)
    return _kept_back(better, heldout) if better.evidence > baseline.evidence else baseline


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


def _kept_back(one: Explained, heldout: tuple[Condition, ...]) -> Explained:
    """With what it makes of recordings that it never saw."""
    found = one.anchor.score(heldout, one.effects) if heldout else None
    return one if found is None else replace(one, held=found[0])


def _final(one: Explained, targets: tuple[Condition, ...], heldout: tuple[Condition, ...], seed: int) -> Explained:
    """The same values once more with more runs, so that chance in the simulation decides less."""
    many = replace(one.anchor, seeds=tuple(1000 * seed + s for s in FINAL_SEEDS))
    jobs = [(c, many.values, one.effects, s) for c in targets for s in many.seeds]
    jobs += [(c, many.values, {}, s) for c in many.calibration for s in many.seeds]
    many.bench.prefetch(jobs)
    again = explained(many, one.candidate, one.values, targets)
    return _kept_back(one if again is None else replace(again, spread=one.spread), heldout)
