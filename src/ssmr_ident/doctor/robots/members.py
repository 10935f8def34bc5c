"""What may stand beside a robot's baseline: effects of the catalogue by kind, and where their fits begin."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.diagnose.sizes import limits_of, sizes_of
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.physics.effect import Effect, Sized
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.extended import LINEAR

Array = np.ndarray

STATIC, MEMORY, EXTRA, GEOMETRY, SENSOR = "static_force", "memory", "extra_motion", "geometry", "sensor_chain"
CHANGING, GROUND = "changing", "ground_and_grip"

KINDS = {
    "nonlinear_stiffness": STATIC,
    "quadratic_damping": STATIC,
    "free_play": STATIC,
    "wheel_lift": STATIC,
    "unlisted": STATIC,
    "dry_friction": MEMORY,
    "hysteresis": MEMORY,
    "viscoelastic_relaxation": MEMORY,
    "flexible_mast": EXTRA,
    "motor_belt": EXTRA,
    "com_offset": GEOMETRY,
    "sensor_misalignment": SENSOR,
    "sensor_bandwidth": SENSOR,
    "sensor_saturation": SENSOR,
}
"""Effects that decays show, by kind."""

IN_FORCES = {
    "cable_compliance": EXTRA,
    "load_cell_drift": CHANGING,
    "stribeck": STATIC,
    "rolling_resistance": STATIC,
    "load_sensitive_friction": GROUND,
    "slip_coupling": GROUND,
}
"""Effects that force logs alone show, by kind."""

BY_KIND = {**KINDS, **IN_FORCES, "translation_coupling": GEOMETRY}
"""All effects that recordings of a robot show beside its baseline, by kind."""

ANY = "any shape"
SMOOTH = ("c_abs_v_N_s_m", "c_s2_N_m2", "c_v2_N_s2_m2", "c_sv_N_s_m2", "c_s2v_N_s_m3", "c_v3_N_s3_m3",
          "c_s_abs_v_N_s_m2")  # fmt: skip
"""Terms of the member that takes any static shape, beside those of hardening and quadratic damping."""

LITTLE = 1e-3
"""Share of the force at which quadratic damping, which has one sign, begins in it."""


@dataclass(frozen=True, eq=False)
class Member:
    """A model with one effect more, and where a fit of it begins.

    Parameters
    ----------
    id, kind, form : str
    model : Model
    own : (k,) float
        Coordinates of what is new.
    generic : bool
        Whether it takes any shape of its kind.
    """

    id: str
    kind: str
    form: str
    model: Model
    own: Array
    generic: bool = False

    @property
    def linear(self) -> bool:
        return set(self.model.ids) <= set(LINEAR)

    def from_nothing(self) -> Member:
        """The same, what may have either sign begun at nought: near a fit that follows the recordings less is missing
        than a probe holds."""
        free = self.model.free[len(self.model.free) - len(self.own) :]
        signed = np.array([not c.unknown.logarithmic for c in free], dtype=bool)
        return replace(self, own=np.where(signed, 0.0, self.own))


def members(fit: JointFit, names: Iterable[str] = KINDS) -> list[Member]:
    """Effects that may be added to a fit's model, from each of their probes; by default all that decays show."""
    sizes, found = sizes_of(fit), []
    for name in (n for n in names if n not in fit.model.held and n != "unlisted"):
        effect = CATALOGUE[name]
        limits = limits_of(fit, effect)
        forms: dict[frozenset[str], Member] = {}
        for probe in effect.probes:
            at = _at(probe, sizes)
            if not all(math.isfinite(value) for value in at.values()):
                continue
            at = {p.name: float(np.clip(at[p.name], p.lower, p.upper)) for p in effect.parameters if p.name in at}
            at |= {n: float(np.clip(at[n], *ends)) for n, ends in limits.items() if n in at}
            for held in _held(effect):
                key = frozenset((*at, *(f"{n} = {v}" for n, v in held.items())))
                if key not in forms:  # one prior for all probes of a formula
                    forms[key] = member_at(fit.model, name, at, held, limits)
                    found.append(forms[key])
                else:
                    first = forms[key]
                    free = first.model.free[len(fit.model.free) :]
                    found.append(replace(first, own=np.array([c.unknown.scaled(at[c.parameter.name]) for c in free])))
    return found


def _at(probe: Mapping[str, float | Sized], sizes: Mapping[str, float]) -> dict[str, float]:
    return {name: v.value(sizes) if isinstance(v, Sized) else float(v) for name, v in probe.items()}


def _held(effect: Effect) -> list[dict[str, float]]:
    names = list(effect.holds)
    return [dict(zip(names, values, strict=True)) for values in itertools.product(*effect.holds.values())]


def member_at(
    model: Model,
    name: str,
    at: Mapping[str, float],
    held: Mapping[str, float],
    limits: Mapping[str, tuple[float, float]],
) -> Member:
    """An effect beside a model, its parameters begun at given values, others of it held at theirs."""
    new, own = model.with_effect(name, at, {n: abs(v) for n, v in at.items()}, limits)
    new = replace(new, held={**new.held, name: {**new.held[name], **held}})
    form = ", ".join([*at, *(f"{n} = {v:g}" for n, v in held.items())])
    kind = STATIC if name == "dry_friction" and "rounding_m_s" in at else BY_KIND[name]
    return Member(name, kind, form, new, own)


def any_shape(fit: JointFit) -> list[Member]:
    """Members of the tires along x and y that hold no law of the catalogue."""
    return [any_static(fit), changing(fit)]


def any_static(fit: JointFit) -> Member:
    """f(s, v) of the tires along x and y, smooth; linear in its coefficients, which begin at nought."""
    sizes = sizes_of(fit)
    force, s, v = sizes["force"], sizes["deflection"], sizes["speed"]
    scale = {"c_abs_v_N_s_m": v, "c_s2_N_m2": s**2, "c_v2_N_s2_m2": v**2, "c_sv_N_s_m2": s * v,
             "c_s2v_N_s_m3": s**2 * v, "c_v3_N_s3_m3": v**3, "c_s_abs_v_N_s_m2": s * v}  # fmt: skip
    model, own = fit.model, np.zeros(0)
    for name, at in (
        ("nonlinear_stiffness", {"k3_N_m3": force / s**3, "k3_share_1_m2": 1.0 / s**2}),
        ("quadratic_damping", {"d2_N_s2_m2": force / v**2}),
        ("unlisted", {term: force / scale[term] for term in SMOOTH}),
    ):
        if name not in model.held:
            begun = {n: LITTLE * value if n == "d2_N_s2_m2" else 0.0 for n, value in at.items()}
            model, more = model.with_effect(name, begun, {n: 0.1 * value for n, value in at.items()})
            own = np.concatenate([own, more])
    return Member("unlisted", STATIC, ANY, model, own, True)


def changing(fit: JointFit) -> Member:
    """Stiffness and damping of the tires along x and y that change evenly over each recording, from nought."""
    sizes = sizes_of(fit)
    force, s, v, t = sizes["force"], sizes["deflection"], sizes["speed"], sizes["duration"]
    scale = {"c_ts_N_m_s": 0.1 * force / (s * t), "c_tv_N_m": 0.1 * force / (v * t)}
    model, own = fit.model.with_effect("unlisted", dict.fromkeys(scale, 0.0), scale)
    return Member("unlisted", CHANGING, f"{ANY}, over time", model, own, True)
