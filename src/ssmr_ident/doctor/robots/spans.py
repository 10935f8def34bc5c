"""Effects begun at the best of all combinations of values that their own files give."""

from __future__ import annotations

import itertools
from collections.abc import Iterable

import numpy as np

from ssmr_ident.diagnose.sizes import limits_of
from ssmr_ident.doctor.robots.cooled import Tried
from ssmr_ident.doctor.robots.members import member_at
from ssmr_ident.identify.fitting.joint import JointFit, evaluate
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray

BASELINE = "baseline."
"""How a span's name begins that is a factor on a parameter of the baseline."""


def spanned(fit: JointFit, names: Iterable[str]) -> list[Tried]:
    """Of every effect with spans the combination that leaves least, beside a fit and beside what is known.

    A saw-tooth that comes at the wrong time is worse than none, in squares: from a baseline through its middle no
    descent leads there. The recordings in which teeth are told by their sizes show which combination is near.
    """
    found = []
    for name in (n for n in names if CATALOGUE[n].spans):
        for point in (fit.model.as_known(fit.point), fit.point):
            tried = [_at(fit, name, point, values) for values in itertools.product(*CATALOGUE[name].spans.values())]
            finite = [pair for pair in tried if np.isfinite(pair[1].rss)]
            found += sorted(finite, key=lambda pair: pair[1].rss)[:1]
    return found


def _at(fit: JointFit, name: str, point: Array, values: tuple[float, ...]) -> Tried:
    effect = CATALOGUE[name]
    at = dict(zip(effect.spans, values, strict=True))
    own = {key: value for key, value in at.items() if not key.startswith(BASELINE)}
    member = member_at(fit.model, name, own, {}, limits_of(fit, effect))
    moved = point.copy()
    for key in at.keys() - own.keys():
        for k, unknown in enumerate(fit.model.physics):
            if unknown.name.rpartition(".")[2] == key.removeprefix(BASELINE):
                moved[k] += np.log(at[key]) / unknown.spread
    return member, evaluate(fit.trials, member.model, np.concatenate([moved, member.own]), fit.nuisances)
