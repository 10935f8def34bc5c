"""From explanations to the contract's diagnosis: parameters, what they are worth, what to do next."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
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
from ssmr_ident.diagnose.evidence import Evidence
from ssmr_ident.doctor.swivels.anchor import Anchor
from ssmr_ident.doctor.swivels.candidates import UNLISTED
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.engine import FINAL_SEEDS
from ssmr_ident.doctor.swivels.explained import Explained
from ssmr_ident.doctor.swivels.located import located
from ssmr_ident.doctor.swivels.maps import follows, speed_maps
from ssmr_ident.doctor.swivels.next_run import next_run
from ssmr_ident.doctor.swivels.outcome import Outcome
from ssmr_ident.doctor.swivels.spectral_distance import against_simulation, repeatability_db
from ssmr_ident.doctor.swivels.verdict import Decision, decide, findings_of
from ssmr_ident.doctor.swivels.words import EQUATIONS, UNLISTED_EQUATIONS, UNLISTED_WORDS, unlisted_form
from ssmr_ident.physics.effects import CATALOGUE

METRIC = "log_psd_db"
NEW_UNITS = {"tire.sliding_speed_m_s": "m/s", "floor.height_m": "m"}
MODEL_SPREAD = 0.07
"""Share of a size on top of its standard deviation: what errors of simulated sessions need (docs/theory/swivel.md)."""
SPREAD_FACTOR = 3.0
"""Of the curvature's standard deviations, to what errors of simulated sessions need, whose baselines are fitted too."""
KNOW_THE_TIRES = (
    "Pull the robot along and across on wheels that stand, press one wheel down, and let it go from a small roll and "
    "pitch: ident fit makes stiffness, damping and friction of them; or record the same speeds without the puzzling "
    "condition, as role: calibration"
)
CONFLICT = 3.0  # standard deviations of the prior


def diagnosis_of(outcome: Outcome, session: str) -> Diagnosis:
    """Put into words and numbers what an examination found."""
    unread = Decision(UNDETERMINED, (), 0.0, outcome.unread)
    decision = unread if outcome.unread else decide(findings_of(outcome))
    best = _chosen(outcome, decision)
    before = parameter_set(outcome, outcome.anchor, None)
    after = before if best is None else parameter_set(outcome, best.anchor, best)
    values = outcome.anchor.values
    added, effects = (values, {}) if best is None else (best.anchor.values, best.effects)
    floor = repeatability_db((*outcome.targets, *outcome.heldout))
    training = _worth(outcome, outcome.targets, added, effects, floor)
    heldout = _worth(outcome, outcome.heldout, added, effects, floor) if outcome.heldout else training
    maps = speed_maps(outcome, values, added, effects)
    return Diagnosis(
        session=session,
        verdict=decision.verdict,
        located=located(outcome) if decision.verdict != NOTHING else (),
        conflicts=_conflicts(outcome.anchor if best is None else best.anchor),
        effects=_named(outcome, decision, best),
        tried=_tried(outcome),
        metric=METRIC,
        training=training,
        heldout=heldout,
        next_experiment=KNOW_THE_TIRES if outcome.unread else next_run(outcome, decision.named),
        before=before,
        after=after,
        summary=_summary(outcome, decision, best, heldout),
        notes=(*_notes(outcome, decision), *_lines(maps)),
        evidence=Evidence(speeds=maps, seconds=dict(outcome.seconds)),
    )


def _chosen(outcome: Outcome, decision: Decision) -> Explained | None:
    if decision.verdict != MISSING:
        return None
    every = {one.id: one for one in (*outcome.screened[::-1], *outcome.explanations[::-1])}
    best, plain = every.get(decision.named[0]), outcome.baseline.held
    if decision.reason and best is not None and best.held is not None and plain is not None:
        # that something is new needs no explanation, and gets none that predicts no better
        return best if best.held.log_likelihood > plain.log_likelihood else None
    return best


def parameter_set(outcome: Outcome, anchor: Anchor, best: Explained | None) -> ParameterSet:
    """The session's parameters with the fitted baseline, and the effect where there is one."""
    known = outcome.bench.parameters
    changes = {}
    fitted_on = "calibration swivels" if outcome.calibrated else "target swivels"
    for prior, z in zip(anchor.priors, anchor.z, strict=True):
        old = known.get(prior.path)
        unit = NEW_UNITS.get(prior.path, old.unit if old else "1")
        value = anchor.values[prior.path]
        source = f"fitted to {fitted_on}; std is the prior's"
        changes[prior.path] = Estimate(value, prior.std * value, unit, source, at_bound=abs(z) > CONFLICT)
    for path, value in anchor.fixed.items():
        low, high = outcome.grip.lower, outcome.grip.upper
        std = None if low is None or high is None else (high - low) / 3.92
        changes[path] = Estimate(value, std, "1", f"{'yaw gain' if outcome.unread else 'profile'} over {fitted_on}")
    effects: dict[str, Mapping[str, Estimate]] = dict(known.effects)
    if best is not None:
        spreads = _spreads(best)
        for effect, values in best.effects.items():
            units = {p.name: p.unit for p in CATALOGUE[effect].parameters}
            effects[effect] = {
                name: Estimate(float(value), spreads.get(name), units[name], f"fitted to {fitted_on} and targets")
                for name, value in values.items()
            }
    return known.updated(changes, effects=effects)


def _spreads(best: Explained) -> dict[str, float]:
    if best.candidate is None or best.spread is None:
        return {}
    floor = [MODEL_SPREAD if free.log else 0.0 for free in best.candidate.free]
    widened = np.hypot(SPREAD_FACTOR * best.spread, floor)
    return {
        free.name: float(spread * (best.values[free.name] if free.log else 1.0))
        for free, spread in zip(best.candidate.free, widened, strict=True)
    }


def _named(outcome: Outcome, decision: Decision, best: Explained | None) -> tuple[NamedEffect, ...]:
    if decision.verdict != MISSING:
        return ()
    name = decision.named[0]
    others = tuple(decision.named[1:])
    if name == UNLISTED:
        sentence = "None of the listed effects takes away what is new in these spectra."
        if best is None:
            return (NamedEffect(name, sentence, "", {}, decision.confidence, others),)
        found = parameter_set(outcome, best.anchor, best).effects
        parameters = {key: value for block in found.values() for key, value in block.items()}
        form = unlisted_form(best.values)
        equation = UNLISTED_EQUATIONS[form].format(**best.values)
        return (NamedEffect(name, sentence, equation, parameters, decision.confidence, others, form),)
    effect = CATALOGUE[name]
    assert best is not None
    parameters = {
        key: value for key, value in parameter_set(outcome, best.anchor, best).effects[name].items()
        if key in best.values or not best.values
    }  # fmt: skip
    return (NamedEffect(name, effect.sentence, EQUATIONS[name], parameters, decision.confidence, others),)


def _tried(outcome: Outcome) -> tuple[Tried, ...]:
    conditions = outcome.heldout or outcome.targets
    every = (outcome.baseline, *outcome.explanations, *outcome.screened)
    rows = []
    for one in every:
        found = against_simulation(outcome.bench, conditions, one.anchor.values, one.effects, FINAL_SEEDS)
        metric = float(np.mean(list(found.values()))) if found else float("nan")
        rows.append(Tried(one.id, metric, float(one.evidence - outcome.baseline.evidence)))
    return tuple(sorted(rows, key=lambda row: row.log_evidence, reverse=True))


def _worth(
    outcome: Outcome, conditions: tuple[Condition, ...], added: Mapping[str, float], effects: Mapping, floor: float
) -> PredictionQuality:
    before = against_simulation(outcome.bench, conditions, outcome.anchor.values, {}, FINAL_SEEDS)
    after = against_simulation(outcome.bench, conditions, added, effects, FINAL_SEEDS)
    names = tuple(name for name in before if name in after)
    gains = np.array([before[name] - after[name] for name in names])
    interval = None
    if len(gains) > 1:
        random = np.random.default_rng(0)
        means = random.choice(gains, (2000, len(gains))).mean(axis=1)
        interval = (float(np.quantile(means, 0.025)), float(np.quantile(means, 0.975)))
    return PredictionQuality(
        float(np.mean([before[name] for name in names])), float(np.mean([after[name] for name in names])), floor, names,
        interval,
    )  # fmt: skip


def _unit(known: ParameterSet, path: str) -> str:
    return known[path].unit if path in known else NEW_UNITS.get(path, "")


def _conflicts(anchor: Anchor) -> tuple[Conflict, ...]:
    known, values = anchor.bench.parameters, anchor.values
    found = [
        Conflict(prior.path, prior.value, values[prior.path], float(z), _unit(known, prior.path))
        for prior, z in zip(anchor.priors, anchor.z, strict=True)
    ]  # fmt: skip
    for path, value in anchor.fixed.items():
        if path in known and known[path].std:
            prior = float(known[path].value)
            found.append(
                Conflict(path, prior, value, (value - prior) / float(known[path].std or 1.0), known[path].unit)
            )
    return tuple(one for one in found if abs(one.sigmas) > CONFLICT)


def _summary(outcome: Outcome, decision: Decision, best: Explained | None, heldout: PredictionQuality) -> str:
    after = (
        f"{heldout.before:.1f} dB become {heldout.after:.1f} dB on recordings never fitted "
        f"(repeatability {heldout.noise_floor:.1f} dB)"
    )
    if decision.verdict == NOTHING:
        if outcome.calibrated:
            base = outcome.baseline.target
            return (
                f"The targets differ from the calibration by {base.rms_db:.1f} dB, and chance alone makes "
                f"{base.chance_db:.1f} dB: nothing is missing."
            )
        return (
            f"No explanation tried accounts for the spectra better than the fitted baseline "
            f"({outcome.baseline.target.rms_db:.1f} dB away)."
        )
    if outcome.unread:
        said = f"{outcome.turned.turn}; {outcome.unread}" if outcome.turned else outcome.unread
        return f"{said[0].upper()}{said[1:]}."
    if decision.verdict != MISSING:
        return f"Something is missing that these recordings cannot tell: {decision.reason}."
    if best is None or best.candidate is None:
        return f"Something is missing and it is none of the listed effects: {decision.reason}."
    if best.id == UNLISTED:
        law = UNLISTED_WORDS[unlisted_form(best.values)]
        return f"What is missing is none of the listed effects; {law} comes nearest: {after}."
    tie = f" (or {' or '.join(decision.named[1:])}, which fits as well)" if len(decision.named) > 1 else ""
    return f"{CATALOGUE[best.id].sentence[:-1]}{tie}: {after}."


def _notes(outcome: Outcome, decision: Decision) -> tuple[str, ...]:
    notes = [*outcome.notes, *_turning_notes(outcome)]
    if outcome.unread:
        return tuple(notes)
    notes.append(str(outcome.grip))
    fit = outcome.anchor.fit
    if outcome.calibrated:
        notes.append(
            f"the baseline was fitted on the calibration recordings to {fit.rms_db:.1f} dB; what it misses there is "
            "carried over to the targets"
        )
    else:
        notes.append(
            "there are no calibration recordings: the baseline was fitted on the targets themselves and may have taken "
            f"up part of what is missing ({fit.rms_db:.1f} dB stayed); an effect must be "
            "twice as evident to be named, and what resembles a parameter of the baseline cannot be seen"
        )
    unknown = [p.path for p in outcome.anchor.priors
               if (known := outcome.bench.parameters.get(p.path)) is not None and known.std is None]  # fmt: skip
    if unknown:
        notes.append(f"the parameter file does not say how well it knows {', '.join(unknown)}")
    if decision.reason:
        notes.append(decision.reason)
    return tuple(notes)


def _turning_notes(outcome: Outcome) -> list[str]:
    """How much of the yaw rate that the wheels ask for is turned, measured and simulated."""
    if outcome.turned is None:
        return []
    runs = [(c, outcome.bench.run(c, outcome.anchor.values, {}, outcome.anchor.seeds)) for c in outcome.targets]
    simulated = float(np.mean([run.yaw_rate / c.turning for c, run in runs if run is not None and c.turning]))
    whose = "the file's robot" if outcome.unread else "the fitted baseline"
    held = yaw_gain_of(outcome.heldout)
    seen = f", recordings kept back at {held:.2f}" if np.isfinite(held) else ""
    return [str(outcome.turned), f"simulated, {whose} turns at {simulated:.2f} of the rate asked for{seen}"]


def yaw_gain_of(conditions: tuple[Condition, ...]) -> float:
    """Mean of measured over asked yaw rates, starts and stops included; NaN where none was measured."""
    found = [c.yaw_rate / c.turning for c in conditions if c.yaw_rate is not None and c.turning]
    return float(np.mean(found)) if found else np.nan


def _lines(maps: tuple) -> tuple[str, ...]:
    if not maps:
        return ()
    notes = []
    for found in maps:
        top = found.frequency[np.argmax(found.recorded, axis=1)]
        courses = ", ".join(f"{f:.0f} Hz at {np.degrees(s):.3g} deg/s" for f, s in zip(top, found.speed, strict=True))
        notes.append(f"main line of {found.channel}: {courses}; {follows(found.speed, top)}")
    return tuple(notes)
