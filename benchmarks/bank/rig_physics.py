"""What may be left out of a rig, and how large: sizes are relative to what the rig does anyway.

``size`` runs from 0, about the limit of what eight recordings can show, to 1, several times what the practice
sessions of the field hold. Between them a size is geometric.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bank.laws import law
from ssmr_ident.physics.rig import Rig


@dataclass(frozen=True)
class Scale:
    """What the linear rig does under the strongest recording: rms displacement [m] and velocity [m/s]."""

    rig: Rig
    displacement: float
    velocity: float
    seconds: float

    @property
    def spring(self) -> float:
        """Rms spring force [N]."""
        return self.rig.stiffness * self.displacement

    @property
    def omega(self) -> float:
        return float(np.sqrt(self.rig.stiffness / self.rig.mass))


@dataclass(frozen=True)
class Physics:
    """Left-out physics of a rig.

    Parameters
    ----------
    id : str
        Of the catalogue, or ``unlisted``.
    parameters : dict of str to float
        The catalogue's, where the formula is the catalogue's; empty elsewhere.
    rows : tuple of (WIDTH,) float
        Laws of the plant.
    formula : str
        In words, empty for the catalogue's own.
    """

    id: str
    parameters: dict[str, float]
    rows: tuple[np.ndarray, ...]
    formula: str = ""


Maker = Callable[[float, Scale, np.random.Generator], Physics]


def between(size: float, least: float, largest: float) -> float:
    """Geometric."""
    return float(least * (largest / least) ** size)


def _hardening(size: float, at: Scale, random: np.random.Generator) -> Physics:
    # softening stays weak enough that the spring still pulls back at four times the rms displacement
    soften = random.random() < 0.3
    k3 = between(size, 0.002, 0.012 if soften else 0.15) * at.rig.stiffness / at.displacement**2
    k3 *= -1.0 if soften else 1.0
    return Physics("nonlinear_stiffness", {"k3_N_m3": k3}, (law("cubic", k3),))


def _friction(size: float, at: Scale, random: np.random.Generator) -> Physics:
    force, stiffness = between(size, 0.003, 0.06) * at.spring, random.uniform(5.0, 15.0) * at.rig.stiffness
    parameters = {"F_c_N": force, "element_stiffness_N_m": stiffness}
    return Physics("dry_friction", parameters, (law("dahl", force, stiffness),))


def _hysteresis(size: float, at: Scale, random: np.random.Generator) -> Physics:
    share, yields = between(size, 0.01, 0.3), random.uniform(0.3, 0.8) * at.displacement
    parameters = {"alpha": 1.0 - share, "yield_m": yields}
    return Physics("hysteresis", parameters, (law("bouc_wen", share * at.rig.stiffness, yields, 2.0, 0.5),))


def _quadratic(size: float, at: Scale, random: np.random.Generator) -> Physics:
    d2 = between(size, 0.05, 1.5) * at.rig.damping / at.velocity
    return Physics("quadratic_damping", {"d2_N_s2_m2": d2}, (law("quadratic", d2),))


def _relaxation(size: float, at: Scale, random: np.random.Generator) -> Physics:
    stiffness, tau = between(size, 0.02, 0.4) * at.rig.stiffness, between(random.random(), 0.3, 5.0) / at.omega
    return Physics("viscoelastic_relaxation", {"K_m_N_m": stiffness, "tau_s": tau}, (law("maxwell", stiffness, tau),))


def _play(size: float, at: Scale, random: np.random.Generator) -> Physics:
    gap = between(size, 0.01, 0.4) * at.displacement
    row = law("rounded_play", at.rig.stiffness, 0.5 * gap, 0.1 * gap)
    return Physics("free_play", {"gap_m": gap, "rounding": 0.1}, (row,))


def _slow_sensor(size: float, at: Scale, random: np.random.Generator) -> Physics:
    return Physics("sensor_bandwidth", {"bandwidth_hz": between(size, 300.0, 30.0)}, ())


def _clipping(size: float, at: Scale, random: np.random.Generator) -> Physics:
    # as a share of the largest acceleration; the session turns it into m/s²
    return Physics("sensor_saturation", {"share_of_peak": between(size, 0.9, 0.4)}, ())


LISTED: dict[str, Maker] = {
    "nonlinear_stiffness": _hardening, "dry_friction": _friction, "hysteresis": _hysteresis,
    "quadratic_damping": _quadratic, "viscoelastic_relaxation": _relaxation, "free_play": _play,
    "sensor_bandwidth": _slow_sensor, "sensor_saturation": _clipping,
}  # fmt: skip


def _two_slopes(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law("two_slopes", between(size, 0.03, 0.8) * at.rig.stiffness, random.uniform(0.6, 1.4) * at.displacement)
    return Physics("nonlinear_stiffness", {}, (row,), "hardening as two slopes")


def _exponential(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law("sinh", between(size, 0.01, 0.5) * at.rig.stiffness, random.uniform(0.7, 1.2) * at.displacement)
    return Physics("nonlinear_stiffness", {}, (row,), "hardening as a sinh")


def _saturating(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law("tanh_spring", between(size, 0.03, 0.5) * at.rig.stiffness, random.uniform(1.0, 2.0) * at.displacement)
    return Physics("nonlinear_stiffness", {}, (row,), "softening as a tanh")


def _coulomb(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law("tanh_friction", between(size, 0.003, 0.06) * at.spring, random.uniform(0.005, 0.03) * at.velocity)
    return Physics("dry_friction", {}, (row,), "friction as the tanh of the velocity")


def _slider(size: float, at: Scale, random: np.random.Generator) -> Physics:
    stiffness = random.uniform(3.0, 15.0) * at.rig.stiffness
    row = law("jenkins", between(size, 0.003, 0.06) * at.spring, stiffness)
    return Physics("dry_friction", {}, (row,), "friction as a spring in series with a slider")


def _falling(size: float, at: Scale, random: np.random.Generator) -> Physics:
    force, width = between(size, 0.003, 0.06) * at.spring, 0.01 * at.velocity
    row = law("stribeck_friction", force, width, random.uniform(0.1, 0.5), random.uniform(0.05, 0.2) * at.velocity)
    return Physics("dry_friction", {}, (row,), "friction that is larger near rest")


def _sharp_play(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law("play", at.rig.stiffness, 0.5 * between(size, 0.01, 0.4) * at.displacement)
    return Physics("free_play", {}, (row,), "play with sharp corners")


def _soft_play(size: float, at: Scale, random: np.random.Generator) -> Physics:
    half = 0.5 * between(size, 0.01, 0.4) * at.displacement
    row = law("smooth_play", at.rig.stiffness, half, random.uniform(0.1, 0.3) * half)
    return Physics("free_play", {}, (row,), "play with softplus corners")


def _other_loop(size: float, at: Scale, random: np.random.Generator) -> Physics:
    share, yields = between(size, 0.01, 0.3), random.uniform(0.3, 0.8) * at.displacement
    row = law("bouc_wen", share * at.rig.stiffness, yields, 1.0, random.uniform(0.4, 0.9))
    return Physics("hysteresis", {}, (row,), "Bouc-Wen with exponent 1 and another beta")


def _sliders(size: float, at: Scale, random: np.random.Generator) -> Physics:
    share, yields = between(size, 0.01, 0.3), random.uniform(0.3, 0.8) * at.displacement
    return Physics(
        "hysteresis", {}, (law("iwan", share * at.rig.stiffness, yields),), "three sliders in parallel (Iwan)"
    )


def _power(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law("power_damping", between(size, 0.05, 1.5) * at.rig.damping / at.velocity**0.8, 1.8)
    return Physics("quadratic_damping", {}, (row,), "damping with |v|^1.8")


def _two_branches(size: float, at: Scale, random: np.random.Generator) -> Physics:
    stiffness, tau = 0.5 * between(size, 0.02, 0.4) * at.rig.stiffness, between(random.random(), 0.3, 3.0) / at.omega
    row = law("two_maxwells", stiffness, tau, stiffness, 6.0 * tau)
    return Physics("viscoelastic_relaxation", {}, (row,), "relaxation with two branches")


OTHER: tuple[Maker, ...] = (
    _two_slopes, _exponential, _saturating, _coulomb, _slider, _falling, _sharp_play, _soft_play, _other_loop,
    _sliders, _power, _two_branches,
)  # fmt: skip


def _one_sided_damper(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law("one_sided_damper", between(size, 0.1, 0.9) * at.rig.damping * random.choice([-1.0, 1.0]))
    return Physics("unlisted", {}, (row,), "a damper that resists one way more than the other")


def _one_sided_spring(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law(
        "one_sided_spring", between(size, 0.03, 0.5) * at.rig.stiffness, random.uniform(0.0, 0.6) * at.displacement
    )
    return Physics("unlisted", {}, (row,), "a spring that touches on one side")


def _creeping(size: float, at: Scale, random: np.random.Generator) -> Physics:
    row = law("creeping_spring", between(size, 0.01, 0.2) * at.rig.stiffness * random.choice([-1.0, 1.0]), at.seconds)
    return Physics("unlisted", {}, (row,), "a stiffness that changes over each recording")


def _friction_by_place(size: float, at: Scale, random: np.random.Generator) -> Physics:
    force = between(size, 0.01, 0.25) * at.spring
    row = law("friction_by_place", force, 0.01 * at.velocity, 0.1 * at.displacement)
    return Physics("unlisted", {}, (row,), "dry friction on one side of the travel only")


UNLISTED: tuple[Maker, ...] = (_one_sided_damper, _one_sided_spring, _creeping, _friction_by_place)
