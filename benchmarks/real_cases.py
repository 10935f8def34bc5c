"""The real recordings, and what the diagnosis of each must show."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scoring import engine, row_of

from ssmr_ident.compare import predict
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.experiments.campaign import Campaign, load
from ssmr_ident.signals.filters import low_pass
from ssmr_ident.workflows.diagnose import diagnose, write_diagnosis

Claims = list[tuple[str, bool]]


def heldout_rms(campaign: Campaign, parameters: ParameterSet) -> dict[str, tuple[float, float]]:
    """Per held-out recording: RMS error and its share of the signal's standard deviation, first channel, no filter."""
    found = {}
    for measurement in campaign.measurements:
        if measurement.entry.role == "heldout":
            prediction = predict(campaign, measurement, parameters)
            rest = prediction.measured[:, 0] - prediction.simulated[:, 0]
            rms = float(np.sqrt(np.mean((rest - rest.mean()) ** 2)))
            found[measurement.name] = (rms, rms / float(prediction.measured[:, 0].std()))
    return found


def names(diagnosis: Diagnosis) -> set[str]:
    return {effect.id for effect in diagnosis.effects}


def silverbox(campaign: Campaign, d: Diagnosis) -> Claims:
    before, after = heldout_rms(campaign, d.before), heldout_rms(campaign, d.after)
    arrow = "arrow.csv"
    text = f"arrow {1e3 * before[arrow][0]:.2f} -> {1e3 * after[arrow][0]:.2f} mV (limit 1.5)"
    text += "".join(f"; {k} {1e3 * before[k][0]:.2f} -> {1e3 * v[0]:.2f} mV" for k, v in after.items() if k != arrow)
    return [("hardening named", "nonlinear_stiffness" in names(d)), (text, after[arrow][0] < 1.5e-3)]


def emps(campaign: Campaign, d: Diagnosis) -> Claims:
    claims = [("dry friction named", "dry_friction" in names(d))]
    before, after = (inverse_dynamics(campaign, p) for p in (d.before, d.after))
    return [*claims, (f"force residual {100 * before:.1f} -> {100 * after:.1f} % (limit 5)", after < 0.05)]


def inverse_dynamics(campaign: Campaign, parameters: ParameterSet) -> float:
    """Share of the force that the law leaves, from the measured motion, held-out part, offset fitted, 20 Hz."""
    measurement = next(m for m in campaign.measurements if m.entry.role == "heldout")
    record = measurement.recording
    rate = record.sample_rate
    position = low_pass(record["position"], rate, 20.0)
    velocity = np.gradient(position, 1.0 / rate)
    acceleration = np.gradient(velocity, 1.0 / rate)
    law = parameters.number("mass_kg") * acceleration + parameters.number("damping_N_s_m") * velocity
    law += parameters.number("stiffness_N_m", 0.0) * position
    friction = parameters.effects.get("dry_friction")
    if friction:
        force, rounding = (float(friction[name].value) for name in ("F_c_N", "rounding_m_s"))
        if rounding:
            law += force * np.tanh(velocity / rounding)
        else:
            law += force * dahl(position, force / float(friction["element_stiffness_N_m"].value))
    measured = low_pass(record["force"], rate, 20.0)
    rest = measured - low_pass(law, rate, 20.0)
    inner = slice(200, -200)  # derivatives at the ends are the filter's
    rest = rest[inner] - rest[inner].mean()
    return float(np.linalg.norm(rest) / np.linalg.norm(measured[inner] - measured[inner].mean()))


def dahl(position: np.ndarray, travel: float) -> np.ndarray:
    """Dahl's friction over its limit, along a measured path."""
    found = np.zeros(len(position))
    for n, step in enumerate(np.diff(position)):
        end = np.sign(step)
        found[n + 1] = end + (found[n] - end) * np.exp(-abs(step) / travel)
    return found


def pendulum(campaign: Campaign, d: Diagnosis) -> Claims:
    before, after = heldout_rms(campaign, d.before), heldout_rms(campaign, d.after)
    (b,), (a,) = ([share for _, share in found.values()] for found in (before, after))
    text = f"held-out error {100 * b:.1f} -> {100 * a:.1f} % (limit: half)"
    return [("dry friction named", "dry_friction" in names(d)), (text, a <= 0.5 * b)]


def bouc_wen(campaign: Campaign, d: Diagnosis) -> Claims:
    before, after = heldout_rms(campaign, d.before), heldout_rms(campaign, d.after)
    key = "multisine-test.csv"
    text = "; ".join(f"{name} {100 * before[name][1]:.1f} -> {100 * after[name][1]:.1f} %" for name in after)
    return [("hysteresis named", "hysteresis" in names(d)), (f"{text} (limit 8)", after[key][1] < 0.08)]


def no_sawtooth(campaign: Campaign, d: Diagnosis) -> Claims:
    said = {*names(d), *(tie for effect in d.effects for tie in effect.indistinguishable_from)}
    return [("no stick-slip claimed", "stribeck" not in said)]


def hammer(campaign: Campaign, d: Diagnosis) -> Claims:
    return [("a second mode named, or unlisted", bool(names(d) & {"flexible_mast", "unlisted"}))]


REAL: dict[str, tuple[tuple[str, ...], Callable[[Campaign, Diagnosis], Claims]]] = {
    "silverbox": (("nonlinear_stiffness",), silverbox),
    "emps": (("dry_friction",), emps),
    "reaction_pendulum": (("dry_friction", "nonlinear_stiffness"), pendulum),
    "bouc_wen_simulated": (("hysteresis",), bouc_wen),
    "friction_pull": (("cable_compliance",), no_sawtooth),
    "friction_pull_unnumbered": (("load_cell_drift",), no_sawtooth),
    "lvm_hammer": (("unlisted",), hammer),
}


def judge(folder: Path, write: Path | None) -> dict[str, Any]:
    """One real session; its ``remarks`` say which demands hold."""
    truth, claims = REAL[folder.name]
    campaign = load(folder)
    row, found = row_of(folder.name, truth, lambda: diagnose(campaign), {}, family="real", engine=engine())
    if found is not None:
        held = claims(campaign, found)
        row["outcome"] = "holds" if all(ok for _, ok in held) else "FAILS"
        row["remarks"] = [f"{'yes' if ok else 'NO '} {text}" for text, ok in held]
        row["floor"] = row["floor_said"]
        if write is not None:
            write_diagnosis(found, campaign, write / folder.name)
    return row
