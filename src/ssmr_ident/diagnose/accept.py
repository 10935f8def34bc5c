"""Whether an explanation is good enough: certainly better, by more than a formula, on unseen recordings as well."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.coloured import told_by
from ssmr_ident.diagnose.setup import BANDWIDTH, SHEET
from ssmr_ident.diagnose.weigh import CERTAIN, Explanation, asked, evidences, surplus
from ssmr_ident.diagnose.worth import BY_CHANCE, grows_with_motion, predictions, reddest, worth
from ssmr_ident.identify.fitting.descent import LOUD, chatters, slides
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.fitting.scatter import covariance

SECOND = 0.7
"""Share of the first effect's unexplained variance, mean over all recordings, that may be left when a second one is
added: the right effect in a formula that is not quite the world's leaves structure, of which any other takes a part.
How large a part, and how much a true second effect takes: docs/theory/robot_diagnosis.md."""

BESIDES = 0.95
"""The same without the recording that shows it best: one alone may be an accident, a stick that lets go elsewhere."""

BY_NOISE = 0.05
"""Probability by chance above which a second effect leaves nothing that follows the motion. Where the first one leaves
some (``BY_CHANCE``), that counts as well, whatever share below ``BESIDES``: what another formula takes of a wrong one
is only a part of that. Calibrated, docs/theory/robot_diagnosis.md."""

LED_ON = 0.1
"""By how much being led on may change the share that a pair leaves (15 pairs of 35 sessions of decays: 0.09 at the
most; 8 of 73 more, rigs among them: 0.07). What followed the motion by less than ``BY_CHANCE`` did so after it."""

FORMULA = 0.1
"""Share of the baseline's error below which what one effect leaves is put down to its own formula: a friction that is
rounded otherwise than the catalogue's leaves a hundredth, which some second effect always mends a little. Of a pair the
first one leaves more."""

UNHARMED, STRONG = 1.02, 0.5
"""Where no recording kept back shows an effect: the variance that it may add to those that it leaves unexplained, and
the share that the first one must leave in the recording that shows it best, or at the median; and a second effect,
mean over all, beside a first one that leaves less than ``FORMULA``."""

UNTOUCHED = 0.9
"""Share of the variance, mean over the recordings in which the baseline leaves more than noise, beyond which an answer
does not answer; and of what is beyond noise in all of them together."""

ALIKE = 2.0
"""Unexplained variance over that of the best explanation, up to which another counts as near as it."""

TOLERANCE = 0.1
"""Share by which a bandwidth may be below its sheet, whatever the file says of it."""

CHANCE = 0.0027
"""Probability, that of three standard deviations, with which an amplitude may be as far from off by chance, or
n ln(RSS) on recordings kept back fall as far where the first effect is none."""


def better(leader: Explanation, before: Explanation, first: bool) -> bool:
    """Whether an explanation is certainly better, and predicts recordings better that it has not seen."""
    if not certain(leader, before):
        return False
    change = np.log(leader.kept.parts / before.kept.parts)
    unharmed = harmless(leader, before)
    if not first:
        # the loudest recordings, which show a second effect best, are never kept back
        return unharmed and mends(leader, before)
    told = -float(told_by(leader.kept, before.kept) @ change)
    if told > chi2.isf(CHANCE, 1) or (unharmed and relieves(leader, before)):
        return True
    # a sensor clips in the loudest recordings only: what was kept back need not show it, but must not suffer; where
    # most recordings gain, that one may be a little worse
    every = _changes(leader, before)
    most = float(np.median(every)) < np.log(STRONG) and float(np.mean(change)) < np.log(ALIKE)
    return most or (unharmed and float(np.min(every)) < np.log(STRONG))


def ahead(one: Explanation, other: Explanation) -> bool:
    """Whether one of two that are no part of each other explains certainly more.

    Noise counts as coloured as it is in what the one leaves. Of two that leave different recordings each may be ahead
    by its own count: a mast over a hardening by 415 units, and the hardening over the mast by 1256 (bank 5234).
    """
    return certain(one, other) and surplus(one, other) > surplus(other, one)


def harmless(leader: Explanation, before: Explanation) -> bool:
    """Whether the recordings kept back do not speak against an explanation."""
    change = np.log(leader.kept.parts / before.kept.parts)
    # the baseline may have fitted one recording better than its noise, at the expense of all others
    explained = leader.kept.parts < LOUD * np.array([t.size for t in leader.kept.trials])
    return float(np.exp(np.mean(np.where(explained, np.minimum(change, 0.0), change)))) < UNHARMED


def relieves(leader: Explanation, before: Explanation) -> bool:
    """Whether an effect takes back what the baseline had to bend of what is known, and fits no worse.

    A baseline that reaches the recordings with its contacts moved by eight deviations has said that something is
    missing, though nothing is left of it to see.
    """
    worse = float(np.mean(np.log(leader.fit.parts / before.fit.parts)))
    return asked(before) - asked(leader) > 2.0 * CERTAIN and worse < float(np.log(UNHARMED))


def touches(chosen: Explanation, baseline: Explanation) -> bool:
    """Whether an explanation takes anything from the recordings in which the baseline leaves more than noise.

    What is named beside a misfit that it leaves as it is, is not what is missing. A drift may show in one alone that
    was kept back, which the baseline has not bent round; softening (bank 5508) in all recordings but the one that is
    loud. Where the baseline leaves what noise of some colour may leave, an offset that takes back what the baseline
    bent has nothing to take; nor where most pulls are explained, and one or two lie in hollows of their own whatever is
    named.
    """
    left, after = (
        np.concatenate([f.parts / [t.size for t in f.trials] for f in (e.fit, e.kept)]) for e in (baseline, chosen)
    )
    loud = left > LOUD
    if not loud.any() or float(np.mean(np.log(after / left)[loud])) < float(np.log(UNTOUCHED)):
        return True
    beyond, still = (float(np.maximum(e - 1.0, 0.0).sum()) for e in (left, after))
    if still < UNTOUCHED * beyond:
        return True
    explained = slides(baseline.fit) and float(np.median(left)) < LOUD
    return relieves(chosen, baseline) and (explained or not _beyond_noise(baseline))


def certain(leader: Explanation, before: Explanation) -> bool:
    """Whether all recordings together, fitted and kept, say so."""
    return surplus(leader, before) > CERTAIN


def mends(pair: Explanation, single: Explanation) -> bool:
    """Whether the effect that a pair has more takes what no formula of the other one would leave."""
    if not certain(pair, single):
        return False
    found = [np.sort(changes(pair, single)) for changes in (_changes, _above_noise)]
    shown = [c for c in found if float(np.exp(c[1:].mean())) < BESIDES]
    if not shown:
        return False
    return min(float(np.exp(c.mean())) for c in shown) < SECOND or settles(pair, single)


def promises(pair: Explanation, single: Explanation) -> bool:
    """Whether a pair that has not been led to its best takes so much of what one effect leaves that it may mend it.

    Of pairs that took next to nothing being led on changed that by 0.005. Of pulls it says nothing, which come out of
    hollows then.
    """
    return _least_left(pair, single) < BESIDES


def may_mend(pair: Explanation, single: Explanation) -> bool:
    """Whether a pair that promises something may mend what one effect leaves once it is led to its best. Not asked of
    pulls."""
    if _least_left(pair, single) < SECOND + LED_ON:
        return True
    before, after = (_by_chance(e) for e in (single, pair))
    return before < BY_CHANCE <= after


def _least_left(pair: Explanation, single: Explanation) -> float:
    return min(float(np.exp(changes(pair, single).mean())) for changes in (_changes, _above_noise))


def _by_chance(explanation: Explanation) -> float:
    return grows_with_motion(predictions(explanation.fit) + predictions(explanation.kept))


def halves(pair: Explanation, single: Explanation) -> bool:
    """Whether a pair leaves far less than any formula of its first effect would, mean over all recordings."""
    return float(np.exp(np.mean(_changes(pair, single)))) < STRONG


def settles(pair: Explanation, single: Explanation) -> bool:
    """Whether what a single effect leaves follows the motion, and what a pair leaves does not. Not in pulls."""
    if slides(single.fit):
        return False
    before, after = (_by_chance(e) for e in (single, pair))
    return before < BY_CHANCE and after > BY_NOISE


def _changes(one: Explanation, other: Explanation) -> np.ndarray:
    """Logarithm of the unexplained variance over another explanation's, recording by recording."""
    pairs = ((one.fit, other.fit), (one.kept, other.kept))
    return np.concatenate([np.log(a.parts / b.parts) for a, b in pairs])


def _above_noise(one: Explanation, other: Explanation) -> np.ndarray:
    """The same of what is more than noise, as that was taken from what the baseline left.

    Where a slow sensor is missing, that is too much: what it leaves is fast. An explanation then leaves a hundredth of
    the noise, and the share that another leaves of that may, or may not, say something.
    """
    changes = []
    for a, b in ((one.fit, other.fit), (one.kept, other.kept)):
        noise = np.array([t.size for t in a.trials])
        changes.append(np.log(np.maximum(a.parts, noise) / np.maximum(b.parts, noise)))
    return np.concatenate(changes)


def leading(chosen: Explanation, new: Sequence[Explanation]) -> Explanation:
    found = evidences([chosen, *new])
    return max(new, key=lambda e: found[e.id])


def left_over(chosen: Explanation, baseline: Explanation) -> float:
    """Size of what an explanation leaves over what the baseline left, mean over all recordings."""
    return float(np.exp(0.5 * _above_noise(chosen, baseline).mean()))


def leaves_structure(chosen: Explanation) -> bool:
    """Whether an explanation errs by more than noise of any colour."""
    left = chosen.kept.parts / [t.size for t in chosen.kept.trials]
    return float(np.median(left)) >= LOUD and _beyond_noise(chosen)


def _beyond_noise(explanation: Explanation) -> bool:
    """Whether what is left is more than noise of any colour can read, or larger where more moves.

    Sliding contacts chatter by themselves, whatever moves.
    """
    found = predictions(explanation.fit) + predictions(explanation.kept)
    read = worth(found, found, ())
    beyond = read.before > reddest(found) * read.noise_floor
    return chatters(explanation.fit) or beyond or grows_with_motion(found) < BY_CHANCE


def as_near(rival: Explanation, chosen: Explanation) -> bool:
    """Whether of two laws, neither of which is the world's, one is about as near to it as the other.

    Where the best law leaves structure, its formula is wrong by that much; a rival whose error is no more than that
    again, in the recordings that were fitted as in those that were kept back, cannot be told from it by how well it
    fits.
    """
    if len(rival.fit.model.ids) != len(chosen.fit.model.ids):
        return False
    pairs = ((rival.fit, chosen.fit), (rival.kept, chosen.kept))
    return all(float(np.mean(np.log(own.parts / best.parts))) < float(np.log(ALIKE)) for own, best in pairs)


def within_file(fit: JointFit, parameters: ParameterSet) -> bool:
    """Whether an effect is no more than what the file leaves open: a bandwidth, or the place of the centre of mass.

    Sheets are never good to a few percent. Where contacts and centre of mass are is one question, and the baseline has
    an answer of its own with the file's deviation.
    """
    values, effects = fit.model.split(fit.point)
    if "com_offset" in effects:
        # what the contacts are moved by beside it adds to it
        stds = {u.name: u.prior_spread for u in fit.model.physics}
        own = [(effects["com_offset"][f"offset_{x}_m"], f"contact_shift_{x}_m") for x in "xy"]
        away = [(offset - values.get(name, 0.0)) / stds.get(name, np.inf) for offset, name in own]
        known = any(name in stds for _, name in own)
        if known and float(np.sum(np.square(away))) < chi2.isf(CHANCE, 2):
            return True
    if "sensor_bandwidth" not in effects:
        return False
    sheet, std = parameters.number(BANDWIDTH, np.inf), parameters[BANDWIDTH].std if BANDWIDTH in parameters else None
    open_ = max(TOLERANCE, SHEET * (std or 0.0) / sheet)
    return bool(effects["sensor_bandwidth"]["bandwidth_hz"] > sheet * np.exp(-open_))


def significant(fit: JointFit) -> bool:
    """Whether every effect's own amplitudes are away from off by more than their uncertainty allows (Wald's test)."""
    first = len(fit.model.physics)
    scatter, point = covariance(fit)[first:, first:], fit.point[first:]
    for effect_id in {c.effect for c in fit.model.free}:
        own = [k for k, c in enumerate(fit.model.free) if c.effect == effect_id and c.parameter.off is not None]
        away = np.array(
            # off is infinitely far in a logarithm; one that is known to a third is three deviations from nothing
            [1.0 / fit.model.free[k].unknown.spread if fit.model.free[k].unknown.logarithmic else point[k] for k in own]
        )
        if own and float(away @ np.linalg.solve(scatter[np.ix_(own, own)], away)) < chi2.isf(CHANCE, len(own)):
            return False
    return True
