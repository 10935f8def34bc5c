"""One tire axis or rig spring with all effects that act beside it.

The hidden states of an element are z[0] dry friction, z[1] hysteresis, z[2] relaxation. All effects are compiled into
these two functions; each is passed over while it is off, so the baseline is nested to the last bit.
"""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import first, lanewise
from ssmr_ident.physics.effects import (
    dry_friction,
    free_play,
    hysteresis,
    nonlinear_stiffness,
    quadratic_damping,
    viscoelastic_relaxation,
)
from ssmr_ident.physics.slots import (
    ALPHA,
    CUBIC,
    CUBIC_SHARE,
    FRICTION_FORCE,
    FRICTION_ROUNDING,
    FRICTION_STIFFNESS,
    GAP,
    GAP_ROUNDING,
    KNEE,
    KNEE_SHARE,
    LOOP_EXPONENT,
    LOOP_SHAPE,
    QUADRATIC,
    RELAXATION_STIFFNESS,
    RELAXATION_TIME,
    SINE_SHARE,
    SLIDER,
    UNLISTED,
    YIELD,
)

_cubic, _beyond = nonlinear_stiffness.force, nonlinear_stiffness.beyond
_pendulum = lanewise(nonlinear_stiffness.pendulum)
_quadratic = quadratic_damping.force
_friction, _friction_advance = dry_friction.force, dry_friction.advance
_loop, _loop_advance = hysteresis.force, lanewise(hysteresis.advance)
_relaxation, _relaxation_advance = viscoelastic_relaxation.force, viscoelastic_relaxation.advance
_play = free_play.force

STATES = 3

PUSH_PARTS = 8
"""Of a push from rest; friction is exact in one, a loop goes on in parts of its own."""


@kernel
def element_force(s, v, z, stiffness, ratio, gap_share, tangential, e):
    """Force of the effects beside K·s + D·v [N].

    Parameters
    ----------
    s, v : float [m], [m/s]
        Deflection and its rate.
    z : (STATES,) float
        Array or tuple; so may be ``e``. In an inner loop take tuples: counting references to an array costs more
        than the force.
    stiffness : float [N/m]
        K of this axis.
    ratio : float
        K of this axis over that of the reference axis, which scales the relaxation branch.
    gap_share : float
        Share of the play that this axis has.
    tangential : bool
        False for the vertical axis, which knows stiffness and relaxation only.
    e : (SLOTS,) float
    """
    f = 0.0
    if first(e[CUBIC]) != 0.0:
        f += _cubic(s, e[CUBIC])
    if first(e[CUBIC_SHARE]) != 0.0:
        f += _cubic(s, e[CUBIC_SHARE] * stiffness)
    if first(e[RELAXATION_STIFFNESS]) != 0.0:
        f += _relaxation(z[2], ratio * e[RELAXATION_STIFFNESS])
    if tangential:
        if first(e[KNEE_SHARE]) != 0.0:
            f += _beyond(s, stiffness, e[KNEE_SHARE], e[KNEE])
        if first(e[SINE_SHARE]) != 0.0:
            f += _pendulum(s, stiffness, e[SINE_SHARE])
        if first(e[QUADRATIC]) != 0.0:
            f += _quadratic(v, e[QUADRATIC])
        if first(e[FRICTION_FORCE]) != 0.0:
            f += _friction(z[0], v, e[FRICTION_FORCE], e[FRICTION_STIFFNESS], e[FRICTION_ROUNDING])
        if first(e[ALPHA]) != 1.0:
            f += _loop(s, z[1], stiffness, e[ALPHA])
        if first(e[GAP]) != 0.0 and first(gap_share) > 0.0:
            f += _play(s, stiffness, gap_share * e[GAP], e[GAP_ROUNDING])
    return f


@kernel
def spring_force(s, stiffness, e):
    """K·s and what hardens or softens it [N]: what a spring or a weight pulls, whatever rubs or damps beside it.

    s : float [m], stiffness : float [N/m], e : (SLOTS,) float, or a tuple.
    """
    f = stiffness * s + _cubic(s, e[CUBIC] + e[CUBIC_SHARE] * stiffness)
    if e[KNEE_SHARE] != 0.0:
        f += _beyond(s, stiffness, e[KNEE_SHARE], e[KNEE])
    if e[SINE_SHARE] != 0.0:
        f += _pendulum(s, stiffness, e[SINE_SHARE])
    return f


@kernel
def element_next(z, v, step, tangential, e):
    """Hidden states one step later, exactly for a constant rate; (STATES,) tuple."""
    friction, loop, relaxation = z[0], z[1], z[2]
    if first(e[RELAXATION_STIFFNESS]) != 0.0:
        relaxation = _relaxation_advance(relaxation, v, step, e[RELAXATION_TIME])
    if tangential:
        if first(e[FRICTION_FORCE]) != 0.0:
            friction = _friction_advance(friction, v, step, e[FRICTION_FORCE], e[FRICTION_STIFFNESS], e[SLIDER])
        if first(e[ALPHA]) != 1.0:
            loop = _loop_advance(loop, v, step, e[YIELD], e[LOOP_EXPONENT], e[LOOP_SHAPE])
    return friction, loop, relaxation


@kernel
def element_advance(z, v, step, tangential, e):
    """Hidden states one step later; z : (STATES,) float, changed in place."""
    z[0], z[1], z[2] = element_next(z, v, step, tangential, e)


@kernel
def element_loaded(s, share, tangential, e):
    """Hidden states, (STATES,) tuple, that a push from rest to s [m] leaves, times ``share``.

    Friction and loops go by the path alone. A relaxing branch has had no time: a push that is held leaves it a part
    of that.
    """
    z = (0.0, 0.0, 0.0)
    for _ in range(PUSH_PARTS):
        z = element_next(z, s, 1.0 / PUSH_PARTS, tangential, e)
    relaxation = s if first(e[RELAXATION_STIFFNESS]) != 0.0 else 0.0
    return share * z[0], share * z[1], share * relaxation


@kernel
def inner_slots(e):
    """The slots that tires and floor look at, as a tuple that stands in for ``e`` in an inner loop."""
    return (
        e[0], e[1], e[2], e[3], e[4], e[5], e[6], e[7], e[8], e[9],
        e[10], e[11], e[12], e[13], e[14], e[15], e[16], e[17], e[18], e[19], e[20], e[21], e[22], e[23], e[24],
        e[25], e[26], e[27],
    )  # fmt: skip


@kernel
def free_slots(e):
    """The slots of what is unlisted, as a tuple to be made where they are asked for: kept through the whole loop, so
    many numbers leave no room for others, and cost a third of every step with any effect."""
    f = UNLISTED
    return (
        e[f], e[f + 1], e[f + 2], e[f + 3], e[f + 4], e[f + 5], e[f + 6], e[f + 7], e[f + 8], e[f + 9], e[f + 10],
        e[f + 11], e[f + 12], e[f + 13], 0.0, 0.0, 0.0, e[f + 17],
    )  # fmt: skip
