"""Explanations that cannot be told from the answer, and answers that are only part of one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.accept import FORMULA, as_near, leaves_structure, left_over, significant
from ssmr_ident.diagnose.explain import beside
from ssmr_ident.diagnose.followed import NEAR, explained, joined, on_all
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.stripped import good_enough
from ssmr_ident.diagnose.weigh import TIE, Explanation, all_fitted, evidences
from ssmr_ident.diagnose.worth import BY_CHANCE, grows_with_motion, predictions
from ssmr_ident.identify.fitting.descent import chatters, descend
from ssmr_ident.identify.trials import Trial

NONE_OF_THEM = "unlisted"

MOST_RIVALS = 2
"""Explanations beside the best with which an answer is still one."""

STEPS = 10
"""Gauss-Newton steps of a law that had not come so far as to be refitted."""


def in_part(chosen: Explanation, baseline: Explanation) -> bool:
    """Whether an effect leaves more than its formula may, and more of it where more moves, as no noise is."""
    named = _named(chosen, baseline)
    if len(named) != 1 or NONE_OF_THEM in named or chatters(chosen.fit):
        return False
    if left_over(chosen, baseline) < FORMULA:
        return False
    return grows_with_motion(predictions(chosen.fit) + predictions(chosen.kept)) < BY_CHANCE


def rivals_of(
    chosen: Explanation,
    baseline: Explanation,
    tried: Sequence[Explanation],
    groups: Sequence[Sequence[Suspect]],
    kept: Sequence[Trial],
) -> tuple[list[Explanation], list[Explanation]]:
    """Those with no more effects that fit as well as the chosen one, the likeliest first; and all that was tried.

    Where the chosen one leaves structure, also those that are as near to the world; where that is more than a formula
    leaves, a law of no list as well, however it fits. What little is behind is held against the chosen one once more
    with all recordings fitted: what parameters happen to be predicts those kept back better or worse.

    Parameters
    ----------
    groups : sequence of sequence of Suspect
        Per effect, beside the baseline.
    """
    if chosen is baseline:
        return [], list(tried)
    none = _none_of_them(baseline, tried, groups, kept) if in_part(chosen, baseline) else []
    tried = joined(tried, none)
    found, wrong = evidences(tried), leaves_structure(chosen)
    alike = [e for e in tried if e not in (chosen, baseline) and len(e.fit.model.ids) <= len(chosen.fit.model.ids)]
    rivals = [e for e in alike if found[chosen.id] - found[e.id] < TIE or e in none or (wrong and as_near(e, chosen))]
    close = [e for e in alike if e not in rivals and found[chosen.id] - found[e.id] < NEAR]
    rivals += _tied_on_all(chosen, close) if close else []
    return sorted(rivals, key=lambda e: -found[e.id]), tried


def _tied_on_all(chosen: Explanation, close: Sequence[Explanation]) -> list[Explanation]:
    """Those that are no farther behind than a tie when all recordings are fitted."""
    if any(trial.part is not None for trial in chosen.kept.trials):
        return []
    best, *others = side_by_side(on_all, [chosen, *close])
    return [e for e, whole in zip(close, others, strict=True) if all_fitted(best, whole) < TIE]


def shared_by_all(
    chosen: Explanation, rivals: Sequence[Explanation], tried: Sequence[Explanation], baseline: Explanation
) -> Explanation | None:
    """The one effect of a pair, by itself, that is in all its rivals, where they are more than an answer may have.

    A law in another formula than the catalogue's leaves structure, of which a third and a fourth effect take as much as
    the second: which of them is beside the first is open, and the first is not. A rival without it that is behind the
    effect alone, for all that it has two, is none of it.
    """
    named = _named(chosen, baseline)
    if len(named) != 2 or len(rivals) <= MOST_RIVALS:
        return None
    found, singles = evidences(tried), {_named(e, baseline)[0]: e for e in tried if len(_named(e, baseline)) == 1}
    shared = [
        singles[name]
        for name in named
        if name in singles
        and all(name in _named(rival, baseline) or found[rival.id] < found[singles[name].id] for rival in rivals)
    ]
    certain = [e for e in shared if good_enough(e, baseline, True) and significant(e.fit)]
    return certain[0] if len(certain) == 1 else None


def _none_of_them(
    baseline: Explanation, tried: Sequence[Explanation], groups: Sequence[Sequence[Suspect]], kept: Sequence[Trial]
) -> list[Explanation]:
    """The best law of those that are in no list, where a session shows any."""
    for explanation in tried:
        if _named(explanation, baseline) == (NONE_OF_THEM,):
            return [explanation]
    for group in groups:
        if group[0].effect == NONE_OF_THEM:
            found = explained(kept, descend(beside(baseline.fit, group[0]), STEPS))
            return [found] if np.isfinite(found.fit.rss + found.kept.rss) else []
    return []


def _named(explanation: Explanation, baseline: Explanation) -> tuple[str, ...]:
    return tuple(name for name in explanation.fit.model.ids if name not in baseline.fit.model.ids)
