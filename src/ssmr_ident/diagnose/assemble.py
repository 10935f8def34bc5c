"""From what the search found to the answer: verdict, names, numbers, sentences, and what the figures are drawn from."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.diagnosis import (
    MISSING,
    NOTHING,
    UNDETERMINED,
    Conflict,
    Diagnosis,
    NamedEffect,
    PredictionQuality,
    Tried,
)
from ssmr_ident.diagnose.discriminate import next_experiment
from ssmr_ident.diagnose.drift import drifts
from ssmr_ident.diagnose.evidence import Evidence
from ssmr_ident.diagnose.exported import exported
from ssmr_ident.diagnose.followed import on_all
from ssmr_ident.diagnose.in_part import in_part, left_over
from ssmr_ident.diagnose.locate import located
from ssmr_ident.diagnose.outcome import Outcome
from ssmr_ident.diagnose.residual_map import residual_maps
from ssmr_ident.diagnose.surface import surfaces
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.diagnose.within import REACH, measure_of
from ssmr_ident.diagnose.words import law, missing, nothing, readable, told, undetermined
from ssmr_ident.diagnose.worth import (
    BY_CHANCE,
    errors,
    grows_with_motion,
    over_any_noise,
    overlays,
    predictions,
    reddest,
    without_jolts,
    worth,
)
from ssmr_ident.identify.fitting.descent import slides
from ssmr_ident.identify.fitting.joint import JointFit, differentiate

METRIC = "nrmse_percent"

CONFLICT = 2.0
"""Prior standard deviations from which a parameter counts as pulled away from what is known of it."""

UNEXPLAINED = 1.6
"""Error over the noise floor from which something is missing even if nothing names it, where what is left follows the
motion: the floor takes the noise for white, and coloured noise lies above it."""

JOLTS = "what is left on unseen recordings is the jolt of the tightening cable: without it {:.1f} times the noise"

COLOURED = (
    "what is left is {:.1f} times a noise floor that takes noise for white; it is not larger where more moves, and "
    "noise of another colour reads up to {:.1f} times that floor"
)

BEYOND = 3.0
"""Times the most that noise of any colour reads beyond which one recording alone shows that something is missing; as
much as noise of which 3 % are white would read. Of 99 sessions without missing physics none came above 0.7,
and of those in which nothing slides none above 0.52."""

ALONE = "{} is left with {:.1f} times the most that noise of any colour reads in it"

WITHDRAWN = "{} explains recordings best, and predicts some of them worse than the baseline"

UNDER_JOLTS = "{}: the jolt of the tightening cable hides it; without that the error falls from {:.3g} to {:.3g} %"


def assembled(outcome: Outcome, parameters: ParameterSet, seed: int) -> Diagnosis:
    """The diagnosis.

    Parameters
    ----------
    outcome : Outcome
    parameters : ParameterSet
        What was known beforehand.
    seed : int
    """
    free, best = outcome.baseline, outcome.chosen
    named = best is not free
    base = measure_of(best, free) if named else free
    before_fit, after_fit = predictions(base.fit), predictions(best.fit)
    before_kept, after_kept = predictions(base.kept), predictions(best.kept)
    training = worth(before_fit, after_fit, [t.name for t in base.fit.trials])
    heldout = worth(before_kept, after_kept, [t.name for t in base.kept.trials])
    conflicts = conflicting(outcome)
    before_file = exported(base.fit, parameters)
    best_file = exported(best.fit, parameters) if named else before_file
    effects = _named(outcome, best_file.effects) if named else ()
    jolts: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    alone = ""
    settled = without_jolts(base.fit, before_fit), without_jolts(base.kept, before_kept)
    if named:
        verdict = MISSING
        ended = without_jolts(best.fit, after_fit), without_jolts(best.kept, after_kept)
        jolts = hidden_by_jolts((training, heldout), settled, ended)
    else:
        fitted, kept = (worth(p, p, ()) for p in settled)
        left = max(w.before / w.noise_floor for w in (fitted, kept))
        if heldout.before > UNEXPLAINED * heldout.noise_floor and kept.before < UNEXPLAINED * kept.noise_floor:
            jolts = (JOLTS.format(kept.before / kept.noise_floor),)
        follows = grows_with_motion([*settled[0], *settled[1]]) < BY_CHANCE
        most = max(reddest([*settled[0], *settled[1]]), UNEXPLAINED)
        verdict = UNDETERMINED if left > most or (left > UNEXPLAINED and follows) else NOTHING
        # a pull may be left in a local minimum of its own; one release in which wheels lift may be all that shows it
        over = np.zeros(1) if slides(base.fit) else over_any_noise([*settled[0], *settled[1]])
        if float(over.max()) > BEYOND:
            verdict, loudest = UNDETERMINED, [*base.fit.trials, *base.kept.trials][int(over.argmax())]
            alone = ALONE.format(loudest.name, float(over.max()))
        if outcome.withdrawn:
            verdict, alone = UNDETERMINED, WITHDRAWN.format(readable(outcome.withdrawn))
        if verdict == NOTHING and left > UNEXPLAINED:
            doubts = (COLOURED.format(left, most),)
    tried = _tried(outcome)
    if verdict == MISSING:
        summary = missing(effects, heldout, METRIC, conflicts)
    elif verdict == NOTHING:
        summary = nothing(heldout, METRIC, outcome.looked_at)
    else:
        names = [e.id for e in (best, *outcome.rivals)] if named else [t.id for t in tried if t.id != "baseline"]
        summary = undetermined(heldout, METRIC, names, alone)
    after = best.fit if named else None
    parts: dict[str, Callable[[], Any]] = {
        "overlays": partial(overlays, heldout.recordings, before_kept, after_kept, heldout=True),
        "maps": partial(residual_maps, base.fit, after),
    }
    if verdict != NOTHING:
        parts |= {
            "places": partial(located, base.fit, parameters, seed=seed),
            "advice": lambda: next_experiment(outcome.setup, *_apart(outcome)),
            "surfaces": partial(surfaces, base.fit, after, parameters),
            "drifts": partial(drifts, base.fit, seed=seed),
        }
    if named and outcome.setup.kept_by_us and outcome.setup.kept[0].part is None:
        parts["after"] = lambda: exported(refitted_on_all(outcome), parameters)
    made = dict(zip(parts, side_by_side(lambda part: part(), list(parts.values())), strict=True))
    evidence = Evidence(**{name: made.get(name, ()) for name in ("overlays", "maps", "surfaces", "drifts")})
    return Diagnosis(
        session=outcome.setup.campaign.session.name,
        verdict=verdict,
        located=made.get("places", ()),
        conflicts=conflicts,
        effects=effects if verdict != NOTHING else (),
        tried=tried,
        metric=METRIC,
        training=training,
        heldout=heldout,
        next_experiment=made.get("advice", ""),
        before=before_file,
        after=made.get("after", best_file),
        summary=summary,
        notes=(
            *outcome.setup.notes,
            *jolts,
            *doubts,
            *_elsewhere(free, base, conflicts),
            *_notes(best, free, heldout),
        ),
        evidence=evidence,
    )


def hidden_by_jolts(
    whole: Sequence[PredictionQuality], before: Sequence[Sequence[Prediction]], after: Sequence[Sequence[Prediction]]
) -> tuple[str, ...]:
    """Words where recordings, fitted or held out, are worse after, but for the jolts of cables better."""
    sets = zip(("fitted", "held out"), whole, before, after, strict=True)
    worse = ((name, first, second) for name, loud, first, second in sets if loud.after > loud.before)
    calm = ((name, worth(first, second, ())) for name, first, second in worse)
    return tuple(UNDER_JOLTS.format(name, w.before, w.after) for name, w in calm if w.after < w.before)


def _apart(outcome: Outcome) -> tuple[JointFit, list[JointFit], list[float]]:
    """What the next recording has to tell apart, with its evidence: the answer and its rivals; the nearest where
    there is no answer."""
    if outcome.chosen is not outcome.baseline:
        left = [outcome.chosen, *outcome.rivals]
    else:
        ranked = sorted(outcome.tried, key=lambda e: -outcome.found[e.id])
        left = [*(e for e in ranked if e is not outcome.baseline), outcome.baseline]
    return left[0].fit, [e.fit for e in left[1:]], [float(outcome.found[e.id]) for e in left]


def conflicting(outcome: Outcome) -> tuple[Conflict, ...]:
    """Parameters that the baseline's fit pulls away from what is known of them, the worst first."""
    known = {u.name: u for u in outcome.setup.known}
    fit = outcome.baseline.fit
    found = []
    for unknown, scaled in zip(fit.model.physics, fit.point, strict=True):
        prior, value = known[unknown.name], unknown.value(float(scaled))
        if prior.prior_std is None:
            continue
        sigmas = (value - prior.prior) / prior.prior_spread
        if abs(sigmas) > CONFLICT:
            found.append(Conflict(unknown.name, prior.prior, value, float(sigmas), unknown.unit))
    return tuple(sorted(found, key=lambda c: -abs(c.sigmas)))


def _named(outcome: Outcome, fitted: Mapping[str, Mapping[str, Estimate]]) -> tuple[NamedEffect, ...]:
    best = outcome.chosen
    found = []
    for effect_id in best.fit.model.ids:
        if effect_id in outcome.setup.model.held:
            continue
        others = tuple(dict.fromkeys(o for r in outcome.rivals for o in r.fit.model.ids if o not in best.fit.model.ids))
        # a range or stiffness without limit is one that does not act
        values = {name: estimate for name, estimate in fitted[effect_id].items() if np.all(np.isfinite(estimate.value))}
        if effect_id == "unlisted":
            values = {name: estimate for name, estimate in values.items() if not estimate.fixed}
        found.append(
            NamedEffect(effect_id, told(effect_id, values), law(effect_id, values), values, outcome.confidence, others)
        )
    return tuple(found)


def _tried(outcome: Outcome) -> tuple[Tried, ...]:
    def row(e: Explanation) -> Tried:
        burst = not np.isfinite(e.kept.rss)  # on recordings that it was not fitted to
        error = math.inf if burst else float(errors(predictions(e.kept)).mean())
        return Tried(e.id, error, float(outcome.found[e.id]))

    return tuple(sorted(side_by_side(row, outcome.tried), key=lambda t: -t.log_evidence))


def _elsewhere(free: Explanation, within: Explanation, conflicts: tuple[Conflict, ...]) -> tuple[str, ...]:
    """What a baseline leaves that is not held within its priors, where the one that is shown is."""
    if free is within:
        return ()
    left = float(errors(predictions(free.kept)).mean())
    off = f" ({conflicts[0].parameter} {conflicts[0].sigmas:+.1f} standard deviations off)" if conflicts else ""
    return (
        f"the baseline shown is the best within {REACH:.0f} standard deviations of all that is known; as another "
        f"robot{off} it leaves {left:.3g} % on recordings never fitted: what is known of the robot gives the name, not "
        "the recordings alone",
    )


def _notes(best: Explanation, free: Explanation, heldout: PredictionQuality) -> tuple[str, ...]:
    notes = []
    clipped = sum(t.facts.get("clipped", 0.0) for t in (*best.fit.trials, *best.kept.trials))
    if clipped:
        notes.append(f"{clipped:.0f} samples at the end of the sensor's range did not count")
    bounds = [c.unknown.name for c, p in zip(best.fit.model.free, best.fit.point[len(best.fit.model.physics) :],
              strict=True) if c.value(float(p)) in (c.parameter.lower, c.parameter.upper)]  # fmt: skip
    if bounds:
        notes.append(f"{', '.join(bounds)} ended on a bound: the law fits, its number says little")
    if best.fit.model.free and heldout.after > UNEXPLAINED * heldout.noise_floor:
        notes.append(
            f"{readable(best.id)} still leaves {heldout.after / heldout.noise_floor:.1f} times the noise floor: the "
            "law's form, or a smaller effect beside it, is not quite the world's"
        )
    if in_part(best, free):
        notes.append(
            f"{readable(best.id)} leaves {100 * left_over(best, free):.0f} % of what the baseline leaves beyond noise, "
            "and more of it where more moves: the world's law may be none that is listed"
        )
    return tuple(notes)


def refitted_on_all(outcome: Outcome) -> JointFit:
    """The chosen model on what was fitted and what the tool kept back; the session's own held-out ones stay unseen."""
    whole = on_all(outcome.chosen)
    return differentiate(whole) if np.isfinite(whole.rss) else outcome.chosen.fit
