"""Motion of a foot that is shaken, from what was logged of it."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import make_interp_spline

from ssmr_ident.core.errors import InputError

Array = np.ndarray

DEGREE = 5
"""Of the spline: a cubic one's second derivative is (omega h)^2 / 12 off, half a per cent at 25 samples a period."""

AROUND = 20
"""Samples that are laid on before and after."""


def foot_motion(logged: Array, name: str, motions: dict[str, int], rate: float, file: str) -> Array:
    """Position, velocity and acceleration of the foot, (n, 3) float; nought where only its acceleration is known.

    Parameters
    ----------
    logged : (n,) float [m], or [m/s^2]
    name : str
        ``base_position`` or ``base_acceleration``.
    motions : mapping of str to int
        Channels of the mass, and which time derivative each is.
    rate : float [Hz]
    file : str
        For the message.

    Raises
    ------
    InputError
        A motion that is logged for the mass, and of the foot only by integrals of an acceleration that drift.
    """
    if name == "base_position":
        around = min(AROUND, len(logged) - 1)
        longer = np.pad(logged, around, mode="reflect", reflect_type="odd")  # a spline's ends multiply noise
        time = np.arange(len(longer)) / rate
        path = make_interp_spline(time, longer, k=DEGREE)
        return np.stack([path(time[around : around + len(logged)], order) for order in range(3)], axis=1)
    other = next((motion for motion, order in motions.items() if order != 2), None)
    if other is not None:
        raise InputError(
            file,
            f"has base_acceleration beside {other}, which is absolute: the foot's own {other} is not logged",
            "Map the foot's base_position, or an acceleration of the mass, by channels:",
        )
    return np.stack([np.zeros_like(logged), np.zeros_like(logged), logged], axis=1)
