"""Instantaneous axis of a rigid body's motion: the centre of rotation (2.8)-(2.10) in three dimensions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class ScrewAxis:
    """The line about which a body turns, and along which it slides at the same time.

    Parameters
    ----------
    point : (3,) float [m]
        Of the line, nearest to the origin of the velocities. Infinite where nothing turns.
    direction : (3,) float
        Of the angular velocity, or of the velocity where nothing turns; length 1, or 0 for a body at rest.
    pitch : float [m/rad]
        Way along the line per angle; 0 is a pure rotation.
    """

    point: np.ndarray
    direction: np.ndarray
    pitch: float


def screw_axis(velocity: np.ndarray, rates: np.ndarray) -> ScrewAxis:
    """Where v + ω × r is parallel to ω: r = ω × v/|ω|², with the pitch v·ω/|ω|² (Mozzi and Chasles).

    In the plane, v = (v_x, v_y, 0) and ω = (0, 0, ω), this is (−v_y/ω, v_x/ω) of (2.8)-(2.10).

    Parameters
    ----------
    velocity : (3,) float [m/s]
        Of the origin.
    rates : (3,) float [rad/s]
        Along the same axes.

    Examples
    --------
    >>> screw_axis(np.array([0.2, 0.0, 0.0]), np.array([0.0, 0.0, 0.5])).point
    array([0. , 0.4, 0. ])
    """
    v, w = np.asarray(velocity, dtype=float), np.asarray(rates, dtype=float)
    square = float(w @ w)
    if square == 0.0:
        speed = float(np.linalg.norm(v))
        return ScrewAxis(np.full(3, np.inf), v / speed if speed else v, np.inf if speed else 0.0)
    return ScrewAxis(np.cross(w, v) / square, w / np.sqrt(square), float(v @ w) / square)
