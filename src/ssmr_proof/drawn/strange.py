"""Physics that the catalogue does not list, drawn at random: what `unlisted` is for."""

from __future__ import annotations

import math

import numpy as np

from ssmr_proof.drawn.hidden import Change, Hidden
from ssmr_proof.drawn.springs import graded


def uneven_damper(random: np.random.Generator, strength: float) -> Hidden:
    """A damper that resists one direction more."""
    a = float(random.choice([-1.0, 1.0])) * graded(strength, 0.35, 0.9)
    how = "F = d v (1 + a sign v)"
    return Hidden("unlisted", "uneven damper", {"asymmetry": a}, how, Change({"uneven_damper": a}), strength)


def reach_damper(random: np.random.Generator, strength: float, reach_m: float) -> Hidden:
    """A damper that resists more the further out it is."""
    b = graded(strength, 0.8, 6.0) / reach_m**2
    how = "F = d v (1 + b s^2)"
    return Hidden("unlisted", "damper grows with way", {"reach_1_m2": b}, how, Change({"reach_damper": b}), strength)


def rig_reach_damper(random: np.random.Generator, strength: float) -> Hidden:
    """On a rig that moves a millimetre."""
    return reach_damper(random, strength, 1e-3)


def tire_reach_damper(random: np.random.Generator, strength: float) -> Hidden:
    """In tires that move a millimetre and more along x."""
    return reach_damper(random, strength, 1.5e-3)


def root_damper(random: np.random.Generator, strength: float) -> Hidden:
    """Between dry friction and a linear damper: the root of the speed."""
    c = graded(strength, 1.5, 10.0)
    how = "F = c sign(v) sqrt|v|"
    laws = {"root_damper": c}
    return Hidden("unlisted", "root of the speed", {"root_N_s05_m05": c}, how, Change(laws), strength)


def uneven_spring(random: np.random.Generator, strength: float) -> Hidden:
    """Stiffer one way than the other. A stiffness that changes with deflection too, so either name is right."""
    a = float(random.choice([-1.0, 1.0])) * graded(strength, 0.06, 0.4)
    how = "F = k s for s < 0, (1 + a) k s for s > 0"
    change = Change({"uneven_spring": a})
    return Hidden("unlisted", "uneven spring", {"asymmetry": a}, how, change, strength, ("nonlinear_stiffness",))


def pulsing_spring(random: np.random.Generator, strength: float) -> Hidden:
    """A stiffness that goes up and down with time."""
    share, hertz = graded(strength, 0.03, 0.2), float(random.uniform(0.3, 1.5))
    how = "F = k s (1 + a sin(2 pi f t))"
    laws = {"pulse_share": share, "pulse_rad_s": 2.0 * math.pi * hertz}
    parameters = {"share": share, "pulse_Hz": hertz}
    return Hidden("unlisted", "pulsing spring", parameters, how, Change(laws), strength)


def absorber(random: np.random.Generator, strength: float) -> Hidden:
    """A second mass on a spring on a rig's mass."""
    share, hertz, ratio = (
        graded(strength, 0.015, 0.15),
        float(random.uniform(4.0, 14.0)),
        float(random.uniform(0.02, 0.06)),
    )
    how = "part of the mass rides on a spring of its own"
    parameters = {"mass_share": share, "f_mast_Hz": hertz, "damping_ratio": ratio}
    change = Change(absorber=(share, hertz, ratio))
    return Hidden("unlisted", "second mass", parameters, how, change, strength, ("flexible_mast",))
