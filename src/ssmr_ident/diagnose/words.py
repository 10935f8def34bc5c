"""What a diagnosis says in sentences, with its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.diagnosis import UNIT, Conflict, NamedEffect, PredictionQuality
from ssmr_ident.physics.effects import CATALOGUE, unlisted

LAWS = {
    "translation_coupling": "M q'' + D q' + K q = 0 with q = (x, y, z, roll, pitch, yaw)",
    "nonlinear_stiffness": "F = K s + k3 s^3",
    "dry_friction": "F = k z, dz/dt = v - |v| k z/F_c",
    "hysteresis": "F = alpha K s + (1 - alpha) K z, dz/dt = v (1 - |z/y|^n (gamma + sign(v z)/2))",
    "quadratic_damping": "F = D v + d2 v |v|",
    "viscoelastic_relaxation": "F = K s + D v + K_m z, dz/dt = v - z/tau",
    "free_play": "F = K dz(s), no force for |s| < gap/2",
    "flexible_mast": "m q'' = -m w^2 q - 2 zeta m w q' - m x_P'', w = 2 pi f_mast",
    "com_offset": "p_i -> p_i - (offset_x, offset_y, 0)",
    "wheel_lift": "N = max(0, K_z s_z + D_z s_z')",
    "motor_belt": "m_rim b'' = -K_b b - D_b b' + sum of F_x over the side",
    "cable_compliance": "1/K_total = 1/K_steel + 1/K_cable",
    "stribeck": "mu(u) = mu_s (r + (1 - r) exp(-(u/v_s)^exponent)), r = kinetic_share",
    "load_sensitive_friction": "mu(N) = mu (N/N_0)^(-exponent)",
    "load_dependent_friction": "F = (F_c + c |tau_drive - tau_load|) tanh(v/v_r)",
    "slip_coupling": "mu -> mu min(|slip|/(lambda_max |r omega|), 1)",
    "rolling_resistance": "F_x = -c_rr N sign(v_x)",
    "sensor_saturation": "y = max(-range, min(range, a))",
    "sensor_bandwidth": "H(s) = 1/(1 + sqrt(2) s/w + (s/w)^2), w = 2 pi bandwidth",
    "sensor_delay": "y(t) = x(t - delay)",
    "sensor_misalignment": "a_log = (R_z R_y R_x)^T a",
    "load_cell_drift": "F_log = F (1 + g t) + z t",
}
"""Laws in plain text, for reports that cannot set formulas."""

FORMS = {
    ("nonlinear_stiffness", "k3_share_1_m2", "knee_share"): (
        "F = K s + (k3 + k3_share K) s^3 + knee_share K sign(s) max(|s| - knee, 0)"
    ),
    ("nonlinear_stiffness", "k3_share_1_m2"): "F = K s + k3_share K s^3",
    ("nonlinear_stiffness", "sine_share"): "M = K ((1 - sine_share) s + sine_share sin s)",
    ("nonlinear_stiffness", "k3_N_m3", "knee_share"): "F = K s + k3 s^3 + knee_share K sign(s) max(|s| - knee, 0)",
    ("nonlinear_stiffness", "knee_share"): "F = K s + knee_share K sign(s) max(|s| - knee, 0)",
    ("dry_friction", "rounding_m_s"): "F = F_c tanh(v/rounding)",
    ("dry_friction", "slider"): "F = k z, z follows s and slides at |z| = F_c/k",
    ("sensor_bandwidth", "order"): "H(s) = 1/(1 + s/w), w = 2 pi bandwidth",
}
"""The same where parameters that are not 0 choose another formula; the first that they choose."""


def readable(effect_id: str) -> str:
    names = {"unlisted": "a force that no listed effect makes"}
    return " and ".join(names.get(part, part.replace("_", " ")) for part in effect_id.split("+"))


def law(effect_id: str, parameters: Mapping[str, Estimate]) -> str:
    """The law as plain text."""
    if effect_id == "unlisted":
        return unlisted.law({name: float(e.value) for name, e in parameters.items()})
    for (name, *chosen), other in FORMS.items():
        if name == effect_id and all(p in parameters and float(parameters[p].value) != 0.0 for p in chosen):
            return other
    return LAWS.get(effect_id) or CATALOGUE[effect_id].equation


def told(effect_id: str, parameters: Mapping[str, Estimate]) -> str:
    """The catalogue's sentence with the fitted numbers."""
    numbers = ", ".join(f"{name} = {estimate}" for name, estimate in parameters.items() if not estimate.fixed)
    return CATALOGUE[effect_id].sentence.rstrip(".") + (f": {numbers}." if numbers else ".")


def missing(
    effects: Sequence[NamedEffect], heldout: PredictionQuality, metric: str, conflicts: Sequence[Conflict]
) -> str:
    """The verdict in one sentence."""
    unit = UNIT[metric]
    names = " and ".join(readable(e.id) for e in effects)
    ties = [other for e in effects for other in e.indistinguishable_from]
    doubt = f" (or {', '.join(map(readable, ties))}: these recordings cannot tell)" if ties else ""
    hidden = ""
    if conflicts:
        worst = conflicts[0]
        hidden = f"; it had been hidden in {worst.parameter} ({worst.sigmas:+.1f} standard deviations)"
    verb, why = "falls", ""
    if heldout.after > heldout.before:
        verb = "goes"
        if any(e.id == "stribeck" for e in effects):
            why = " (sample by sample: teeth come at other times in every run, and were compared by their sizes)"
    return (
        f"The model leaves out {names}{doubt}: on recordings never fitted the error {verb} from {heldout.before:.3g} "
        f"to {heldout.after:.3g} {unit}{why}, noise alone leaves {heldout.noise_floor:.3g} {unit}{hidden}."
    )


def nothing(heldout: PredictionQuality, metric: str, tried: int) -> str:
    unit = UNIT[metric]
    return (
        f"Nothing is missing: the baseline leaves {heldout.before:.3g} {unit} on recordings never fitted, noise alone "
        f"{heldout.noise_floor:.3g} {unit}, and none of {tried} effects looked at explains any of the rest."
    )


def undetermined(heldout: PredictionQuality, metric: str, tried: Sequence[str], shown: str = "") -> str:
    """``shown`` says where something is missing that recordings never fitted do not show."""
    unit = UNIT[metric]
    names = ", ".join(map(readable, tried[:3]))
    closest = f"; the nearest that were tried are {names}" if names else ""
    shown = shown or (
        f"the baseline leaves {heldout.before:.3g} {unit} on recordings never fitted where noise alone leaves "
        f"{heldout.noise_floor:.3g} {unit}"
    )
    return f"Something is missing that these recordings cannot name: {shown}{closest}."
