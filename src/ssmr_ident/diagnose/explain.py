"""Refits with an effect added, and effects taken out again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.compare.recorded import nearest
from ssmr_ident.diagnose.gathered import OFFSET, gathered
from ssmr_ident.diagnose.scan import Suspect, smaller
from ssmr_ident.diagnose.sizes import limits_of
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.horizons import horizon_fit
from ssmr_ident.identify.fitting.joint import JointFit, Slopes, evaluate
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray

SHRINKING = (1.0, 0.3, 0.1)
"""Shares of a suspect's start that are tried."""

GROWING = tuple(float(share) for share in np.geomspace(0.3, 300.0, 16))
"""Shares of a start from a straight line that are tried where that line hardly reaches."""

SETTLING = 3
"""Gauss-Newton steps of all else beside an effect that is held."""

SAME = 0.01
"""Difference in the logarithm of what is left of a recording up to which two starts of it have met."""


def with_suspect(fit: JointFit, suspect: Suspect, share: float = 1.0) -> tuple[Model, Array]:
    """The model with a suspect's effect, and a point of it at a share of the suspect's amplitude."""
    at = {name: value * (share if name in suspect.grown else 1.0) for name, value in suspect.at.items()}
    limits = limits_of(fit, CATALOGUE[suspect.effect])
    at |= {name: float(np.clip(at[name], *ends)) for name, ends in limits.items() if name in at}
    model, begin = fit.model.with_effect(suspect.effect, at, suspect.sizes, limits)
    held = {**model.held, suspect.effect: {**model.held[suspect.effect], **suspect.held}}
    return replace(model, held=held), np.concatenate([fit.point, begin])


def beside(fit: JointFit, suspect: Suspect) -> JointFit:
    """A suspect's start beside a fit, as large as it can be simulated.

    Not where it fits best unrefitted: that is next to nothing, where the baseline's optimum holds the fit. What acts
    beyond a threshold alone is held at its probe until all else has settled beside it: the straight line from a model
    that knows nothing of a slow sensor leads back over a hill to that model, and a release that fitted wheels on the
    floor is not one from which they lift. So releases are begun from small motions as well: of 16 short sessions with
    wheels that lift seven come lower from those, one by 1,224 in cost.
    """
    for share in SHRINKING:
        model, point = with_suspect(fit, suspect, share)
        begun = evaluate(fit.trials, model, point, fit.nuisances)
        if np.isfinite(begun.rss):
            break
    if not CATALOGUE[suspect.effect].sudden or not np.isfinite(begun.rss):
        return begun
    frozen = _held(fit, suspect, model, point)
    if not CATALOGUE[suspect.effect].moves:
        starts = [evaluate(fit.trials, frozen, fit.point, fit.nuisances)]
    else:
        starts = [nearest(fit.trials, frozen, fit.point, fit.nuisances)]
        if not any(trial.searched for trial in fit.trials):
            other = nearest(fit.trials, frozen, fit.point)
            starts += [] if _same(starts[0], other) else [other]
    ends = [descend(start, SETTLING) for start in starts]
    settled = min(ends, key=lambda f: f.cost(fit.counted) if np.isfinite(f.rss) else np.inf)
    return evaluate(fit.trials, model, np.concatenate([settled.point, point[len(fit.point) :]]), settled.nuisances)


def _same(one: JointFit, other: JointFit) -> bool:
    """Whether two fits leave as much of every recording."""
    return bool(np.all(np.abs(np.log(one.parts / other.parts)) < SAME))


def from_what_is_known(fit: JointFit, suspect: Suspect, lengths: Sequence[float]) -> JointFit:
    """A suspect beside all else as it is known, held at its probe until that has been led over whole recordings.

    Beside a baseline that has left what is known to do without it, an effect finds little to do.
    """
    model, point = with_suspect(fit, suspect)
    begun = horizon_fit(fit.trials, _held(fit, suspect, model, point), model.as_known(fit.point), lengths, SETTLING)
    return evaluate(fit.trials, model, np.concatenate([begun.point, point[len(fit.point) :]]), begun.nuisances)


def in_its_place(fit: JointFit, suspect: Suspect, far: Array) -> JointFit:
    """A suspect as large as it explains most in place of what a baseline had left the file for.

    Along the valley between two that do the same, a descent hardly moves. A centre of mass that is off is exactly where
    the baseline has moved its contacts to: as large as a slope makes it, an offset of 46 mm (bank 5969) was begun at
    20, and came down to a cost of 214, where this start has -490.

    Parameters
    ----------
    far : (p,) bool
        Coordinates of the physics that have left what is known.
    """
    point = fit.point.copy()
    point[: len(far)][far] = 0.0
    begun = _grown(replace(fit, point=point), suspect)
    if suspect.effect == OFFSET:
        begun.append(gathered(evaluate(fit.trials, *with_suspect(fit, suspect), fit.nuisances)))
    return min(begun, key=lambda f: f.cost(fit.counted) if np.isfinite(f.rss) else np.inf)


def as_large_as_it_takes(fit: JointFit, suspect: Suspect) -> JointFit:
    """A suspect as large as leaves least squares beside a fit, however little of it a straight line promises.

    The tires of a robot that hardens by far go, without hardening, more than three times as far: what a slope there
    makes of the effect is less than a hundredth of it.
    """
    grown = min(_grown(fit, suspect), key=lambda f: f.rss if np.isfinite(f.rss) else np.inf)
    values = grown.model.split(grown.point)[1][suspect.effect]
    # in units of what it is now, or a step of a descent is one of what the slope had made of it
    at = {name: values[name] for name in suspect.at}
    sizes = {name: abs(at[name]) for name in suspect.sizes}
    return evaluate(fit.trials, *with_suspect(fit, replace(suspect, at=at, sizes=sizes)), fit.nuisances)


def _grown(fit: JointFit, suspect: Suspect) -> list[JointFit]:
    tried = [replace(suspect, at=smaller(CATALOGUE[suspect.effect], suspect.at, share)) for share in GROWING]
    return [evaluate(fit.trials, *with_suspect(fit, one), fit.nuisances) for one in tried]


def _held(fit: JointFit, suspect: Suspect, model: Model, point: Array) -> Model:
    """The model with a suspect's effect as it is at a point, and nothing of that to be fitted."""
    return replace(fit.model, held={**fit.model.held, suspect.effect: model.split(point)[1][suspect.effect]})


def without(fit: JointFit, effect_id: str) -> JointFit:
    """The same point with one effect taken out."""
    model, keep = fit.model.without_effect(effect_id)
    slopes = tuple(Slopes(s.shared[:, keep], s.own) for s in fit.slopes)
    return evaluate(fit.trials, model, fit.point[keep], fit.nuisances, slopes)
