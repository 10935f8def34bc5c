"""The diagnosis of a pulled block: what its pulls ask for beside the file's friction and drive."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.diagnose.diagnosis import Conflict, Diagnosis, KindShare, Located, NamedEffect, PredictionQuality, Tried
from ssmr_ident.diagnose.evidence import Evidence
from ssmr_ident.diagnose.words import law, missing, nothing, told, undetermined
from ssmr_ident.diagnose.worth import errors, overlays, worth
from ssmr_ident.doctor.decide import MISSING, NOTHING, UNDETERMINED
from ssmr_ident.doctor.rules import OVER_NOISE
from ssmr_ident.doctor.run import roles
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.identify.blocks.exported import KEYS, exported
from ssmr_ident.identify.blocks.fit import Fitted
from ssmr_ident.identify.blocks.search import Pulls, chosen, held, known_shape, pulls_of, searched

BLOCK = "drag"
METRIC = "nrmse_percent"
CONFLICT = 2.0
"""Prior standard deviations from which a parameter counts as pulled away from what is known of it."""

FOLLOWED = 2.0
"""Times the noise floor that is left at the most where a model follows teeth."""

NAMES = {
    "falls": ("stribeck", "static_force", "surface"),
    "stretches": ("cable_compliance", "static_force", "cable"),
    "softer": ("cable_compliance", "static_force", "cable"),
    "drifts": ("load_cell_drift", "sensor_chain", "sensor.force"),
    "changes": ("unlisted", "changing", "surface"),
}
"""By what a model has: effect, kind and element."""

CHANGING = "Friction changes along the way: the surface, or what is worn off it, is not the same everywhere."


def diagnose_block(
    campaign: Campaign, known: ParameterSet, progress: Callable[[str, int, int], None] | None = None
) -> Diagnosis:
    """Fit every model of a block, weigh them, and show the chosen one on recordings kept back.

    Raises
    ------
    InputError
        A log without force or speed, or nothing to fit.
    """
    step = progress or (lambda stage, done, total: None)
    campaign = arranged(campaign)
    targets, kept, by_us = roles(campaign)
    mass = float(known["mass_kg"].value)
    fitted, heldout = pulls_of(targets, mass), pulls_of(kept, mass) if kept else None
    step("fitting the block", 0, 1)
    found, noise = searched(fitted, known, known_shape(known))
    base, best = found[0], chosen(found)
    before, after = predictions([base], [fitted]), predictions([best], [fitted])
    training = worth(before, after, [m.name for m in targets])
    drawn = overlays([m.name for m in targets], before, after, heldout=False)
    shown, kept_errors = PredictionQuality(math.nan, math.nan, math.nan), {}
    if heldout is not None:
        for one in found:
            kept_errors[id(one)] = predictions(held(one, heldout), [heldout.only(k) for k in range(len(kept))])
        shown = worth(kept_errors[id(base)], kept_errors[id(best)], [m.name for m in kept])
        drawn = overlays([m.name for m in kept], kept_errors[id(base)], kept_errors[id(best)], heldout=True)
    step("fitting the block", 1, 1)
    lost = any(fitted.teeth) and training.after > FOLLOWED * training.noise_floor
    verdict = UNDETERMINED if lost else _verdict(base, best, training, shown)
    named = verdict == MISSING
    before_file = exported(base, known)
    after_file = exported(best, known) if named else before_file
    effects = _effects(base, best, found, after_file) if named else ()
    counted = training if math.isnan(shown.before) else shown
    clashing = conflicts(base)
    summary = {
        MISSING: lambda: missing(effects, counted, METRIC, clashing),
        NOTHING: lambda: nothing(counted, METRIC, len(found) - 1),
        UNDETERMINED: lambda: undetermined(counted, METRIC, [_name(f, base) for f in found if f is not base]),
    }[verdict]()
    if counted is training:
        summary = summary.replace("recordings never fitted", "the recordings that were fitted")
    tried = [
        Tried(_name(f, base), float(np.mean(errors(kept_errors[id(f)]))) if kept_errors else math.nan,
              f.log_evidence - base.log_evidence)
        for f in sorted(found, key=lambda f: -f.log_evidence)
    ]  # fmt: skip
    return Diagnosis(
        session=campaign.session.name, verdict=verdict,
        located=() if verdict == NOTHING else _located(base, noise), conflicts=clashing, effects=effects,
        tried=tuple(tried), metric=METRIC, training=training, heldout=shown, next_experiment=_next(best, effects),
        before=before_file, after=after_file, summary=summary,
        notes=_notes(best, fitted, by_us, [m.name for m in kept], lost), evidence=Evidence(overlays=drawn),
        kinds=_kinds(base, found) if verdict != NOTHING else (),
    )  # fmt: skip


def predictions(found: Sequence[Fitted], pulls: Sequence[Pulls]) -> list[Prediction]:
    """Every recording beside what its fit says of it."""
    made = []
    for fit, own in zip(found, pulls, strict=True):
        for log, force in zip(own.logs, fit.simulated, strict=True):
            made.append(Prediction(log.time, ("force",), ("N",), log.force[:, None], force[:, None], low_pass_hz=None))
    return made


def conflicts(base: Fitted) -> tuple[Conflict, ...]:
    """What the baseline's fit pulls away from what is known of it."""
    pulled = []
    for u, at in zip(base.blocks.shared, base.shared, strict=True):
        sigmas = (float(at) - u.mean) / u.std
        if abs(sigmas) > CONFLICT and u.name in KEYS:
            pulled.append(Conflict(u.name, u.value(u.mean), u.value(float(at)), sigmas, KEYS[u.name]))
    return tuple(sorted(pulled, key=lambda c: -abs(c.sigmas)))


def _verdict(base: Fitted, best: Fitted, training: PredictionQuality, shown: PredictionQuality) -> str:
    """Nothing is named that makes the error on fitted or kept recordings grow."""
    if best is not base:
        grows = training.after > 1.02 * training.before or shown.after > 1.02 * shown.before
        return UNDETERMINED if grows else MISSING
    return NOTHING if training.before < OVER_NOISE * training.noise_floor else UNDETERMINED


def _name(found: Fitted, base: Fitted) -> str:
    added = [NAMES[part][0] for part in NAMES if part in found.blocks.shape.parts - base.blocks.shape.parts]
    return "+".join(added) or "baseline"


def _without(best: Fitted, part: str, found: Sequence[Fitted]) -> float:
    """Evidence of the best model without a part."""
    return max((f.log_evidence for f in found if part not in f.blocks.shape.parts), default=-math.inf)


def _effects(base: Fitted, best: Fitted, found: Sequence[Fitted], after: ParameterSet) -> tuple[NamedEffect, ...]:
    named = []
    for part, (effect, kind, element) in NAMES.items():
        if part not in best.blocks.shape.parts - base.blocks.shape.parts:
            continue
        odds = best.log_evidence - _without(best, part, found)
        confidence = 1.0 / (1.0 + math.exp(-min(odds, 700.0)))
        values = dict(after.effects.get(effect, {}))
        if effect == "unlisted":
            named.append(
                NamedEffect(
                    effect, CHANGING, "mu = mu(x), drawn", {}, confidence, ("load_cell_drift",), kind=kind,
                    element=element, curve=_level(best),
                )
            )  # fmt: skip
            continue
        shown = {n: e for n, e in values.items() if not (e.fixed and n != "exponent")}
        if effect == "stribeck":
            shown |= {name: after[name] for name in ("mu_static", "mu_kinetic")}
        named.append(
            NamedEffect(effect, told(effect, shown), law(effect, shown), shown, confidence, kind=kind, element=element)
        )
    return tuple(sorted(named, key=lambda e: e.id == "unlisted"))


def _level(best: Fitted) -> dict[str, object]:
    """Friction over the head's way in the first recording."""
    own, log = best.own[0], best.blocks.logs[0]
    way = np.linspace(0.0, float(log.head[-1] - log.head[0]), len(best.blocks.level_start(0)))
    level = best.values["mu_kinetic"] * best.blocks.weight + own[-len(way) :]
    return {"variable": "way of the head [m]", "points": way.tolist(), "force": level.tolist(),
            "std": [0.0] * len(way)}  # fmt: skip


def _kinds(base: Fitted, found: Sequence[Fitted]) -> tuple[KindShare, ...]:
    """What each part takes of the misfit by the poorest model that has it beside the base."""
    least = min(f.cost for f in found)
    shares = []
    for part, (_, kind, element) in NAMES.items():
        own = [f for f in found if part in f.blocks.shape.parts - base.blocks.shape.parts]
        if own:
            first = min(own, key=lambda f: len(f.blocks.shape.parts))
            share = (base.cost - first.cost) / max(base.cost - least, 1e-12)
            evidence = first.log_evidence - base.log_evidence
            shares.append(KindShare(kind, element, float(np.clip(share, 0.0, 1.0)), evidence))
    return tuple(sorted(shares, key=lambda s: -s.share))


def _located(base: Fitted, noise: Sequence[float]) -> tuple[Located, ...]:
    powers = [np.cumsum((base.left(k) / n) ** 2) for k, n in enumerate(noise)]
    total = sum(float(p[-1]) for p in powers)
    places = []
    for log, power in zip(base.blocks.logs, powers, strict=True):
        share = float(power[-1]) / max(total, 1e-300)
        begin, end = (float(t) for t in np.interp([0.05, 0.95], power / max(float(power[-1]), 1e-300), log.time))
        nyquist = 0.5 / log.step
        words = f"{100 * share:.0f} % of the misfit is in force of {log.name}, {begin:.3g} to {end:.3g} s"
        places.append(Located(log.name, "force", (begin, end), (0.0, nyquist), "", share, words))
    return tuple(sorted(places, key=lambda p: -p.share)[:4])


def _next(best: Fitted, effects: Sequence[NamedEffect]) -> str:
    if any(e.indistinguishable_from for e in effects):
        return (
            "Pull it back over the same way at the same speed, and stand still as long before and after: friction of "
            "the surface comes again at the same place, a drift of the load cell goes on with time"
        )
    return ""


def _notes(best: Fitted, pulls: Pulls, by_us: bool, kept: Sequence[str], lost: bool) -> tuple[str, ...]:
    notes = []
    if lost:
        notes.append("there are teeth, and no model follows them tooth by tooth: what else is missing cannot be told")
    if by_us:
        notes.append(f"the session holds nothing back, so {', '.join(kept)} did not enter the fits that decided")
    for k, (log, moments, teeth) in enumerate(zip(pulls.logs, pulls.moments, pulls.teeth, strict=True)):
        words = f"{log.name}: the drive starts at {log.time[0] + best.own[k][0]:.4g} s"
        words += f", the block slides from {log.time[0] + moments[0]:.4g} s on"
        if teeth:
            rate = 1.0 / float(np.median(np.diff(moments)))
            words += f", {teeth} teeth at {rate:.3g} Hz"
            if teeth > len(moments):
                words += f", of which the first {len(moments)} were fitted"
        notes.append(words)
    if best.blocks.shape.changes:
        notes.append(
            "the level of friction along the way is each recording's own, and was found anew in those kept back"
        )
    notes.append("moments of letting go are each recording's own: no second pull has its teeth at the same times")
    return tuple(notes)
