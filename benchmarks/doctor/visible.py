"""How much evidence a session holds of what was left out of it: the true effects, refitted from the truth, against
fewer. It is the session's own and no engine's, so it is worked out once and kept."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bank.truth import BankSession
from scoring import Row, append

from doctor.sources import drawn_by
from doctor.unseen import KEPT, UNNAMED, known_evidence
from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose.baseline import LAST, alike_in, best_baseline, prepared
from ssmr_ident.diagnose.explain import with_suspect, without
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.polish import polish
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.sliding import with_law_of_sliding
from ssmr_ident.diagnose.weigh import Explanation, surplus
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.identify.trials import Trial


def look(rows: Sequence[Row]) -> None:
    """Work out and keep the evidence of sessions of the bank whose effects an engine has missed."""
    known = known_evidence()
    for row in rows:
        if row["outcome"] in UNNAMED and row["key"].startswith("bank/") and row["key"] not in known:
            append(KEPT, {"key": row["key"], "evidence": true_evidence(drawn_by(row["key"])) or {}})


def true_evidence(drawn: BankSession) -> dict[str, float] | None:
    """Log evidence of each true effect beside the others, all at their best; None where the catalogue has no values.

    The fit with the effects begins where they and the plant really are, and where the baseline ended with the effects
    as they are beside it; the better of both counts. What is without one of them begins where that ended, the baseline
    also where it ended by itself: an effect that has only shown the way to a better fit has shown nothing.
    """
    truth, known = drawn.truth, drawn.campaign.parameters
    if not truth.effects or not all(truth.effects.values()):
        return None
    setup, known = with_law_of_sliding(drawn.campaign, known, None)
    fit, lengths = setup.begun or best_baseline(setup.fitted, setup, known)
    kept = tuple(prepared(follow(alike_in(setup.kept, fit.trials), fit.model, fit.point)))
    baseline = explained(kept, fit)
    begun = fit
    for effect_id, values in truth.effects.items():
        model, point = with_suspect(begun, Suspect(effect_id, dict(values), {}, {}, 0.0))
        begun = evaluate(fit.trials, model, point, fit.nuisances)
    true = begun.point.copy()
    for k, unknown in enumerate(begun.model.physics):
        true[k] = unknown.scaled(truth.parameters[unknown.name]) if unknown.name in truth.parameters else 0.0
    whole = _best([begun, follow(fit.trials, begun.model, true)], kept, lengths, baseline)
    if whole is None:
        return None
    found = {}
    for effect_id in truth.effects:
        fewer = _best([without(whole.fit, effect_id)], kept, lengths, whole)
        before = [e for e in (fewer, baseline if len(truth.effects) == 1 else None) if e is not None]
        found[effect_id] = min((surplus(whole, one) for one in before), default=float("inf"))
    return found


def _best(
    starts: Sequence[JointFit], kept: Sequence[Trial], lengths: tuple[float, ...], near: Explanation
) -> Explanation | None:
    """The best that a model comes to from some starts; None where it makes no robot."""
    ends = [polish(descend(start, LAST), lengths) for start in starts if np.isfinite(start.rss)]
    found = [one for one in (explained(kept, end, near.kept) for end in ends) if np.all(np.isfinite(one.kept.parts))]
    return max(found, key=lambda one: surplus(one, near), default=None)
