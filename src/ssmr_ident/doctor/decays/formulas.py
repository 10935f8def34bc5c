"""Laws in other formulas of their effects, begun where a fit has them or a member of any shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.diagnose.formulas import other_formulas
from ssmr_ident.doctor.robots.cooled import FURTHER, Tried
from ssmr_ident.doctor.robots.members import Member
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, evaluate

TINY = 1e-9
"""What has one sign begins at, where a member of any shape holds none of it."""


def in_other_formulas(member: Member, fit: JointFit) -> list[Tried]:
    """A law in other formulas of its effect, begun where a fit has it."""
    found = []
    for model, point in other_formulas(fit, member.id):
        held = {n: v for n, v in model.held[member.id].items() if v != fit.model.held[member.id].get(n)}
        free = [c.parameter.name for c in model.free if c.effect == member.id]
        form = ", ".join([*free, *(f"{n} = {v:g}" for n, v in held.items() if n not in free)])
        begun = evaluate(fit.trials, model, point, fit.nuisances)
        if np.isfinite(begun.rss):
            found.append((replace(member, form=form, model=model), begun))
    return found


def parts_of(generic: Member, fit: JointFit, laws: Sequence[Member]) -> list[Tried]:
    """Laws that are a part of a member of any shape, in all formulas of their effects, begun where that has come to."""
    count, values = len(fit.model.physics), fit.model.split(fit.point)[1]
    there = {(c.effect, c.parameter.name) for c in fit.model.free}
    found: dict[tuple[str, str], Tried] = {}
    for law in (m for m in laws if not m.generic and m.kind == generic.kind):
        own = {(c.effect, c.parameter.name) for c in law.model.free}
        if not own or not own <= there or (law.id, law.form) in found:
            continue
        begun = evaluate(fit.trials, law.model, np.concatenate([fit.point[:count], law.own]), fit.nuisances)
        for member, start in [(law, begun), *(in_other_formulas(law, begun) if np.isfinite(begun.rss) else [])]:
            point = start.point.copy()
            for k, c in enumerate(member.model.free, start=count):
                if (c.effect, c.parameter.name) in there:
                    at = values[c.effect][c.parameter.name]
                    point[k] = c.unknown.scaled(max(at, TINY) if c.unknown.logarithmic else at)
            moved = evaluate(fit.trials, member.model, point, fit.nuisances)
            if np.isfinite(moved.rss):
                found[member.id, member.form] = (member, descend(moved, FURTHER, plain=True))
    return list(found.values())
