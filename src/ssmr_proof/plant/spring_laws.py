"""What may act beside a linear spring and damper, in the plant's own formulas.

Written from the literature, not from `physics/effects`: friction is a spring with a slider (Jenkins) or Dahl's law
by backward steps, play has sharp corners, hardening may have two slopes, Bouc-Wen is stepped plainly too. Same physics,
other arithmetic.
"""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import kernel

# Slots of a law vector; 0 means absent in every one of them.
LAWS = (
    *("cubic", "knee", "knee_share", "friction", "friction_stiffness", "dahl", "quadratic"),
    *("maxwell", "maxwell_time", "loop_share", "loop_yield", "gap", "gap_share_x"),
    *("uneven_damper", "reach_damper", "uneven_spring", "root_damper", "pulse_share", "pulse_rad_s"),
)
(
    CUBIC, KNEE, KNEE_SHARE, FRICTION, FRICTION_STIFFNESS, DAHL, QUADRATIC,
    MAXWELL, MAXWELL_TIME, LOOP_SHARE, LOOP_YIELD, GAP, GAP_SHARE_X,
    UNEVEN_DAMPER, REACH_DAMPER, UNEVEN_SPRING, ROOT_DAMPER, PULSE_SHARE, PULSE_RAD_S,
) = range(len(LAWS))  # fmt: skip
HIDDEN = 4  # slider's spring, loop, dashpot of the Maxwell branch, deflection a step ago; each a length [m]
ROOT_SPEED = 1e-3  # m/s; below it the root damper is linear, so that its slope stays finite


def law_vector(**values: float) -> np.ndarray:
    """Laws by name, the others absent; (len(LAWS),) float."""
    vector = np.zeros(len(LAWS))
    for name, value in values.items():
        vector[LAWS.index(name)] = value
    return vector


@kernel
def beside(
    s: float,
    v: float,
    t: float,
    hidden: np.ndarray,
    stiffness: float,
    damping: float,
    ratio: float,
    gap_share: float,
    tangential: bool,
    laws: np.ndarray,
) -> float:
    """Force beside K·s + D·v [N].

    Parameters
    ----------
    s, v : float [m], [m/s]
    t : float [s]
        Since the release, for what changes with time.
    hidden : (HIDDEN,) float [m]
    stiffness, damping : float [N/m], [N s/m]
        K and D of this spring.
    ratio : float
        K over that of the reference axis; the Maxwell branch keeps this ratio.
    gap_share : float
        Share of the play that this axis has.
    tangential : bool
        False for a tire's vertical axis, which knows hardening and relaxation only.
    laws : (len(LAWS),) float
    """
    force = laws[CUBIC] * s * s * s + ratio * laws[MAXWELL] * (s - hidden[2])
    if not tangential:
        return force
    if laws[KNEE_SHARE] != 0.0 and abs(s) > laws[KNEE]:
        force += laws[KNEE_SHARE] * stiffness * (s - math.copysign(laws[KNEE], s))
    force += laws[FRICTION_STIFFNESS] * hidden[0] + laws[QUADRATIC] * v * abs(v)
    if laws[LOOP_SHARE] != 0.0:
        force += laws[LOOP_SHARE] * stiffness * (hidden[1] - s)
    gap = 0.5 * gap_share * laws[GAP]
    if gap > 0.0:
        force -= stiffness * (s if abs(s) < gap else math.copysign(gap, s))
    force += damping * v * (laws[UNEVEN_DAMPER] * math.copysign(1.0, v) + laws[REACH_DAMPER] * s * s)
    if s > 0.0:
        force += laws[UNEVEN_SPRING] * stiffness * s
    if laws[ROOT_DAMPER] != 0.0:
        force += laws[ROOT_DAMPER] * v / math.sqrt(max(abs(v), ROOT_SPEED))
    return force + laws[PULSE_SHARE] * stiffness * s * math.sin(laws[PULSE_RAD_S] * t)


@kernel
def advance(s: float, hidden: np.ndarray, step: float, tangential: bool, laws: np.ndarray) -> None:
    """Hidden lengths brought up to the deflection ``s`` [m], in place.

    They follow the way that was gone since the last step, not the speed at its beginning: the engine moves places with
    the new speed, and a spring that followed the old one would gain energy while a slider sticks.
    """
    way = s - hidden[3]
    hidden[3] = s
    if laws[MAXWELL] != 0.0:
        hidden[2] += (s - hidden[2]) * (1.0 - math.exp(-step / laws[MAXWELL_TIME]))
    if not tangential:
        return
    if laws[FRICTION_STIFFNESS] != 0.0:
        reach = laws[FRICTION] / laws[FRICTION_STIFFNESS]
        if laws[DAHL] != 0.0:
            # the slope at the end of the step: a step may go many times as far as the spring reaches
            hidden[0] = (hidden[0] + way) / (1.0 + abs(way) / reach)
        else:
            hidden[0] = min(max(hidden[0] + way, -reach), reach)
    if laws[LOOP_SHARE] != 0.0:
        grown = way
        if way * hidden[1] > 0.0:
            grown = way * (1.0 - (hidden[1] / laws[LOOP_YIELD]) ** 2)
        hidden[1] = min(max(hidden[1] + grown, -laws[LOOP_YIELD]), laws[LOOP_YIELD])
