"""Physics dressed as other physics: sizes chosen so that one effect looks like another, or like a parameter.

A loop that yields early and a slider behind a soft spring are one element, its corners more or less round: either
name is right for both.
"""

from __future__ import annotations

import numpy as np

from ssmr_proof.drawn.hidden import Change, Hidden
from ssmr_proof.drawn.springs import graded, slopes
from ssmr_proof.plant.robot_model import Frame


def loop_like_friction(random: np.random.Generator, strength: float) -> Hidden:
    """Bouc-Wen that yields long before the motion ends: nearly a slider behind a spring."""
    reach, stiffness = float(random.uniform(2e-5, 6e-5)), 18e3
    share = graded(strength, 0.3, 1.5) / (stiffness * reach)
    share = min(share, 0.8)
    how = "F = alpha K s + (1 - alpha) K z, dz/dt = v (1 - (z/y)^2) while z grows, v while it shrinks; y is small"
    laws = {"loop_share": share, "loop_yield": reach}
    parameters = {"alpha": 1.0 - share, "yield_m": reach}
    return Hidden("hysteresis", "early yield", parameters, how, Change(laws), strength, ("dry_friction",))


def friction_like_loop(random: np.random.Generator, strength: float) -> Hidden:
    """A slider behind so soft a spring that it bends the backbone as a loop does."""
    force, stiffness = graded(strength, 0.3, 1.5), float(random.uniform(3e3, 6e3))
    how = "a slider that bears F_c, behind a soft spring"
    laws = {"friction": force, "friction_stiffness": stiffness}
    parameters = {"F_c_N": force, "element_stiffness_N_m": stiffness}
    return Hidden("dry_friction", "soft slider", parameters, how, Change(laws), strength, ("hysteresis",))


def quick_relaxation(random: np.random.Generator, strength: float) -> Hidden:
    """A Maxwell branch so quick that it is nearly a damper."""
    k, tau = graded(strength, 2500.0, 9000.0), float(random.uniform(4e-3, 1e-2))
    how = "a spring K_m in series with a dashpot (time tau) beside the spring"
    laws = {"maxwell": k, "maxwell_time": tau}
    parameters = {"K_m_N_m": k, "tau_s": tau}
    return Hidden("viscoelastic_relaxation", "quick branch", parameters, how, Change(laws), strength)


def slow_relaxation(random: np.random.Generator, strength: float) -> Hidden:
    """A Maxwell branch so slow that in a pull it looks like a drifting load cell."""
    k, tau = graded(strength, 1500.0, 6000.0), float(random.uniform(6.0, 15.0))
    how = "a spring K_m in series with a dashpot (time tau) beside the tire's spring, in the ratio of K"
    laws = {"maxwell": k, "maxwell_time": tau}
    parameters = {"K_m_N_m": k, "tau_s": tau}
    return Hidden("viscoelastic_relaxation", "slow branch", parameters, how, Change(laws), strength)


def frame_on_the_line(random: np.random.Generator, strength: float) -> Hidden:
    """A mast tuned to the robot's own roll, so that its line hides in the robot's."""
    mass, hertz = graded(strength, 0.3, 1.5), float(random.uniform(5.6, 6.6))
    how = "part of the robot's mass sways at the frequency of roll"
    parameters = {"f_mast_Hz": hertz, "mass_kg": mass, "height_above_com_m": 0.3, "damping_ratio": 0.05}
    change = Change(frame=Frame("carriage", hertz, mass, 0.3, 0.05))
    return Hidden("flexible_mast", "tuned", parameters, how, change, strength)


def softening_like_cable(random: np.random.Generator, strength: float) -> Hidden:
    """Tires that give way under load, as a cable that stretches would have it."""
    return slopes("softening slopes", float(random.uniform(4e-4, 1e-3)), -graded(strength, 0.25, 0.5), strength)


def gain_drift(random: np.random.Generator, strength: float) -> Hidden:
    """A load cell whose gain wanders: as slack in the slope as a softer tire."""
    rate = float(random.choice([-1.0, 1.0])) * graded(strength, 1.5e-3, 8e-3)
    how = "the load cell's gain wanders linearly in time"
    return Hidden("load_cell_drift", "gain", {"gain_drift_1_s": rate}, how, Change(gain_drift=rate), strength)
