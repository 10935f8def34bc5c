"""The ``effects:`` block of a parameter file: the catalogue's own declaration of each parameter."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from ssmr_ident.core.domain import FINITE, Number
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.rotary import rotary, rotary_name

EffectKeys = dict[str, dict[str, tuple[Number, str]]]


def effect_keys() -> EffectKeys:
    """Domain and meaning of each parameter of each effect that the catalogue knows."""
    from ssmr_ident.physics.effects import CATALOGUE  # compiled code: only who names an effect waits for it

    return {
        effect.id: {
            p.name: (
                Number(p.unit, max(p.lower, -FINITE), min(p.upper, FINITE), infinite=math.isinf(p.upper)),
                p.meaning,
            )
            for p in effect.parameters
        }
        for effect in CATALOGUE.values()
    }


def in_rotary_units(estimates: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Parameters of an effect on a rotary rig, which the catalogue names for one that moves along a line."""
    return {rotary_name(name, e.unit): replace(e, unit=rotary(e.unit)) for name, e in estimates.items()}
