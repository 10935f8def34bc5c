"""One effect in its other formulas: dry friction with elastic travel or without, a spring that is bent twice."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.sizes import sizes_of
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.physics.effect import Sized
from ssmr_ident.physics.effects import CATALOGUE

Form = Mapping[str, float | Sized]


def other_formulas(fit: JointFit, effect_id: str) -> Iterator[tuple[Model, np.ndarray]]:
    """Models in which an effect has another formula than in a fit, and where they begin.

    What both formulas fit begins at its value; all else of the fit stays.
    """
    effect = CATALOGUE[effect_id]
    switches = {parameter.name for parameter in effect.amplitudes}
    values = fit.model.split(fit.point)[1][effect_id]
    own = {c.parameter.name: values[c.parameter.name] for c in fit.model.free if c.effect == effect_id}
    forms = effect.forms if fit.model.on_rig else (*effect.forms, *effect.robot_forms)
    sizes = sizes_of(fit) if forms else {}
    for form in forms:
        begun = {name: begin.value(sizes) for name, begin in form.items() if isinstance(begin, Sized)}
        held = {name: begin for name, begin in form.items() if not isinstance(begin, Sized)}
        now = fit.model.held[effect_id]
        stays = begun.keys() | (switches - held.keys())
        at = {name: own.get(name, value) for name, value in {**own, **begun}.items() if name in stays}
        if set(own) == set(at) and all(now[name] == value for name, value in held.items()):
            continue
        bare, keep = fit.model.without_effect(effect_id)
        model, point = bare.with_effect(effect_id, at, {name: abs(value) for name, value in at.items()})
        every = {**model.held, effect_id: {**model.held[effect_id], **held}}
        # an explanation goes by the order in which its effects were found
        yield (
            replace(model, held={name: every[name] for name in fit.model.ids}),
            np.concatenate([fit.point[keep], point]),
        )
