"""How belts stand when a robot is let go."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import first
from ssmr_ident.simulate.layout import KX, POINTS, RADIUS


@kernel
def take_up(p, stiffness, start, deflection, belt):
    """Belts and tires share in series what the hubs have moved along x, and its rate: as after a slow push.

    A belt begun at length zero beside tires that are strained would ring at the rim's own frequency, which no push by
    hand makes.

    Parameters
    ----------
    p : (PARAMETERS,) float
    stiffness : float [N/m]
        Of one side's belt, at the rim.
    start : (START,) float
    deflection : (4, 2) float [m]
        Of the carcasses if belts did not give; less what the belts take up afterwards.
    belt : (3, 2) float [m], [m/s]
        Length and its rate of left and right; filled.
    """
    wheels_left = wheels_right = 0.0
    for i in range(4):
        b, c = p[POINTS + 3 * i + 1], p[POINTS + 3 * i + 2]
        side = 0 if first(b) > 0.0 else 1
        if side == 0:
            wheels_left += 1.0
        else:
            wheels_right += 1.0
        belt[0, side] += deflection[i, 0]
        belt[1, side] += start[6] + start[10] * c - start[11] * b - p[RADIUS] * start[12 + side]
    for side in range(2):
        share = p[KX] / (stiffness + (wheels_left if side == 0 else wheels_right) * p[KX])
        belt[0, side] *= share
        belt[1, side] *= share
    for i in range(4):
        deflection[i, 0] -= belt[0, 0 if first(p[POINTS + 3 * i + 1]) > 0.0 else 1]
