"""The ``effects:`` block of a parameter file: the catalogue's own declaration of each parameter."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace

from ssmr_ident.core.domain import FINITE, Number
from ssmr_ident.core.parameter import Estimate

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


def rotary(unit: str) -> str:
    """The unit of the same parameter on a rotary rig: moments in place of forces, angles in place of lengths.

    >>> rotary("N/m^3"), rotary("N s/m"), rotary("kg"), rotary("1/s")
    ('N m/rad^3', 'N m s/rad', 'kg m^2', '1/s')

    A unit that is one of turns already stays:

    >>> rotary("N m/rad^3")
    'N m/rad^3'
    """
    if "rad" in unit or "kg m^2" in unit:
        return unit
    turned = re.sub(r"\bm\b", "rad", unit)
    return re.sub(r"\bkg\b", "kg m^2", re.sub(r"\bN\b", "N m", turned))


def in_rotary_units(estimates: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Parameters of an effect on a rotary rig, whose units the catalogue writes for one that moves along a line."""
    return {name: replace(estimate, unit=rotary(estimate.unit)) for name, estimate in estimates.items()}
