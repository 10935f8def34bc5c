"""rig.yaml of a rig with one mass: what the logs tell at first sight, and the mass that the user gives."""

from __future__ import annotations

from collections.abc import Sequence

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.physics.rig import RIG_KEYS
from ssmr_ident.session.parameters_text import parameters_text
from ssmr_ident.workflows.new.first_look import FirstLook, first_look
from ssmr_ident.workflows.new.log import LogGuess

FIRST_LOOK = "first look at the logs: a start for the fit, no knowledge"
UNITS = {"mass_kg": "kg", "damping_N_s_m": "N s/m", "stiffness_N_m": "N/m", "inertia_kg_m2": "kg m^2"}
UNITS |= {"damping_N_m_s_rad": "N m s/rad", "stiffness_N_m_rad": "N m/rad"}
_NOTHING = FirstLook(0.02 * 2 * 31.4, 31.4**2, None, "nothing: 5 Hz and 2 % are taken")
"""Where no log tells a frequency, a fit may still find one from a start in the middle of what labs have."""


def rig_text(name: str, guesses: Sequence[LogGuess], mass: float | None) -> str:
    """rig.yaml: mass, damper and spring at first sight."""
    rotary = any(guess.rotary for guess in guesses)
    keys = RIG_KEYS[rotary]
    found = first_look(guesses) or _NOTHING
    what = "inertia" if rotary else "mass"
    if mass is not None:
        own, source = mass, "given to ident new"
    elif found.mass is not None:
        own, source = found.mass, FIRST_LOOK
    else:
        unit = UNITS[keys[0]]
        own = 1.0
        source = (
            f"nobody said: with 1 {unit}, stiffness and damping are those of a {unit}; give it by --{_option(rotary)}"
        )
    held = found.mass is None  # without a measured force only ratios to it show, and nothing could move it
    values = (own, rounded(found.damping * own), rounded(found.stiffness * own))
    estimates = {
        keys[0]: Estimate(own, None, UNITS[keys[0]], source, fixed=held),
        keys[1]: Estimate(values[1], None, UNITS[keys[1]], FIRST_LOOK),
        keys[2]: Estimate(values[2], None, UNITS[keys[2]], FIRST_LOOK, fixed=found.springless),
    }
    lines = [
        "# Written by `ident new`. Add std: the standard deviation that you believe in; left out, it means unknown.",
        "# fixed: true leaves a value alone; a stiffness of 0 with fixed: true means that there is no spring.",
        f"# Stiffness and damping are {found.stiffness:.4g} and {found.damping:.3g} times the {what}, by {found.said}.",
    ]
    return "\n".join([*lines, ""]) + parameters_text(ParameterSet(name, estimates))


def _option(rotary: bool) -> str:
    return "inertia-kg-m2" if rotary else "mass-kg"


def rounded(value: float) -> float:
    """To six digits, as a first look is printed."""
    return float(f"{value:.6g}")
