"""A pulled block beside its simulation: start of the drive, zero of the cell and moments of letting go refitted."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.blocks.exported import AT_ONCE
from ssmr_ident.identify.blocks.model import DRIFT, FALLING, KINETIC, STATIC, STIFFNESS, Unknown
from ssmr_ident.identify.blocks.search import alone, blocks_of, known_shape, pulls_of
from ssmr_ident.physics.effects.cable_compliance import change
from ssmr_ident.physics.rig import block_from_parameters

FOLDED = frozenset({"stribeck", "cable_compliance", "load_cell_drift"})
"""Effects that are numbers of the block itself."""


def predict(parameters: ParameterSet, measurement: Measurement) -> Prediction:
    """Simulate a pull as its parameters have it."""
    block = block_from_parameters(parameters)
    effects = {name: {key: float(e.value) for key, e in own.items()} for name, own in parameters.effects.items()}
    plain = {
        KINETIC: block.mu_static * effects["stribeck"]["kinetic_share"] if "stribeck" in effects else block.mu_kinetic,
        STATIC: block.mu_static,
        STIFFNESS: change(block.cable_stiffness, **effects.get("cable_compliance", {"K_cable_N_m": float("inf")})),
    }
    over = effects.get("stribeck", {}).get(FALLING, 0.0)
    own = replace(parameters.updated({key: Estimate(value) for key, value in plain.items()}), effects={})
    drift = effects.get("load_cell_drift", {}).get("zero_drift_N_s", 0.0)
    pulls = pulls_of([measurement], block.mass)
    shape = known_shape(own)
    shape = replace(shape, drifts=drift != 0.0, smoothly=shape.falls and over > AT_ONCE)
    blocks = blocks_of(pulls, own, shape)
    fixed = {KINETIC: plain[KINETIC], FALLING: over, "fall": plain[STATIC] - plain[KINETIC], DRIFT: drift, **plain}
    ratio = block.cable_damping / (2.0 * (plain[STIFFNESS] * block.mass) ** 0.5) if shape.stretches else 0.0
    shared = tuple(
        Unknown(u.name, max(ratio, 1e-9) if u.name == "ratio" else fixed[u.name], 1.0) for u in blocks.shared
    )
    half_swing = 0.5 * math.pi * math.sqrt(block.mass / plain[STIFFNESS]) if shape.falls else 0.0
    fit = alone(replace(blocks, shared=shared), np.array([u.mean for u in shared]), pulls, -half_swing)
    log = pulls.logs[0]
    start, zero = (float(v) for v in fit.own[0][:2])
    return Prediction(
        log.time, ("force",), ("N",), log.force[:, None], fit.simulated[0][:, None], low_pass_hz=None,
        nuisances={"drive_starts_s": log.time[0] + start, "zero_N": zero},
    )  # fmt: skip
