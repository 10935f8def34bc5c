"""The parameter file that a fit of a block stands for."""

from __future__ import annotations

import math
from dataclasses import replace

from ssmr_ident.core.parameter import FITTED, Estimate, ParameterSet
from ssmr_ident.identify.blocks.fit import Fitted
from ssmr_ident.identify.blocks.model import DAMPING, DRIFT, FALLING, KINETIC, SERIES, STATIC, STIFFNESS

KEYS = {KINETIC: "1", STATIC: "1", STIFFNESS: "N/m", DAMPING: "N s/m"}
"""Units."""

AT_ONCE = 1e-5
"""m/s: speed over which friction falls, where it falls at once."""


def exported(found: Fitted, known: ParameterSet) -> ParameterSet:
    """Values and standard deviations of the fit; what the file does not have is an effect."""
    values, stds = found.values, found.stds()
    rigid = not math.isfinite(known.number(STIFFNESS, math.inf))
    changes: dict[str, Estimate] = {}
    for key, unit in KEYS.items():
        if key not in values or (key in known and known[key].fixed) or (key == STIFFNESS and rigid):
            continue
        before = known.get(key, Estimate(0.0, None, unit))
        changes[key] = replace(before, value=values[key], std=stds[key], unit=unit, source=FITTED)
    effects: dict[str, dict[str, Estimate]] = {}
    if found.blocks.shape.stretches and rigid:
        effects["cable_compliance"] = {"K_cable_N_m": Estimate(values[STIFFNESS], stds[STIFFNESS], "N/m", FITTED)}
    if found.blocks.shape.softer:
        effects["cable_compliance"] = {"K_cable_N_m": Estimate(values[SERIES], stds[SERIES], "N/m", FITTED)}
        changes.pop(STIFFNESS, None)
    one = float(known[STATIC].value) == float(known[KINETIC].value) if STATIC in known and KINETIC in known else True
    if found.blocks.shape.falls and one:
        share = values[KINETIC] / values[STATIC]
        spread = share * math.hypot(stds[KINETIC] / values[KINETIC], stds[STATIC] / values[STATIC])
        effects["stribeck"] = {
            "kinetic_share": Estimate(share, spread, "1", FITTED),
            FALLING: Estimate(values[FALLING], stds[FALLING], "m/s", FITTED)
            if found.blocks.shape.smoothly
            else Estimate(AT_ONCE, None, "m/s", "at once", fixed=True),
            "exponent": Estimate(2.0, None, "1", "not fitted", fixed=True),
        }
    if found.blocks.shape.drifts:
        effects["load_cell_drift"] = {
            "zero_drift_N_s": Estimate(values[DRIFT], stds[DRIFT], "N/s", FITTED),
            "gain_drift_1_s": Estimate(0.0, None, "1/s", "not fitted", fixed=True),
        }
    return replace(known.updated(changes), effects=effects)
