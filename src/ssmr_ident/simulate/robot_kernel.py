"""The 6-DOF robot on four tires, one step after the other (thesis section 6.1, eq 2.65), with every effect in it.

Velocities are those of the CoM along the heading axes (x where the robot points, z up) and the body's angular
rates; the pose is the CoM in the world and yaw, pitch, roll. In these axes gravity and the floor's normal are
constant, the tires push at the contact points p_i, and small decays obey the determinants of thesis.md section 5.

The method is the staggered leapfrog: positions at whole steps, velocities at half steps, and the velocity that
damping needs at a whole step carried forward by half the last acceleration. Second order, one evaluation of the
forces per step, and no growth of energy in what conserves it.
"""

from __future__ import annotations

import math

from ssmr_ident.core.exponential import exp
from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import anywhere, first, lanewise, space, where
from ssmr_ident.physics import slots
from ssmr_ident.physics.effects import (
    load_sensitive_friction,
    motor_belt,
    rolling_resistance,
    stribeck,
    unlisted,
)
from ssmr_ident.physics.effects import wheel_lift as lift_effect
from ssmr_ident.physics.element import STATES, element_force, element_loaded, element_next, free_slots, inner_slots
from ssmr_ident.physics.sensor import filter_step
from ssmr_ident.physics.slots import (
    BELT_DAMPING,
    BELT_STIFFNESS,
    GAP_SHARE_X,
    KINETIC_SHARE,
    LOAD_EXPONENT,
    MAST_HZ,
    RIM_MASS,
    ROLLING,
    STRIBECK_EXPONENT,
    STRIBECK_SPEED,
)
from ssmr_ident.physics.tire import (
    combined_share,
    contact_force,
    grip_shares,
    printed_force,
    release_share,
    sliding_force,
    weakened,
)
from ssmr_ident.simulate.angles import sin_cos
from ssmr_ident.simulate.belts import take_up
from ssmr_ident.simulate.floor import contact_speed, floor_height, rough_height
from ssmr_ident.simulate.layout import (
    AS_PRINTED,
    DX,
    DY,
    DZ,
    GRAVITY_G,
    GRIPPING,
    INERTIA,
    INVERSE_INERTIA,
    KX,
    KY,
    KZ,
    LAMBDA_MAX,
    LOADED,
    MASS,
    MOTOR_GAIN,
    MU_KINETIC,
    MU_STATIC,
    PATCH_MASS,
    POINTS,
    RADIUS,
    RELEASE_DRAG,
    SENSOR,
    SLIDING_SPEED,
    SLIP_COUPLING,
    UNSEEN,
)  # fmt: skip
from ssmr_ident.simulate.mast import accelerate_with_mast
from ssmr_ident.simulate.pulling import (
    HELD,
    HOOK_X,
    HOOK_Y,
    HOOK_Z,
    PULL_X,
    PULL_Y,
    PULLED,
    cable_tension,
    head_motion,
    hook_position,
)

_JOINT_DEPTH, _ECCENTRICITY, _ROUGHNESS = slots.JOINT_DEPTH, slots.ECCENTRICITY, slots.ROUGHNESS
_CUBIC, _KNEE, _QUADRATIC = slots.CUBIC, slots.KNEE_SHARE, slots.QUADRATIC
_CUBIC_SHARE = slots.CUBIC_SHARE
_FRICTION, _ALPHA = slots.FRICTION_FORCE, slots.ALPHA
_RELAXATION, _GAP, _LIFT, _CORIOLIS = slots.RELAXATION_STIFFNESS, slots.GAP, slots.LIFT, slots.CORIOLIS
_FREE, _TERMS = slots.UNLISTED, len(unlisted.TERMS)
_stribeck, _load_law = stribeck.coefficient, lanewise(load_sensitive_friction.coefficient)
_rolling = rolling_resistance.force
_belt_force, _lifted, _unlisted = motor_belt.force, lift_effect.load, unlisted.force


@kernel
def run(
    p, e, floor, floor_begin, mast, pulling, head, head_last, head_step, reference, reference_step, start, step, steps,
    stride, low_pass, out, beyond,
):  # fmt: skip
    """Integrate ``steps`` steps and store every ``stride``-th state in ``out``.

    All arrays but ``floor`` and ``reference`` may hold lanes (``core.lanes``): as many robots at once then, whose
    effects are on and off alike, and whose wheels are on the same sides.

    Parameters
    ----------
    p : (PARAMETERS,) float
    e : (SLOTS,) float
        Effects.
    floor : (k n²,) float, or None
        Fields in units of their roughness; None where nothing acts that makes a floor uneven.
    floor_begin : float
        Place in ``floor`` where the field under the robot begins.
    mast : (8, 8) float
        Inverse mass matrix of body and swaying mast; not used while the mast is stiff.
    pulling : (PULLING,) float
    head : (head_last + 1,) float [m]
        Position of the pulling head at multiples of ``head_step`` [s].
    reference : (k, 2) float [rad/s]
        Wanted rates of the left and right wheels at multiples of ``reference_step`` [s].
    start : (START,) float
    step : float [s]
    steps, stride : int
    low_pass : (5,) float
        Difference equation of the accelerometer at ``step``.
    out : (steps // stride + 1, len(OUTPUTS)) float
    beyond : bool or None
        None where no effect but a rough floor acts and nothing pulls: a loop of its own is then compiled from this very
        text, in which none of that is asked for any more.

    Returns
    -------
    float
        The step at which a state was no longer finite, or -1.
    """
    mass, gravity = p[MASS], p[GRAVITY_G]
    kx, ky, kz, dx, dy, dz = p[KX], p[KY], p[KZ], p[DX], p[DY], p[DZ]
    patch, radius, lambda_max, gain = p[PATCH_MASS], p[RADIUS], p[LAMBDA_MAX], p[MOTOR_GAIN]
    coupling, nominal_load = p[SLIP_COUPLING], 0.25 * p[MASS] * p[GRAVITY_G]
    drag_share = release_share(p[MU_STATIC], p[MU_KINETIC], p[RELEASE_DRAG])
    sliding_speed, together = p[SLIDING_SPEED], first(p[SLIDING_SPEED]) > 0.0
    printed = first(p[AS_PRINTED]) > 0.0
    coast_x, coast_y = 0.0 * patch, 0.0 * patch  # shares of a contact's speed that its own damper leaves after a step
    if printed:
        drag_share = p[RELEASE_DRAG]
        coast_x = where(patch > 0.0, exp(-dx * step / patch), 0.0)
        coast_y = where(patch > 0.0, exp(-dy * step / patch), 0.0)
    inv, tensor = INVERSE_INERTIA, INERTIA
    beside = remembers = patterned = rough = falling = load_law = swaying = stretching = lift = smooth = pulled = (
        held
    ) = False
    coriolis = rolling = 0.0
    if floor is not None:
        rough = first(e[_ROUGHNESS]) != 0.0
    if beyond is not None:
        remembers = first(e[_FRICTION]) != 0.0 or first(e[_ALPHA]) != 1.0 or first(e[_RELAXATION]) != 0.0
        beside = remembers or (
            first(e[_CUBIC]) != 0.0
            or first(e[_CUBIC_SHARE]) != 0.0
            or first(e[_KNEE]) != 0.0
            or first(e[_QUADRATIC]) != 0.0
            or first(e[_GAP]) != 0.0
        )
        if floor is not None:
            patterned = first(e[_JOINT_DEPTH]) != 0.0 or first(e[_ECCENTRICITY]) != 0.0
        falling, load_law = first(e[KINETIC_SHARE]) != 1.0, first(e[LOAD_EXPONENT]) != 0.0
        swaying, stretching = math.isfinite(first(e[MAST_HZ])), math.isfinite(first(e[BELT_STIFFNESS]))
        lift, coriolis, rolling = first(e[_LIFT]) > 0.5, e[_CORIOLIS], e[ROLLING]
        for term in range(_TERMS):
            smooth = smooth or first(e[_FREE + term]) != 0.0
        pulled, held = first(pulling[PULLED]) > 0.5, first(pulling[HELD]) > 0.5
    lift = lift or printed  # (4.15) as printed: N is never below 0
    turning_back, coupled, rolls = first(coriolis) != 0.0, first(coupling) != 0.0, first(rolling) != 0.0
    uneven, share_x_gap = patterned or rough, e[GAP_SHARE_X]

    x, y, z, roll, pitch, yaw = start[0], start[1], start[2], start[3], start[4], start[5]
    u, v, w = start[6], start[7], start[8]
    wx, wy, wz = start[9], start[10], start[11]
    rate_left, rate_right, angle_left, angle_right = start[12], start[13], 0.0, 0.0
    au = av = aw = bx = by = bz = 0.0  # accelerations of the last step
    roll_rate = pitch_rate = yaw_rate = 0.0

    deflection = space(p, 4, 2)
    for i in range(4):
        deflection[i, 0], deflection[i, 1] = start[14 + 2 * i], start[15 + 2 * i]
    belt = space(p, 3, 2)  # length, its rate, and pull of left and right
    if stretching:
        take_up(p, e[BELT_STIFFNESS], start, deflection, belt)
    contact, slip = space(p, 4, 2), space(p, 4, 2)  # velocities of contact points, and of hubs over them
    sliding = space(p, 4, 2)  # 1 where a contact slides
    on_hub = space(p, 4, 2)  # forces
    hidden = space(p, 12, STATES)  # of x, y, z of the first wheel, then of the next
    law = inner_slots(e)
    if beside and anywhere(start[LOADED] != 0.0):
        for i in range(12):
            pressed = start[LOADED + 1 + i // 3] if i % 3 == 2 else deflection[i // 3, i % 3]
            hidden[i, 0], hidden[i, 1], hidden[i, 2] = element_loaded(pressed, start[LOADED], i % 3 < 2, law)
    arm, load, path, ground_rate = space(p, 4, 3), space(p, 1, 4), space(p, 1, 4), space(p, 1, 4)
    sway = space(p, 3, 2)  # of the mast, its rate and its acceleration
    sway[0, 0], sway[0, 1], sway[1, 0], sway[1, 1] = start[22], start[23], start[24], start[25]
    solved = space(p, 1, 8)
    history = space(p, 3, 4)  # of the accelerometer's low-pass: u', u'', y', y'' per axis
    decay = math.exp(-gain * step)

    # where the hook stands at rest, so that the cable starts without slack
    hook_start, tension_last = 0.0, 0.0
    if pulled:
        sr, cr = sin_cos(roll)
        sp, cp = sin_cos(pitch)
        syaw, cyaw = sin_cos(yaw)
        a, b, c = pulling[HOOK_X], pulling[HOOK_Y], pulling[HOOK_Z]
        hook_start = hook_position(pulling, x, y, syaw, cyaw, cp * a + sp * sr * b + sp * cr * c, cr * b - sr * c)
    reference_last = reference.shape[0] - 1

    row, failed = 0, -1.0
    for n in range(steps + 1):
        t = n * step
        # velocity at this whole step
        ue, ve, we = u + 0.5 * step * au, v + 0.5 * step * av, w + 0.5 * step * aw
        pe, qe, re = wx + 0.5 * step * bx, wy + 0.5 * step * by, wz + 0.5 * step * bz
        sr, cr = sin_cos(roll)
        sp, cp = sin_cos(pitch)
        r01, r02, r12, r21, r22 = sp * sr, sp * cr, -sr, cp * sr, cp * cr
        # angular velocity along the heading axes
        ox, oy, oz = cp * pe + r01 * qe + r02 * re, cr * qe + r12 * re, -sp * pe + r21 * qe + r22 * re

        fx, fy, fz = 0.0, 0.0, 0.0
        tx, ty, tz = 0.0, 0.0, 0.0
        any_sliding = 0.0
        belt[2, 0] = belt[2, 1] = 0.0
        cyaw, syaw = 1.0, 0.0
        if uneven or pulled:
            syaw, cyaw = sin_cos(yaw)
        for i in range(4):
            a, b, c = p[POINTS + 3 * i], p[POINTS + 3 * i + 1], p[POINTS + 3 * i + 2]
            side = 0 if first(b) > 0.0 else 1
            rx, ry, rz = cp * a + r01 * b + r02 * c, cr * b + r12 * c, -sp * a + r21 * b + r22 * c
            arm[i, 0], arm[i, 1], arm[i, 2] = rx, ry, rz
            hub_x, hub_y, hub_z = ue + oy * rz - oz * ry, ve + oz * rx - ox * rz, we + ox * ry - oy * rx
            rate = rate_left if side == 0 else rate_right
            rim = radius * rate
            depth, sinking = -(z + rz), -hub_z
            if floor is not None and uneven:
                angle = angle_left if side == 0 else angle_right
                level, change = 0.0, 0.0
                if patterned:
                    level, change = floor_height(law, i, path[0, i], contact_speed(hub_x, hub_y), angle, rate)
                if rough:
                    height, climbing = rough_height(
                        floor, floor_begin, e[_ROUGHNESS], x + cyaw * rx - syaw * ry, y + syaw * rx + cyaw * ry,
                        cyaw * hub_x - syaw * hub_y, syaw * hub_x + cyaw * hub_y,
                    )  # fmt: skip
                    level, change = level + height, change + climbing
                depth, sinking = depth + level, sinking + change
                ground_rate[0, i] = change
            normal = kz * depth + dz * sinking
            if beside:
                kept = hidden[3 * i + 2, 0], hidden[3 * i + 2, 1], hidden[3 * i + 2, 2]
                normal += element_force(depth, sinking, kept, kz, kz / ky, 0.0, False, law)
            if lift:
                normal = _lifted(normal, depth)
            load[0, i] = normal
            weight = max(normal, 0.0) * p[GRIPPING + i]
            slip_before_x, slip_before_y = slip[i, 0], slip[i, 1]
            slip[i, 0], slip[i, 1] = hub_x - rim, hub_y
            if stretching:
                slip[i, 0] -= belt[1, side]
            share_x, share_y = 1.0, 1.0
            if coupled:
                if together:
                    share_x = combined_share(rim, slip[i, 0], hub_y, lambda_max)
                    share_y = share_x
                else:
                    share_x, share_y = grip_shares(rim, slip[i, 0], hub_y, lambda_max)
                share_x, share_y = 1.0 - coupling * (1.0 - share_x), 1.0 - coupling * (1.0 - share_y)
            mu_s, mu_k = p[MU_STATIC], p[MU_KINETIC]
            if load_law:
                mu_s, mu_k = (
                    _load_law(mu_s, weight, nominal_load, e[LOAD_EXPONENT]),
                    _load_law(mu_k, weight, nominal_load, e[LOAD_EXPONENT]),
                )
            release = drag_share
            if together:
                speed = contact_speed(contact[i, 0], contact[i, 1])
                mu_s = weakened(mu_s, mu_k, speed, sliding_speed)
                if falling:
                    mu_s = _stribeck(mu_s, e[KINETIC_SHARE], speed, e[STRIBECK_SPEED], e[STRIBECK_EXPONENT])
            elif falling:  # friction over speed takes the place of the relay's lower limit, and acts while sliding
                speed = contact_speed(contact[i, 0], contact[i, 1])
                mu_k, release = _stribeck(mu_s, e[KINETIC_SHARE], speed, e[STRIBECK_SPEED], e[STRIBECK_EXPONENT]), 1.0
            beside_x, beside_y = 0.0, 0.0
            if beside:
                kept = hidden[3 * i, 0], hidden[3 * i, 1], hidden[3 * i, 2]
                rate_x, rate_y = slip[i, 0] - contact[i, 0], hub_y - contact[i, 1]
                beside_x = element_force(deflection[i, 0], rate_x, kept, kx, kx / ky, share_x_gap, True, law)
                kept = hidden[3 * i + 1, 0], hidden[3 * i + 1, 1], hidden[3 * i + 1, 2]
                beside_y = element_force(deflection[i, 1], rate_y, kept, ky, 1.0, 1.0, True, law)
            if smooth:
                free = free_slots(e)
                beside_x += _unlisted(deflection[i, 0], slip[i, 0] - contact[i, 0], t, kx / ky, free)
                beside_y += _unlisted(deflection[i, 1], hub_y - contact[i, 1], t, 1.0, free)
            if together:
                slides, contact_x, contact_y, force_x, force_y = sliding_force(
                    (deflection[i, 0], deflection[i, 1]), (contact[i, 0], contact[i, 1]), (slip[i, 0], hub_y),
                    (beside_x, beside_y), (kx, ky), (dx, dy), patch, mu_s * share_x * weight, step,
                )  # fmt: skip
                sliding[i, 0] = sliding[i, 1] = where(slides, 1.0, 0.0)
                contact[i, 0], contact[i, 1] = contact_x, contact_y
            elif printed:
                faster_x, faster_y = 0.0 * hub_y, 0.0 * hub_y
                if n > 0:
                    faster_x, faster_y = (slip[i, 0] - slip_before_x) / step, (hub_y - slip_before_y) / step
                limit, grip = mu_s * share_x * weight, mu_k * share_x * weight
                slides, contact[i, 0], force_x = printed_force(
                    deflection[i, 0], sliding[i, 0] != 0.0, contact[i, 0], (slip[i, 0], faster_x), beside_x, kx, dx,
                    patch, limit, grip, release * grip, coast_x, step,
                )  # fmt: skip
                sliding[i, 0] = where(slides, 1.0, 0.0)
                limit, grip = mu_s * share_y * weight, mu_k * share_y * weight
                slides, contact[i, 1], force_y = printed_force(
                    deflection[i, 1], sliding[i, 1] != 0.0, contact[i, 1], (hub_y, faster_y), beside_y, ky, dy,
                    patch, limit, grip, release * grip, coast_y, step,
                )  # fmt: skip
                sliding[i, 1] = where(slides, 1.0, 0.0)
            else:
                limit, grip = mu_s * share_x * weight, mu_k * share_x * weight
                slides, contact[i, 0], force_x = contact_force(
                    deflection[i, 0], sliding[i, 0] != 0.0, contact[i, 0], slip[i, 0], beside_x, kx, dx, patch,
                    limit, grip, release * grip, step,
                )  # fmt: skip
                sliding[i, 0] = where(slides, 1.0, 0.0)
                limit, grip = mu_s * share_y * weight, mu_k * share_y * weight
                slides, contact[i, 1], force_y = contact_force(
                    deflection[i, 1], sliding[i, 1] != 0.0, contact[i, 1], hub_y, beside_y, ky, dy, patch,
                    limit, grip, release * grip, step,
                )  # fmt: skip
                sliding[i, 1] = where(slides, 1.0, 0.0)
            any_sliding += max(sliding[i, 0], sliding[i, 1])
            on_hub[i, 0], on_hub[i, 1] = force_x, force_y
            if stretching:
                belt[2, side] += force_x
            if rolls and anywhere(rim != 0.0):
                force_x += _rolling(weight, hub_x, rolling)
            fx += force_x
            fy += force_y
            fz += normal
            tx += ry * normal - rz * force_y
            ty += rz * force_x - rx * normal
            tz += rx * force_y - ry * force_x

        tension, head_now = 0.0, 0.0
        if pulled:
            head_now, head_rate = head_motion(head, head_last, head_step, t)
            pull_x, pull_y = pulling[PULL_X], pulling[PULL_Y]
            along_x, along_y = cyaw * pull_x + syaw * pull_y, -syaw * pull_x + cyaw * pull_y
            a, b, c = pulling[HOOK_X], pulling[HOOK_Y], pulling[HOOK_Z]
            hx, hy, hz = cp * a + r01 * b + r02 * c, cr * b + r12 * c, -sp * a + r21 * b + r22 * c
            hook = hook_position(pulling, x, y, syaw, cyaw, hx, hy) - hook_start
            hook_rate = along_x * (ue + oy * hz - oz * hy) + along_y * (ve + oz * hx - ox * hz)
            tension = cable_tension(pulling, head_now, head_rate, hook, hook_rate, tension_last, 0.5 * step)
            tension_last = tension
            fx += along_x * tension
            fy += along_y * tension
            tx -= hz * along_y * tension
            ty += hz * along_x * tension
            tz += (hx * along_y - hy * along_x) * tension
        if held:  # a fixture that keeps the robot from driving off and from turning, not from being pulled sideways;
            # implicit, for it is stiffer than all else and would ask for steps that nothing else does
            fx = (fx - 1e6 * x - 2e4 * ue) / (1.0 + step * (2e4 + step * 1e6) / mass)
            tz = (tz - 1e5 * yaw - 2e3 * oz) / (1.0 + step * (2e3 + step * 1e5) * p[inv + 8])

        # accelerations; torque and rates in body axes
        body_x, body_y, body_z = cp * tx - sp * tz, r01 * tx + cr * ty + r21 * tz, r02 * tx + r12 * ty + r22 * tz
        if turning_back:
            lx = p[tensor + 0] * pe + p[tensor + 1] * qe + p[tensor + 2] * re
            ly = p[tensor + 3] * pe + p[tensor + 4] * qe + p[tensor + 5] * re
            lz = p[tensor + 6] * pe + p[tensor + 7] * qe + p[tensor + 8] * re
            body_x -= coriolis * (qe * lz - re * ly)
            body_y -= coriolis * (re * lx - pe * lz)
            body_z -= coriolis * (pe * ly - qe * lx)
        if swaying:
            ahead = 0.5 * step
            sway_ahead = sway[1, 0] + ahead * sway[2, 0], sway[1, 1] + ahead * sway[2, 1]
            fz_all = fz - mass * gravity
            forces = cp * fx - sp * fz_all, r01 * fx + cr * fy + r21 * fz_all, r02 * fx + r12 * fy + r22 * fz_all
            pull_down = sp * gravity, -r21 * gravity, -r22 * gravity  # gravity along the body axes
            accelerate_with_mast(
                mast, e, (sway[0, 0], sway[0, 1]), sway_ahead, forces, (body_x, body_y, body_z), pull_down, solved
            )
            au = cp * solved[0, 0] + r01 * solved[0, 1] + r02 * solved[0, 2]
            av = cr * solved[0, 1] + r12 * solved[0, 2]
            aw = -sp * solved[0, 0] + r21 * solved[0, 1] + r22 * solved[0, 2]
            bx, by, bz = solved[0, 3], solved[0, 4], solved[0, 5]
            sway[2, 0], sway[2, 1] = solved[0, 6], solved[0, 7]
        else:
            au, av, aw = fx / mass, fy / mass, fz / mass - gravity
            bx = p[inv + 0] * body_x + p[inv + 1] * body_y + p[inv + 2] * body_z
            by = p[inv + 3] * body_x + p[inv + 4] * body_y + p[inv + 5] * body_z
            bz = p[inv + 6] * body_x + p[inv + 7] * body_y + p[inv + 8] * body_z
        force_u, force_v, force_w = au, av, aw + gravity
        if turning_back:
            au += coriolis * oz * ve
            av -= coriolis * oz * ue

        # specific force at the accelerometer, body axes, through its low-pass (3.4)
        px, py, pz = p[SENSOR], p[SENSOR + 1], p[SENSOR + 2]
        centripetal = pe * px + qe * py + re * pz
        spin = pe * pe + qe * qe + re * re
        ax = cp * force_u - sp * force_w + by * pz - bz * py + pe * centripetal - spin * px
        ay = r01 * force_u + cr * force_v + r21 * force_w + bz * px - bx * pz + qe * centripetal - spin * py
        az = r02 * force_u + r12 * force_v + r22 * force_w + bx * py - by * px + re * centripetal - spin * pz
        if n == 0:
            # the low-pass starts as if the first value had always been there, or that of a robot held in this pose
            new = start[UNSEEN]
            for j in range(4):
                history[0, j] = ax - new * (ax + sp * gravity)
                history[1, j] = ay - new * (ay - r21 * gravity)
                history[2, j] = az - new * (az - r22 * gravity)
        ax = filter_step(history, 0, ax, low_pass)
        ay = filter_step(history, 1, ay, low_pass)
        az = filter_step(history, 2, az, low_pass)

        if n % stride == 0:
            out[row, 0], out[row, 1], out[row, 2], out[row, 3], out[row, 4], out[row, 5] = ax, ay, az, pe, qe, re
            out[row, 6], out[row, 7], out[row, 8], out[row, 9] = x, y, z, roll
            out[row, 10], out[row, 11], out[row, 12], out[row, 13] = pitch, yaw, ue, ve
            out[row, 14], out[row, 15], out[row, 16], out[row, 17] = tension, head_now, rate_left, rate_right
            out[row, 18] = any_sliding
            for i in range(4):
                out[row, 19 + i], out[row, 23 + i], out[row, 27 + i] = load[0, i], on_hub[i, 0], on_hub[i, 1]
            row += 1
            finite = math.isfinite(x) & math.isfinite(z) & math.isfinite(yaw) & math.isfinite(az)
            failed = where(finite | (failed >= 0.0), failed, 1.0 * n)
            if not anywhere(failed < 0.0):
                return failed

        # kick: to the next half step (half a step at the very start)
        kick = step if n > 0 else 0.5 * step
        u, v, w = u + kick * au, v + kick * av, w + kick * aw
        wx, wy, wz = wx + kick * bx, wy + kick * by, wz + kick * bz
        if swaying:
            for j in range(2):
                sway[1, j] += kick * sway[2, j]
                sway[0, j] += step * sway[1, j]
        if stretching:
            for j in range(2):
                # the tire pulls the rim along with minus its force on the hub; a light rim asks for the implicit form
                pushed = belt[1, j] - kick / e[RIM_MASS] * (
                    belt[2, j] - _belt_force(belt[0, j], 0.0, e[BELT_STIFFNESS], 0.0)
                )
                belt[1, j] = pushed / (1.0 + kick * e[BELT_DAMPING] / e[RIM_MASS])
                belt[0, j] += step * belt[1, j]
        # carcasses follow the hubs half a step on
        ox, oy, oz = cp * wx + r01 * wy + r02 * wz, cr * wy + r12 * wz, -sp * wx + r21 * wy + r22 * wz
        for i in range(4):
            rx, ry, rz = arm[i, 0], arm[i, 1], arm[i, 2]
            side = 0 if first(p[POINTS + 3 * i + 1]) > 0.0 else 1
            hub_x, hub_y = u + oy * rz - oz * ry, v + oz * rx - ox * rz
            slip_x = hub_x - radius * (rate_left if side == 0 else rate_right)
            if stretching:
                slip_x -= belt[1, side]
            deflection[i, 0] += step * (slip_x - contact[i, 0])
            deflection[i, 1] += step * (hub_y - contact[i, 1])
            if uneven:
                path[0, i] += step * contact_speed(hub_x, hub_y)
            if remembers:
                for axis in range(3):
                    element = 3 * i + axis
                    kept = hidden[element, 0], hidden[element, 1], hidden[element, 2]
                    if axis == 0:
                        kept = element_next(kept, slip_x - contact[i, 0], step, True, law)
                    elif axis == 1:
                        kept = element_next(kept, hub_y - contact[i, 1], step, True, law)
                    else:
                        kept = element_next(kept, ground_rate[0, i] - (w + ox * ry - oy * rx), step, False, law)
                    hidden[element, 0], hidden[element, 1], hidden[element, 2] = kept
        # drift: pose rates with the angles half a step ahead
        sr, cr = sin_cos(roll + 0.5 * step * roll_rate)
        sp, cp = sin_cos(pitch + 0.5 * step * pitch_rate)
        syaw, cyaw = sin_cos(yaw + 0.5 * step * yaw_rate)
        turning = (sr * wy + cr * wz) / cp
        roll_rate, pitch_rate, yaw_rate = wx + sp * turning, cr * wy - sr * wz, turning
        x += step * (cyaw * u - syaw * v)
        y += step * (syaw * u + cyaw * v)
        z += step * w
        roll += step * roll_rate
        pitch += step * pitch_rate
        yaw += step * yaw_rate
        # motors hold their speed whatever the load (6.1): exact for a constant wish
        k = min(int(t / reference_step + 1e-9), reference_last)
        angle_left += step * rate_left
        angle_right += step * rate_right
        rate_left = reference[k, 0] + (rate_left - reference[k, 0]) * decay
        rate_right = reference[k, 1] + (rate_right - reference[k, 1]) * decay
    return failed
