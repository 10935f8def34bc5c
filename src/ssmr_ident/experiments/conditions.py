"""What an operator chooses beforehand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Conditions:
    """How an experiment is made (units are in the names); each kind of experiment takes what concerns it.

    Parameters
    ----------
    motion : {"roll", "pitch", "yaw"}
        Into which a free response is released.
    amplitude_mm : float
        Displacement of the wheels at the release.
    push_N : float
        Steady force from which it is let go in place of ``amplitude_mm``, where not 0.
    direction : {"lateral", "longitudinal"}
        Of a pull.
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
    """

    motion: str = "roll"
    amplitude_mm: float = 0.3
    push_N: float = 0.0
    direction: str = "lateral"
    speed_mm_s: float = 1.0
    height_m: float = 0.05
    wheels_gripping: tuple[int, ...] = (1, 2, 3, 4)
    cable: str | Mapping[str, float] | None = "steel"
    wheel_rate_rad_s: float = 0.0
    free_normal: bool = True
    yaw_rate_deg_s: float = 45.0
    speed_m_s: float = 0.3
