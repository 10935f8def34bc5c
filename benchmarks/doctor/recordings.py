"""Open recordings of others, and what the answer to each must show."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from doctor.folders import SHARED
from doctor.frozen import Case
from doctor.opened import Opened
from ssmr_ident.compare import predict
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.experiments.campaign import Campaign, load
from ssmr_ident.signals.filters import low_pass

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


def recording_cases() -> Iterator[Case]:
    """Those that lie beside the checkout."""
    return (Case("open", f"recordings/{name}") for name in REAL if (SHARED / "recordings" / name).is_dir())


def from_recordings(key: str) -> Opened:
    """One recording; its claims are held against the answer."""
    folder = SHARED / key
    names, claims = REAL[folder.name]
    campaign = load(folder)
    return Opened(campaign, 0, (names,), claims=lambda diagnosis: claims(campaign, diagnosis))
