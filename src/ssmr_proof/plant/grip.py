"""Four tires on a floor: springs with sliders that obey Coulomb's cone, and wheels that can leave the ground."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_proof.plant.spring_laws import GAP_SHARE_X, advance, beside

MU, MU_SHARE, SLIP_SPEED, LOAD_EXPONENT, NOMINAL_LOAD = range(5)
FRICTIONS = 5


@kernel
def friction_coefficient(slip: float, load: float, friction: np.ndarray) -> float:
    """mu_s·(r + (1 - r)·exp(-(u/v_s)²))·(N/N_0)^-n; slip u [m/s], load N [N]."""
    mu = friction[MU]
    if friction[MU_SHARE] != 1.0:
        ratio = slip / friction[SLIP_SPEED]
        mu *= friction[MU_SHARE] + (1.0 - friction[MU_SHARE]) * math.exp(-ratio * ratio)
    if friction[LOAD_EXPONENT] != 0.0 and load > 0.0:
        mu *= (load / friction[NOMINAL_LOAD]) ** (-friction[LOAD_EXPONENT])
    return mu


@kernel
def tires(
    length: np.ndarray,
    velocity: np.ndarray,
    control: np.ndarray,
    anchor: np.ndarray,
    slip: np.ndarray,
    hidden: np.ndarray,
    stiffness: np.ndarray,
    damping: np.ndarray,
    laws: np.ndarray,
    friction: np.ndarray,
    gripping: np.ndarray,
    t: float,
    step: float,
) -> float:
    """Set the engine's twelve tire actuators so that each tire's force is the plant's.

    The engine already applies -(K·length + D·velocity) along the floor's axes; ``control`` is what has to be added:
    laws beside it, the place where the contact stands by now, sliding, flight.

    Parameters
    ----------
    length, velocity : (12,) float [m], [m/s]
        Of the contact points over the floor, wheel by wheel x, y, z; z counts upwards from the unloaded floor.
    control : (12,) float [N]
        Changed in place.
    anchor : (4, 2) float [m]
        Where the contacts stand; changed in place.
    slip : (4,) float [m/s]
        Sliding speeds, from the last step; changed in place.
    hidden : (12, HIDDEN) float [m]
        Changed in place.
    stiffness, damping : (3,) float
    laws : (len(LAWS),) float
    friction : (FRICTIONS,) float
    gripping : (4,) float
        0 for a wheel on an oiled plate.
    t, step : float [s]

    Returns
    -------
    float [N]
        The smallest of the four loads.
    """
    lightest = 1e9
    for wheel in range(4):
        z = 3 * wheel + 2
        depth, sinking = -length[z], -velocity[z]
        advance(depth, hidden[z], step, False, laws)
        ratio = stiffness[2] / stiffness[1]
        extra = beside(depth, sinking, t, hidden[z], stiffness[2], damping[2], ratio, 0.0, False, laws)
        load = stiffness[2] * depth + damping[2] * sinking + extra
        if depth <= 0.0 or load < 0.0:
            load = 0.0
        lightest = min(lightest, load)
        control[z] = load + stiffness[2] * length[z] + damping[2] * velocity[z]
        limit = friction_coefficient(slip[wheel], load, friction) * load * gripping[wheel]
        trial_x = trial_y = 0.0
        for axis in range(2):
            n = 3 * wheel + axis
            s = length[n] - anchor[wheel, axis]
            advance(s, hidden[n], step, True, laws)
            share = laws[GAP_SHARE_X] if axis == 0 else 1.0
            ratio = stiffness[axis] / stiffness[1]
            f = stiffness[axis] * s + damping[axis] * velocity[n]
            f += beside(s, velocity[n], t, hidden[n], stiffness[axis], damping[axis], ratio, share, True, laws)
            if axis == 0:
                trial_x = f
            else:
                trial_y = f
        size = math.hypot(trial_x, trial_y)
        scale = 1.0 if size <= limit else limit / size
        speed = 0.0
        for axis in range(2):
            n = 3 * wheel + axis
            trial = trial_x if axis == 0 else trial_y
            s = length[n] - anchor[wheel, axis]
            if scale < 1.0:
                # spring and damper in series with the slider: K s + D s' = what the slider bears
                settled = s + (scale * trial - trial + damping[axis] * velocity[n]) / stiffness[axis]
                later = settled + (s - settled) * math.exp(-step * stiffness[axis] / damping[axis])
                anchor[wheel, axis] += velocity[n] * step - (later - s)
                speed += (velocity[n] - (later - s) / step) ** 2
            control[n] = -scale * trial + stiffness[axis] * length[n] + damping[axis] * velocity[n]
        slip[wheel] = math.sqrt(speed)
        if limit == 0.0:  # an unloaded tire hangs unstressed below its hub
            for axis in range(2):
                anchor[wheel, axis] = length[3 * wheel + axis]
                hidden[3 * wheel + axis, :] = 0.0
    return lightest


@kernel
def cable(length: float, velocity: float, head: float, speed: float, stiffness: float, damping: float) -> float:
    """Tension of a cable that pulls and never pushes [N]; lengths along the pull [m]."""
    stretch = head - length
    tension = stiffness * stretch + damping * (speed - velocity)
    return tension if tension > 0.0 and stretch > 0.0 else 0.0
