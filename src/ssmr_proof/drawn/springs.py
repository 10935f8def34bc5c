"""Effects drawn at random that act beside a spring and a damper: in a tire, or in a rig.

A strength of 0 is the limit: what a refitted baseline leaves on further recordings begins to rise above what it leaves
where nothing is hidden. 1 is plain to see, and below 0 lies what is fainter. Most limits were read off the 300 cases of
three proofs (seeds 7000, 8000, 9000; decision 11 says which). The scale of each family is its own: a deflection of half
a millimetre in decays, a millimetre on rigs, some millimetres in pulls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ssmr_proof.drawn.hidden import Change, Hidden

Draw = Callable[[np.random.Generator, float], Hidden]


def graded(strength: float, weak: float, strong: float) -> float:
    """Between weak and strong on a logarithmic scale.

    >>> graded(0.5, 1.0, 100.0)
    10.0
    """
    return float(weak * (strong / weak) ** strength)


@dataclass(frozen=True)
class Scale:
    """Ranges of one family, (weak, strong) each."""

    cubic: tuple[float, float]
    knee_m: tuple[float, float]
    knee_share: tuple[float, float]
    friction: tuple[float, float]
    quadratic: tuple[float, float]
    maxwell: tuple[float, float]
    maxwell_time: tuple[float, float]
    loop: tuple[float, float]
    loop_yield: tuple[float, float]
    gap: tuple[float, float]


SCALES = {
    "decay": Scale(
        (2e8, 3e9), (2e-4, 5e-4), (0.12, 0.6), (0.12, 2.0), (250.0, 1500.0), (2500.0, 9000.0), (0.02, 0.15),
        (0.04, 0.25), (2e-4, 5e-4), (4e-5, 3e-4),
    ),
    "rig": Scale(
        (4e7, 1.5e9), (4e-4, 1e-3), (0.06, 0.6), (0.1, 1.0), (15.0, 400.0), (400.0, 5000.0), (0.02, 0.2),
        (0.02, 0.2), (2e-4, 6e-4), (2e-5, 2.5e-4),
    ),
    "pull": Scale(
        (2e6, 2e7), (1.5e-3, 3e-3), (0.3, 0.6), (0.3, 3.0), (0.0, 0.0), (1500.0, 8000.0), (0.6, 5.0),
        (0.08, 0.35), (8e-4, 2e-3), (0.0, 0.0),
    ),
}  # fmt: skip


def hardening(scale: Scale) -> Draw:
    """Cubic, or two slopes that harden or soften. A softening cubic would give way altogether further out."""

    def draw(random: np.random.Generator, strength: float) -> Hidden:
        form = str(random.choice(["hardening cubic", "hardening slopes", "softening slopes"], p=[0.5, 0.25, 0.25]))
        if form == "hardening cubic":
            k3 = graded(strength, *scale.cubic)
            how, parameters, laws = "F = K s + k3 s^3", {"k3_N_m3": k3}, {"cubic": k3}
            return Hidden("nonlinear_stiffness", form, parameters, how, Change(laws), strength)
        share = graded(strength, *scale.knee_share) * (1.0 if form.startswith("hard") else -0.6)
        return slopes(form, float(random.uniform(*scale.knee_m)), share, strength)

    return draw


def slopes(form: str, knee: float, share: float, strength: float) -> Hidden:
    """K up to the knee, (1 + share) K beyond, in every spring."""
    how = "F = K s up to the knee, with the slope (1 + share) K beyond it"
    parameters = {"knee_m": knee, "knee_share": share}
    return Hidden("nonlinear_stiffness", form, parameters, how, Change({"knee": knee, "knee_share": share}), strength)


def friction(scale: Scale) -> Draw:
    """A spring with a slider in series, or Dahl's law."""

    def draw(random: np.random.Generator, strength: float) -> Hidden:
        force, stiffness = graded(strength, *scale.friction), float(random.uniform(2e5, 4e5))
        parameters = {"F_c_N": force, "element_stiffness_N_m": stiffness}
        form = str(random.choice(["spring and slider", "Dahl"]))
        laws = {"friction": force, "friction_stiffness": stiffness, "dahl": float(form == "Dahl")}
        how = f"{form} with the sliding force F_c, beside the spring"
        return Hidden("dry_friction", form, parameters, how, Change(laws), strength)

    return draw


def quadratic(scale: Scale) -> Draw:
    """d2 v |v|."""

    def draw(random: np.random.Generator, strength: float) -> Hidden:
        d2 = graded(strength, *scale.quadratic)
        return Hidden(
            "quadratic_damping", "v|v|", {"d2_N_s2_m2": d2}, "F = d2 v |v|", Change({"quadratic": d2}), strength
        )

    return draw


def relaxation(scale: Scale) -> Draw:
    """A Maxwell branch."""

    def draw(random: np.random.Generator, strength: float) -> Hidden:
        k, tau = graded(strength, *scale.maxwell), graded(random.uniform(), *scale.maxwell_time)
        how = "a spring K_m in series with a dashpot (time tau) beside the spring; in a tire in the ratio of K"
        laws = {"maxwell": k, "maxwell_time": tau}
        parameters = {"K_m_N_m": k, "tau_s": tau}
        return Hidden("viscoelastic_relaxation", "one Maxwell branch", parameters, how, Change(laws), strength)

    return draw


def loops(scale: Scale) -> Draw:
    """Bouc-Wen."""

    def draw(random: np.random.Generator, strength: float) -> Hidden:
        share, reach = graded(strength, *scale.loop), float(random.uniform(*scale.loop_yield))
        how = "F = alpha K s + (1 - alpha) K z, dz/dt = v (1 - (z/y)^2) while z grows, v while it shrinks"
        laws = {"loop_share": share, "loop_yield": reach}
        parameters = {"alpha": 1.0 - share, "yield_m": reach}
        return Hidden("hysteresis", "Bouc-Wen", parameters, how, Change(laws), strength)

    return draw


def play(scale: Scale, share_x: float) -> Draw:
    """A gap with sharp corners."""

    def draw(random: np.random.Generator, strength: float) -> Hidden:
        gap = graded(strength, *scale.gap)
        how = "no force of the spring within ± gap/2" + ("" if share_x else ", along y only")
        laws = {"gap": gap, "gap_share_x": share_x}
        return Hidden("free_play", "sharp", {"gap_m": gap}, how, Change(laws), strength)

    return draw
