"""Grip of one tire: the relay of eq (6.4) under the slip-dependent limits of (4.10)-(4.12)."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel


@kernel
def grip_shares(rim_speed, slip_x, slip_y, lambda_max):
    """Shares of the friction coefficient that are left along x and y.

    Eq (4.10)-(4.12): mu_ix = min(|lambda|/lambda_max, 1) with lambda = -slip_x/rim_speed clamped to ±1, and
    mu_iy = min(|tan theta| mu_ix, 1) with tan theta = slip_y/slip_x, written so that slip_x = 0 needs no special
    case. A wheel that does not turn has both shares 1.

    Parameters
    ----------
    rim_speed : float [m/s]
        r·omega of the wheel.
    slip_x, slip_y : float [m/s]
        Velocity of the hub over the ground, less the rolling: v_x - r·omega, and v_y.
    lambda_max : float

    Returns
    -------
    (float, float)
    """
    rim = abs(rim_speed)
    if rim < 1e-9:
        return 1.0, 1.0
    sliding = abs(slip_x)
    limit = rim * lambda_max
    share_x = min(sliding / limit, 1.0)
    share_y = min(abs(slip_y) / max(limit, sliding), 1.0)
    return share_x, share_y


@kernel
def contact_force(deflection, sliding, velocity, hub, beside, stiffness, damping, mass, breakaway, grip, drag, step):
    """Relay (6.4) and tire force (4.9) of one contact axis at a whole step.

    While it sticks the contact point stands still and the carcass takes up the hub's whole motion. When the force
    on the contact exceeds ``breakaway`` (mu_s N) it lets go; it then obeys m_t dv_c/dt + D v_c = F' - drag, taken
    implicitly because m_t/D is about a millisecond or none at all, and sticks again once the force has fallen
    to ``grip`` (mu_k N). A step that would take the force below ``grip`` is slowed to end exactly on it: the depth
    of a release then does not depend on the step size, and mu_k = mu_s is plain Coulomb sliding.

    Parameters
    ----------
    deflection : float [m]
        Of the carcass: hub minus contact point, from the unstressed state.
    sliding : bool
    velocity : float [m/s]
        Of the contact point.
    hub : float [m/s]
        Velocity of the hub relative to the rolling contact.
    beside : float [N]
        Force of whatever acts beside the carcass' spring and damper.
    stiffness, damping, mass : float
        K, D, m_t of this axis.
    breakaway, grip, drag : float [N]
        mu_s N, mu_k N, and the friction that acts during release (0 in the thesis' form).
    step : float [s]

    Returns
    -------
    (bool, float, float)
        Sliding or not, contact velocity [m/s], force on the hub [N].
    """
    force = stiffness * deflection + damping * hub + beside
    if not sliding and abs(force) > breakaway:
        sliding = True
        velocity = 0.0
    if sliding and abs(force) <= grip:
        sliding = False
    if not sliding:
        return False, 0.0, -force
    inertia = mass / step
    direction = 1.0 if force > 0.0 else -1.0
    velocity = (inertia * velocity + force - drag * direction) / (inertia + damping)
    landing = hub + (deflection - (direction * grip - damping * hub - beside) / stiffness) / step
    if direction * velocity > direction * landing:
        velocity = landing
    return True, velocity, damping * velocity - force
