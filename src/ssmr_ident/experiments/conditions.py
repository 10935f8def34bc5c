"""What an operator chooses beforehand."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from ssmr_ident.core.domain import Choice, Number, Text
from ssmr_ident.core.nested_domain import declared
from ssmr_ident.session.entry import CONTROLLER, Entry

_ENTRY = declared(Entry)


@dataclass(frozen=True)
class Conditions:
    """How an experiment is made (units are in the names); each kind of experiment takes what concerns it.

    Parameters
    ----------
    motion : {"roll", "pitch", "yaw"}
        Into which a free response is released.
    amplitude_mm : float
        Displacement of the wheels, or of a rig's mass, at the release.
    amplitude_deg : float
        Angle of a rotary rig at the release.
    start : {"tilted", "vertical"}
        Of a free response: tilted about the CoM, which strains all springs, or the thesis' push of vertical ones only.
    at : str
        Body of a network that is driven, or pushed and let go; empty takes the first, or the last.
    push_N : float
        Steady force from which it is let go in place of ``amplitude_mm``, where not 0.
    direction : {"lateral", "longitudinal"}
        Of a pull.
    angle_deg : float or None
        Of a pull that is neither: from straight behind (0) to the left (90).
    speed_mm_s : float
        Of a testing machine's head.
    height_m : float
        Of the cable above the floor.
    wheels_gripping : tuple of int
        1 rear left, 2 front left, 3 front right, 4 rear right; the others stand on oiled plates.
    cable : str, mapping or None
        ``steel``, ``rope``, or ``stiffness_N_m`` and ``damping_N_s_m``.
    wheel_rate_rad_s : float
        At which the wheels spin while the robot is pulled.
    free_normal : bool
        Whether a dragged wheel can move off the surface.
    yaw_rate_deg_s : float
        Wanted of a swivel.
    speed_m_s : float
        Wanted of a straight run.
    kp_V_rad, limit_V : float
        Of the controller of a rig's drive, and the most that it gives; a gain of 0 where the voltage itself is given.
    """

    motion: Annotated[str, _ENTRY["motion"][0]] = "roll"
    amplitude_mm: Annotated[float, Number("mm", least=-1e4, most=1e4)] = 0.3
    amplitude_deg: Annotated[float, Number("deg", least=-360.0, most=360.0)] = 5.0
    start: Annotated[str, Choice(("tilted", "vertical"))] = "tilted"
    at: Annotated[str, Text(longest=60)] = ""
    push_N: Annotated[float, Number("N", least=-1e9, most=1e9)] = 0.0
    direction: Annotated[str, _ENTRY["direction"][0]] = "lateral"
    angle_deg: Annotated[float | None, Number("deg", least=0.0, most=90.0)] = None
    speed_mm_s: Annotated[float, _ENTRY["speed_mm_s"][0]] = 1.0
    height_m: Annotated[float, _ENTRY["height_m"][0]] = 0.05
    wheels_gripping: Annotated[tuple[int, ...], _ENTRY["wheels_gripping"][0]] = (1, 2, 3, 4)
    cable: Annotated[str | Mapping[str, float] | None, _ENTRY["cable"][0]] = "steel"
    wheel_rate_rad_s: Annotated[float, _ENTRY["wheel_rate_rad_s"][0]] = 0.0
    free_normal: bool = True
    yaw_rate_deg_s: Annotated[float, _ENTRY["yaw_rate_deg_s"][0]] = 45.0
    speed_m_s: Annotated[float, _ENTRY["wheel_speed_m_s"][0]] = 0.3
    kp_V_rad: Annotated[float, Number("V/rad", least=0.0, most=1e9)] = 0.0
    limit_V: Annotated[float, CONTROLLER.keys["limit_V"][0]] = math.inf
