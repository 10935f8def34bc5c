"""How much evidence a session holds of what was left out of it: the true effects, refitted from the truth, against
fewer. It is the session's own and no engine's, so it is worked out once and kept."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from bank.truth import BankSession
from scoring import Row, append

from doctor.sources import drawn_by
from doctor.unseen import KEPT, UNNAMED, known_evidence
from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.doctor.robots.calibrated import baseline_of
from ssmr_ident.doctor.robots.cooled import to_the_end
from ssmr_ident.doctor.robots.found import cost_of
from ssmr_ident.doctor.robots.run import under_laws_of_sliding
from ssmr_ident.identify.fitting.joint import JointFit, evaluate


def look(rows: Sequence[Row]) -> None:
    """Work out and keep the evidence of sessions of the bank whose effects an engine has missed."""
    known = known_evidence()
    for row in rows:
        if row["outcome"] in UNNAMED and row["key"].startswith("bank/") and row["key"] not in known:
            append(KEPT, {"key": row["key"], "evidence": true_evidence(drawn_by(row["key"])) or {}})


def true_evidence(drawn: BankSession) -> dict[str, float] | None:
    """Log evidence of each true effect beside the others, all at their best; None where the catalogue has no values.

    The fit with the effects begins where they and the plant really are, and where the baseline ended; what is without
    one of them begins where that ended, and the baseline where it ended by itself: an effect that has only shown the
    way to a better fit has shown nothing.
    """
    truth, known = drawn.truth, drawn.campaign.parameters
    if not truth.effects or not all(truth.effects.values()):
        return None
    laws = under_laws_of_sliding(arranged(drawn.campaign), known)
    base = min((baseline_of(setup.fitted, setup.model) for setup, _ in laws), key=cost_of)
    model, own = base.model, np.zeros(0)
    for effect_id, values in truth.effects.items():
        model, more = model.with_effect(effect_id, values, {name: abs(value) for name, value in values.items()})
        own = np.concatenate([own, more])
    true = [u.scaled(truth.parameters[u.name]) if u.name in truth.parameters else 0.0 for u in model.physics]
    starts = [follow(base.trials, model, np.concatenate([np.array(true), own])),
              evaluate(base.trials, model, np.concatenate([base.point, own]), base.nuisances)]  # fmt: skip
    whole = min((to_the_end(start) for start in starts if np.isfinite(start.rss)), key=cost_of, default=None)
    if whole is None:
        return None
    return {name: _evidence(whole, name, base) for name in truth.effects}


def _evidence(whole: JointFit, effect: str, base: JointFit) -> float:
    """Log evidence of one effect, by what all of them leave."""
    model, keep = whole.model.without_effect(effect)
    fewer = to_the_end(evaluate(whole.trials, model, whole.point[keep], whole.nuisances))
    least = min(cost_of(fewer), cost_of(base) if not model.ids else math.inf)
    temper = max(whole.rss / whole.size, 1.0) * whole.size / whole.independent
    return 0.5 * (least - cost_of(whole)) / temper - 0.5 * int((~keep).sum()) * math.log(whole.size / temper)
