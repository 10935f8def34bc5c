"""Whether a session shows at all what was left out of it: the true effect, refitted from the truth, against none."""

from __future__ import annotations

import numpy as np
from bank.truth import BankSession

from ssmr_ident.compare.recorded import follow
from ssmr_ident.diagnose.baseline import LAST, best_baseline, prepared
from ssmr_ident.diagnose.engine import explained
from ssmr_ident.diagnose.explain import with_suspect
from ssmr_ident.diagnose.polish import polish
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.sliding import with_law_of_sliding
from ssmr_ident.diagnose.weigh import surplus
from ssmr_ident.identify.descent import descend
from ssmr_ident.identify.joint import evaluate


def true_evidence(drawn: BankSession) -> float | None:
    """Log evidence of the true effects over the baseline, both at their best; None where the catalogue has no values.

    The fit with the effects begins where they and the plant really are, and where the baseline ended with the effects
    as they are beside it; the better of both counts.
    """
    truth, known = drawn.truth, drawn.campaign.parameters
    if not truth.effects or not all(truth.effects.values()):
        return None
    setup, known = with_law_of_sliding(drawn.campaign, known, None)
    fit, lengths = setup.begun or best_baseline(setup.fitted, setup, known)
    kept = tuple(prepared(follow(setup.kept, fit.model, fit.point)))
    baseline = explained(kept, fit)
    begun = fit
    for effect_id, values in truth.effects.items():
        model, point = with_suspect(begun, Suspect(effect_id, dict(values), {}, {}, 0.0, np.zeros(0)))
        begun = evaluate(fit.trials, model, point, fit.nuisances)
    true = begun.point.copy()
    for k, unknown in enumerate(begun.model.physics):
        true[k] = unknown.scaled(truth.parameters[unknown.name]) if unknown.name in truth.parameters else 0.0
    found = []
    for start in (begun, follow(fit.trials, begun.model, true)):
        if np.isfinite(start.rss):
            found.append(explained(kept, polish(descend(start, LAST), lengths), baseline.kept))
    gains = [surplus(one, baseline) for one in found if np.all(np.isfinite(one.kept.parts))]
    return max(gains, default=None)
