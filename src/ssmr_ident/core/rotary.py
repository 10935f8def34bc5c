"""Units and names of a rotary rig: moments in place of forces, angles in place of lengths."""

from __future__ import annotations

import re


def rotary(unit: str) -> str:
    """The unit of the same parameter on a rotary rig.

    >>> rotary("N/m^3"), rotary("N s/m"), rotary("kg"), rotary("1/s")
    ('N m/rad^3', 'N m s/rad', 'kg m^2', '1/s')

    A unit that is one of turns already stays:

    >>> rotary("N m/rad^3")
    'N m/rad^3'
    """
    if "rad" in unit or "kg m^2" in unit:
        return unit
    turned = re.sub(r"\bm\b", "rad", unit)
    return re.sub(r"\bkg\b", "kg m^2", re.sub(r"\bN\b", "N m", turned))


def unit_ending(unit: str) -> str:
    """A unit as the names of parameters end in it; nothing for a pure number.

    >>> unit_ending("N s^2/m^2"), unit_ending("1")
    ('_N_s2_m2', '')
    """
    return "" if unit == "1" else "_" + re.sub(r"\W+", "_", unit.replace("^", ""))


def rotary_name(name: str, unit: str) -> str:
    """The name on a rotary rig of a parameter that has ``unit`` on one that moves along a line.

    >>> rotary_name("k3_N_m3", "N/m^3"), rotary_name("F_c_N", "N"), rotary_name("exponent", "1")
    ('k3_N_m_rad3', 'F_c_N_m', 'exponent')
    """
    ending = unit_ending(unit)
    return name.removesuffix(ending) + unit_ending(rotary(unit)) if ending and name.endswith(ending) else name


def both_names(name: str, unit: str) -> dict[str, str]:
    """A parameter's unit by its name on a rig that turns, and on one that moves along a line.

    >>> both_names("knee_m", "m"), both_names("exponent", "1")
    ({'knee_rad': 'rad', 'knee_m': 'm'}, {'exponent': '1'})
    """
    return {rotary_name(name, unit): rotary(unit), name: unit}
