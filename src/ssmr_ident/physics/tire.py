"""Grip of one tire: eq (6.4) axis by axis, as printed or landing on its limit, or sliding of both axes together, under
(4.10)-(4.12)."""

from __future__ import annotations

import math

from ssmr_ident.core.exponential import exp
from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import anywhere, where


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
    turns = abs(rim_speed) >= 1e-9
    sliding, limit = abs(slip_x), where(turns, abs(rim_speed) * lambda_max, 1.0)
    share_x = min(sliding / limit, 1.0)
    share_y = min(abs(slip_y) / max(limit, sliding), 1.0)
    return where(turns, share_x, 1.0), where(turns, share_y, 1.0)


@kernel
def release_share(mu_static, mu_kinetic, dropped):
    """Share of the kinetic friction that acts while a contact slides: ``dropped`` (0 in the thesis' form, 1 with the
    term it leaves out of (6.4)) where mu_k < mu_s, and all of it where both are one number.

    A release without friction ends on mu_k N. Where it began there as well it is no release but sliding, which
    Coulomb's law opposes with mu N; without that a contact let go and stuck in turn at every step, and carried D·v less
    than mu N on average.
    """
    return where(mu_kinetic < mu_static, dropped, 1.0)


@kernel
def contact_force(deflection, sliding, velocity, hub, beside, stiffness, damping, mass, breakaway, grip, drag, step):
    """Relay (6.4) and tire force (4.9) of one contact axis at a whole step.

    While it sticks the contact point stands still and the carcass takes up the hub's whole motion. When the force
    on the contact exceeds ``breakaway`` (mu_s N) it lets go; it then obeys m_t dv_c/dt + D v_c = F' - drag, taken
    implicitly because m_t/D is about a millisecond or none at all, and sticks again once the force has fallen
    to ``grip`` (mu_k N). A step that would take the force below ``grip`` is slowed to end exactly on it: the depth
    of a release then does not depend on the step size. mu_k = mu_s with ``drag`` = mu N is plain Coulomb sliding.

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
        mu_s N, mu_k N, and the friction that acts during release (``release_share`` of mu_k N).
    step : float [s]

    Returns
    -------
    (bool, float, float)
        Sliding or not, contact velocity [m/s], force on the hub [N].
    """
    force = stiffness * deflection + damping * hub + beside
    # a contact that stuck has velocity 0
    slides = (sliding | (abs(force) > breakaway)) & (abs(force) > grip)
    if not anywhere(slides):
        return slides, 0.0 * force, -force
    inertia = mass / step
    direction = where(force > 0.0, 1.0, -1.0)
    velocity = (inertia * velocity + force - drag * direction) / (inertia + damping)
    landing = hub + (deflection - (direction * grip - damping * hub - beside) / stiffness) / step
    velocity = where(direction * velocity > direction * landing, landing, velocity)
    return slides, where(slides, velocity, 0.0), where(slides, damping * velocity - force, -force)


@kernel
def printed_force(
    deflection, released, velocity, hub, beside, stiffness, damping, mass, breakaway, grip, drag, coast, step
):
    """Relay (6.4) to the letter, and tire force (4.9), of one contact axis at a whole step.

    m_t dv_c/dt + D v_c = F'·sigma with F' = m_t dv_i/dt + D v_i + K s, where the relay sigma is 1 from |F'| > mu_s N
    until |F'| < mu_k N. A contact whose relay has fallen back is not held: it coasts on its own damper for about m_t/D,
    so that a release ends below mu_k N. ``contact_force`` stops it there.

    Parameters
    ----------
    deflection, velocity, beside, stiffness, damping, mass, breakaway, grip, drag, step
        As ``contact_force`` takes them.
    released : bool
        The relay.
    hub : (float, float) [m/s, m/s^2]
        Velocity of the hub relative to the rolling contact, and its rate.
    coast : float
        exp(-D·step/m_t): exact for a force that is constant over the step. 0 without mass.

    Returns
    -------
    (bool, float, float)
        The relay, contact velocity [m/s] half a step on, force on the hub [N].
    """
    carried = stiffness * deflection + damping * hub[0] + beside
    force = carried + mass * hub[1]
    releases = (released & (abs(force) >= grip)) | (abs(force) > breakaway)
    damped = damping > 0.0
    gain = where(damped, (1.0 - coast) / where(damped, damping, 1.0), step / where(damped, 1.0, mass))
    coming = coast * velocity + where(releases, gain * force, 0.0)
    slowed = max(abs(coming) - gain * drag, 0.0)  # the kinetic term opposes what moves, and moves nothing by itself
    coming = where(coming > 0.0, slowed, -slowed)
    now = where(mass > 0.0, 0.5 * (velocity + coming), coming)
    return releases, coming, damping * now - carried


@kernel
def weakened(mu_static, mu_kinetic, speed, width):
    """mu_k + (mu_s - mu_k)·exp(-(u/v_s)²); speed u and width v_s : float [m/s]."""
    if not anywhere(speed != 0.0):  # most contacts stand, and an exponential is most of what they cost
        return mu_kinetic + (mu_static - mu_kinetic)
    ratio = speed / width
    return mu_kinetic + (mu_static - mu_kinetic) * exp(-ratio * ratio)


@kernel
def combined_share(rim_speed, slip_x, slip_y, lambda_max):
    """(4.10)-(4.12) for both axes as one: min(|slip|/(lambda_max·|r·omega|), 1), and 1 for a wheel at rest.

    For small slips mu_ix and mu_iy are the two components of this vector; only where the thesis cuts each of them at 1
    its length is cut instead, so that sliding has no preferred axes.
    """
    limit = abs(rim_speed) * lambda_max
    turns = limit >= 1e-9
    return where(turns, min(math.sqrt(slip_x * slip_x + slip_y * slip_y) / where(turns, limit, 1.0), 1.0), 1.0)


@kernel
def sliding_force(deflection, velocity, slip, beside, stiffness, damping, mass, limit, step):
    """Tire force of a contact that slides against the direction in which it moves over the floor.

    The contact point obeys m_t dv/dt = K·s + D·(slip - v) - limit·v/|v|, and stands still while the carcass does not
    exceed ``limit``. v is that in the middle of the coming step, the deflection's change over half of it taken
    implicitly, so that a light contact on a stiff carcass does not ask for a short step. |v| is the one unknown left:
    the reciprocal length that Newton works on is a straight line where both axes are alike.

    Parameters
    ----------
    deflection, velocity, slip, beside : (float, float)
        Of the carcass [m], of the contact point [m/s], of the hub over the rolling contact [m/s], and forces of
        whatever acts beside the carcass [N], each along x and y.
    stiffness, damping : (float, float)
        [N/m], [N s/m].
    mass : float [kg]
        m_t.
    limit : float [N]
        Friction at the speed of the last step.
    step : float [s]

    Returns
    -------
    (bool, float, float, float, float)
        Sliding or not, contact velocity (x, y) [m/s], force on the hub (x, y) [N].
    """
    force_x = stiffness[0] * deflection[0] + damping[0] * slip[0] + beside[0]
    force_y = stiffness[1] * deflection[1] + damping[1] * slip[1] + beside[1]
    inertia, half = mass / step, 0.5 * step
    push_x = force_x + half * stiffness[0] * slip[0] + inertia * velocity[0]
    push_y = force_y + half * stiffness[1] * slip[1] + inertia * velocity[1]
    square = push_x * push_x + push_y * push_y
    slides = square > limit * limit  # most contacts stand, and a root costs as much as twenty sums
    if not anywhere(slides):
        return slides, 0.0 * square, 0.0 * square, -force_x, -force_y
    drag_x = damping[0] + inertia + half * stiffness[0]
    drag_y = damping[1] + inertia + half * stiffness[1]
    speed = (math.sqrt(square) - limit) / max(drag_x, drag_y)  # never above the root, so Newton comes from one side
    coming = slides
    for _ in range(20):
        along_x, along_y = push_x / (drag_x * speed + limit), push_y / (drag_y * speed + limit)
        square = along_x * along_x + along_y * along_y
        slope = drag_x * along_x * along_x / (drag_x * speed + limit)
        slope += drag_y * along_y * along_y / (drag_y * speed + limit)
        change = (math.sqrt(square) - 1.0) * square / slope
        speed = where(coming, speed + change, speed)
        coming = coming & (abs(change) > 1e-12 * speed)
        if not anywhere(coming):
            break
    sliding_x, sliding_y = push_x * speed / (drag_x * speed + limit), push_y * speed / (drag_y * speed + limit)
    pulled_x, pulled_y = damping[0] * sliding_x - force_x, damping[1] * sliding_y - force_y
    return (
        slides, where(slides, sliding_x, 0.0), where(slides, sliding_y, 0.0),
        where(slides, pulled_x, -force_x), where(slides, pulled_y, -force_y),
    )  # fmt: skip
