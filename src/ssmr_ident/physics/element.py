"""One tire axis or rig spring with all effects that act beside it.

The hidden states of an element are z[0] dry friction, z[1] hysteresis, z[2] relaxation. All effects are compiled into
these two functions; each is passed over while it is off, so the baseline is nested to the last bit.
"""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
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
    FRICTION_FORCE,
    FRICTION_STIFFNESS,
    GAP,
    GAP_ROUNDING,
    QUADRATIC,
    RELAXATION_STIFFNESS,
    RELAXATION_TIME,
    YIELD,
)

_cubic = nonlinear_stiffness.force
_quadratic = quadratic_damping.force
_friction, _friction_advance = dry_friction.force, dry_friction.advance
_loop, _loop_advance = hysteresis.force, hysteresis.advance
_relaxation, _relaxation_advance = viscoelastic_relaxation.force, viscoelastic_relaxation.advance
_play = free_play.force

STATES = 3


@kernel
def element_force(s, v, z, stiffness, ratio, gap_share, tangential, e):
    """Force of the effects beside K·s + D·v [N].

    Parameters
    ----------
    s, v : float [m], [m/s]
        Deflection and its rate.
    z : (STATES,) float
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
    if e[CUBIC] != 0.0:
        f += _cubic(s, e[CUBIC])
    if e[RELAXATION_STIFFNESS] != 0.0:
        f += _relaxation(z[2], ratio * e[RELAXATION_STIFFNESS])
    if tangential:
        if e[QUADRATIC] != 0.0:
            f += _quadratic(v, e[QUADRATIC])
        if e[FRICTION_FORCE] != 0.0:
            f += _friction(z[0], e[FRICTION_STIFFNESS])
        if e[ALPHA] != 1.0:
            f += _loop(s, z[1], stiffness, e[ALPHA])
        if e[GAP] != 0.0 and gap_share > 0.0:
            f += _play(s, stiffness, gap_share * e[GAP], e[GAP_ROUNDING])
    return f


@kernel
def element_advance(z, v, step, tangential, e):
    """Hidden states one step later, exactly for a constant rate; z : (STATES,) float, changed in place."""
    if e[RELAXATION_STIFFNESS] != 0.0:
        z[2] = _relaxation_advance(z[2], v, step, e[RELAXATION_TIME])
    if tangential:
        if e[FRICTION_FORCE] != 0.0:
            z[0] = _friction_advance(z[0], v, step, e[FRICTION_FORCE], e[FRICTION_STIFFNESS])
        if e[ALPHA] != 1.0:
            z[1] = _loop_advance(z[1], v, step, e[YIELD])
