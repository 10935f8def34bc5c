"""Force laws for the benchmark's own plants, many of them in other formulas than the catalogue's.

A law is a row of numbers: its kind and up to five parameters. Its hidden states obey ``rates`` or, where they depend
on the path alone and may change within a micrometre, follow it by ``moved``. Nothing here imports the catalogue: the
bank must not share a mistake with it.
"""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import kernel

KINDS = (
    "cubic", "two_slopes", "sinh", "tanh_spring",  # stiffness over deflection
    "tanh_friction", "jenkins", "stribeck_friction", "dahl",  # dry friction
    "play", "rounded_play", "smooth_play",
    "bouc_wen", "iwan",
    "quadratic", "power_damping",
    "maxwell", "two_maxwells",
    "one_sided_damper", "one_sided_spring", "creeping_spring", "friction_by_place",  # in nobody's list
)  # fmt: skip
(
    CUBIC, TWO_SLOPES, SINH, TANH_SPRING, TANH_FRICTION, JENKINS, STRIBECK_FRICTION, DAHL, PLAY, ROUNDED_PLAY,
    SMOOTH_PLAY, BOUC_WEN, IWAN, QUADRATIC, POWER_DAMPING, MAXWELL, TWO_MAXWELLS, ONE_SIDED_DAMPER,
    ONE_SIDED_SPRING, CREEPING_SPRING, FRICTION_BY_PLACE,
) = range(len(KINDS))  # fmt: skip
WIDTH, STATES = 6, 4


def law(kind: str, *parameters: float) -> np.ndarray:
    """One row for the plants, (WIDTH,) float."""
    row = np.zeros(WIDTH)
    row[0], row[1 : 1 + len(parameters)] = KINDS.index(kind), parameters
    return row


def laws(*rows: np.ndarray) -> np.ndarray:
    """(n, WIDTH) float, n = 0 for none."""
    return np.array(rows).reshape(-1, WIDTH)


@kernel
def _softplus(u):
    return u if u > 30.0 else math.log1p(math.exp(u))


@kernel
def force(row, x, v, z, t):
    """Force beside the linear spring and damper [N]; x : float [m], v : float [m/s], z : (STATES,) float, t : [s]."""
    kind, a, b, c = int(row[0]), row[1], row[2], row[3]
    size = abs(x)
    sign = 1.0 if x >= 0.0 else -1.0
    if kind == CUBIC:  # a: N/m^3
        return a * x * x * x
    if kind == TWO_SLOPES:  # a: added N/m beyond the deflection b
        return sign * a * (size - b) if size > b else 0.0
    if kind == SINH:  # a: N/m, b: m; grows as an exponential
        return a * (b * math.sinh(x / b) - x)
    if kind == TANH_SPRING:  # a: N/m that is lost beyond b
        return a * (b * math.tanh(x / b) - x)
    if kind == TANH_FRICTION:  # a: N, b: m/s
        return a * math.tanh(v / b)
    if kind == JENKINS:  # a: N, b: N/m
        return b * z[0]
    if (
        kind == STRIBECK_FRICTION
    ):  # a: N while sliding fast, b: m/s of the sign's width, c: share added at rest, row[4]: m/s
        return a * (1.0 + c * math.exp(-((v / row[4]) ** 2))) * math.tanh(v / b)
    if kind == DAHL:  # a: N, b: N/m
        return b * z[0]
    if kind == PLAY:  # a: N/m of the spring, b: half gap
        return -a * (x if size <= b else sign * b)
    if kind == ROUNDED_PLAY:  # c: m on either side of the corner that a parabola rounds
        if size <= b - c:
            return -a * x
        return -a * sign * (b if size >= b + c else size - (size - b + c) ** 2 / (4.0 * c))
    if kind == SMOOTH_PLAY:  # c: m over which the corner is rounded, by a softplus
        return a * (c * (_softplus((x - b) / c) - _softplus((-x - b) / c)) - x)
    if kind == BOUC_WEN:  # a: N/m that yields, b: m
        return a * (z[0] - x)
    if kind == IWAN:  # a: N/m that yields in three sliders, b: m of the middle one
        return a * ((z[0] + z[1] + z[2]) / 3.0 - x)
    if kind == QUADRATIC:  # a: N s^2/m^2
        return a * v * abs(v)
    if kind == POWER_DAMPING:  # a: N at v = 1 m/s, b: power
        return a * abs(v) ** b * (1.0 if v >= 0.0 else -1.0)
    if kind == MAXWELL:  # a: N/m, b: s
        return a * z[0]
    if kind == TWO_MAXWELLS:  # a: N/m, b: s; c: N/m, row[4]: s
        return a * z[0] + c * z[1]
    if kind == ONE_SIDED_DAMPER:  # a: N s/m, resists one way more than the other
        return a * abs(v)
    if kind == ONE_SIDED_SPRING:  # a: N/m, from the deflection b on
        return a * (x - b) if x > b else 0.0
    if kind == CREEPING_SPRING:  # a: N/m that the stiffness gains over b seconds
        return a * t / b * x
    # friction where x > 0 only; a: N, b: m/s of the sign's width, c: m over which it sets in
    return 0.5 * a * (1.0 + math.tanh(x / c)) * math.tanh(v / b)


@kernel
def rates(row, x, v, z, dz):
    """d(z)/dt into ``dz``."""
    kind, b = int(row[0]), row[2]
    for j in range(STATES):
        dz[j] = 0.0
    if kind == BOUC_WEN:  # row[3]: exponent, row[4]: beta, gamma = 1 - beta
        ratio = abs(z[0] / b) ** row[3]
        dz[0] = v - ratio * (row[4] * abs(v) * (1.0 if z[0] >= 0.0 else -1.0) + (1.0 - row[4]) * v)
    elif kind == MAXWELL:
        dz[0] = v - z[0] / b
    elif kind == TWO_MAXWELLS:
        dz[0], dz[1] = v - z[0] / b, v - z[1] / row[4]


@kernel
def moved(row, z, travel, out):
    """Friction elements after a travel [m] in one direction, exactly, into ``out``; other states are left alone."""
    kind = int(row[0])
    if kind == JENKINS:
        limit = row[1] / row[2]
        out[0] = min(max(z[0] + travel, -limit), limit)
    elif kind == IWAN:
        for j in range(3):
            limit = row[2] * (0.5, 1.0, 2.0)[j]
            out[j] = min(max(z[j] + travel, -limit), limit)
    elif kind == DAHL:
        end = row[1] / row[2] * (1.0 if travel >= 0.0 else -1.0)
        out[0] = end + (z[0] - end) * math.exp(-abs(travel) * row[2] / row[1])
