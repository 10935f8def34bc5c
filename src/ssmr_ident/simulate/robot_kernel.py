"""The 6-DOF robot on four tires, one step after the other (thesis section 6.1, eq 2.65).

Velocities are those of the CoM along the heading axes (x where the robot points, z up) and the body's angular
rates; the pose is the CoM in the world and yaw, pitch, roll. In these axes gravity and the floor's normal are
constant, the tires push at the contact points p_i, and small decays obey the determinants of thesis.md section 5.

The method is the staggered leapfrog: positions at whole steps, velocities at half steps, and the velocity that
damping needs at a whole step carried forward by half the last acceleration. Second order, one evaluation of the
forces per step, and no growth of energy in what conserves it.
"""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.sensor import filter_step
from ssmr_ident.physics.tire import contact_force, grip_shares

# Layout of the parameter vector: contact points and inverse inertia follow the scalars.
MASS, KX, KY, KZ, DX, DY, DZ, PATCH_MASS, RADIUS = range(9)
MU_STATIC, MU_KINETIC, LAMBDA_MAX, MOTOR_GAIN, GRAVITY_G = range(9, 14)
RELEASE_DRAG, WHEEL_LIFT, CORIOLIS = range(14, 17)
SENSOR = 17  # three numbers: p_a
POINTS = 20  # twelve numbers: p_i, row by row
INVERSE_INERTIA = 32  # nine numbers
INERTIA = 41  # nine numbers
GRIPPING = 50  # four numbers: share of the friction each wheel has
PARAMETERS = 54

# Layout of the pulling arrangement: cable and fixture.
PULLED, CABLE_K, CABLE_D, PULL_X, PULL_Y, HOOK_X, HOOK_Y, HOOK_Z, HELD = range(9)
PULLING = 9

# Layout of the start: pose, velocities, wheel rates, carcass deflections.
START = 22  # x y z roll pitch yaw | u v w p q r | left right | (x, y) of each wheel

OUTPUTS = ("ax", "ay", "az", "wx", "wy", "wz", "x", "y", "z", "roll", "pitch", "yaw", "vx", "vy", "force", "head",
           "rate_left", "rate_right", "sliding", "load_1", "load_2", "load_3", "load_4")  # fmt: skip


@kernel
def run(p, pulling, head, head_step, reference, reference_step, start, step, steps, stride, low_pass, out):
    """Integrate ``steps`` steps and store every ``stride``-th state in ``out``.

    Parameters
    ----------
    p : (PARAMETERS,) float
    pulling : (PULLING,) float
    head : (m,) float [m]
        Position of the pulling head at multiples of ``head_step`` [s]; straight between, at rest after the end.
    reference : (k, 2) float [rad/s]
        Wanted rates of the left and right wheels at multiples of ``reference_step`` [s].
    start : (START,) float
    step : float [s]
    steps, stride : int
    low_pass : (5,) float
        Difference equation of the accelerometer at ``step``.
    out : (steps // stride + 1, len(OUTPUTS)) float

    Returns
    -------
    int
        The step at which a state was no longer finite, or -1.
    """
    mass, gravity = p[MASS], p[GRAVITY_G]
    kx, ky, kz, dx, dy, dz = p[KX], p[KY], p[KZ], p[DX], p[DY], p[DZ]
    patch, radius, lambda_max, gain = p[PATCH_MASS], p[RADIUS], p[LAMBDA_MAX], p[MOTOR_GAIN]
    mu_s, mu_k, drag_share = p[MU_STATIC], p[MU_KINETIC], p[RELEASE_DRAG]
    lift, coriolis = p[WHEEL_LIFT] > 0.5, p[CORIOLIS]
    inv = p[INVERSE_INERTIA : INVERSE_INERTIA + 9]
    tensor = p[INERTIA : INERTIA + 9]

    x, y, z, roll, pitch, yaw = start[0], start[1], start[2], start[3], start[4], start[5]
    u, v, w = start[6], start[7], start[8]
    wx, wy, wz = start[9], start[10], start[11]
    rate_left, rate_right = start[12], start[13]
    au = av = aw = bx = by = bz = 0.0  # accelerations of the last step
    roll_rate = pitch_rate = yaw_rate = 0.0

    deflection = np.empty((4, 2))
    for i in range(4):
        deflection[i, 0], deflection[i, 1] = start[14 + 2 * i], start[15 + 2 * i]
    contact = np.zeros((4, 2))  # velocity of the contact points
    sliding = np.zeros((4, 2), dtype=np.bool_)
    grip = np.zeros((4, 2))
    arm = np.zeros((4, 3))
    load = np.zeros(4)
    history = np.zeros((3, 4))  # of the accelerometer's low-pass: u', u'', y', y'' per axis
    decay = math.exp(-gain * step)

    # where the hook stands at rest, so that the cable starts without slack
    pulled, held = pulling[PULLED] > 0.5, pulling[HELD] > 0.5
    hook_start = 0.0
    if pulled:
        hx, hy, _ = _to_heading(roll, pitch, pulling[HOOK_X], pulling[HOOK_Y], pulling[HOOK_Z])
        cy0, sy0 = math.cos(yaw), math.sin(yaw)
        hook_start = pulling[PULL_X] * (x + cy0 * hx - sy0 * hy) + pulling[PULL_Y] * (y + sy0 * hx + cy0 * hy)
    head_last, reference_last = head.shape[0] - 1, reference.shape[0] - 1

    row = 0
    for n in range(steps + 1):
        t = n * step
        # velocity at this whole step
        ue, ve, we = u + 0.5 * step * au, v + 0.5 * step * av, w + 0.5 * step * aw
        pe, qe, re = wx + 0.5 * step * bx, wy + 0.5 * step * by, wz + 0.5 * step * bz
        cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
        r01, r02, r12, r21, r22 = sp * sr, sp * cr, -sr, cp * sr, cp * cr
        # angular velocity along the heading axes
        ox, oy, oz = cp * pe + r01 * qe + r02 * re, cr * qe + r12 * re, -sp * pe + r21 * qe + r22 * re

        fx, fy, fz = 0.0, 0.0, 0.0
        tx, ty, tz = 0.0, 0.0, 0.0
        any_sliding = 0.0
        for i in range(4):
            a, b, c = p[POINTS + 3 * i], p[POINTS + 3 * i + 1], p[POINTS + 3 * i + 2]
            rx, ry, rz = cp * a + r01 * b + r02 * c, cr * b + r12 * c, -sp * a + r21 * b + r22 * c
            hub_x, hub_y, hub_z = ue + oy * rz - oz * ry, ve + oz * rx - ox * rz, we + ox * ry - oy * rx
            normal = -kz * (z + rz) - dz * hub_z
            if (lift and normal < 0.0) or (lift and z + rz > 0.0):
                normal = 0.0
            load[i] = normal
            weight = max(normal, 0.0) * p[GRIPPING + i]
            rim = radius * (rate_left if b > 0.0 else rate_right)
            slip_x = hub_x - rim
            share_x, share_y = grip_shares(rim, slip_x, hub_y, lambda_max)
            grip[i, 0], grip[i, 1] = mu_k * share_x * weight, mu_k * share_y * weight
            limit = mu_s * share_x * weight
            sliding[i, 0], contact[i, 0], force_x = contact_force(
                deflection[i, 0],
                sliding[i, 0],
                contact[i, 0],
                slip_x,
                kx,
                dx,
                patch,
                limit,
                grip[i, 0],
                drag_share * grip[i, 0],
                step,
            )
            limit = mu_s * share_y * weight
            sliding[i, 1], contact[i, 1], force_y = contact_force(
                deflection[i, 1],
                sliding[i, 1],
                contact[i, 1],
                hub_y,
                ky,
                dy,
                patch,
                limit,
                grip[i, 1],
                drag_share * grip[i, 1],
                step,
            )
            arm[i, 0], arm[i, 1], arm[i, 2] = rx, ry, rz
            if sliding[i, 0] or sliding[i, 1]:
                any_sliding += 1.0
            fx += force_x
            fy += force_y
            fz += normal
            tx += ry * normal - rz * force_y
            ty += rz * force_x - rx * normal
            tz += rx * force_y - ry * force_x

        tension, head_now = 0.0, 0.0
        if pulled:
            position = t / head_step
            k = min(int(position), head_last)
            head_rate = 0.0
            head_now = head[k]
            if k < head_last:
                head_rate = (head[k + 1] - head[k]) / head_step
                head_now += (position - k) * (head[k + 1] - head[k])
            cyaw, syaw = math.cos(yaw), math.sin(yaw)
            pull_x, pull_y = pulling[PULL_X], pulling[PULL_Y]
            hx, hy, hz = _to_heading(roll, pitch, pulling[HOOK_X], pulling[HOOK_Y], pulling[HOOK_Z])
            along_x, along_y = cyaw * pull_x + syaw * pull_y, -syaw * pull_x + cyaw * pull_y
            hook = pull_x * (x + cyaw * hx - syaw * hy) + pull_y * (y + syaw * hx + cyaw * hy) - hook_start
            hook_rate = along_x * (ue + oy * hz - oz * hy) + along_y * (ve + oz * hx - ox * hz)
            tension = pulling[CABLE_K] * (head_now - hook) + pulling[CABLE_D] * (head_rate - hook_rate)
            if tension < 0.0 or head_now < hook:  # a cable never pushes
                tension = 0.0
            fx += along_x * tension
            fy += along_y * tension
            tx += -hz * along_y * tension
            ty += hz * along_x * tension
            tz += (hx * along_y - hy * along_x) * tension
        if (
            held
        ):  # a fixture that keeps the robot from driving off and from turning, not from being pulled sideways
            fx -= 1e6 * x + 2e4 * ue
            tz -= 1e5 * yaw + 2e3 * oz

        # accelerations; torque and rates in body axes
        body_x, body_y, body_z = cp * tx - sp * tz, r01 * tx + cr * ty + r21 * tz, r02 * tx + r12 * ty + r22 * tz
        au, av, aw = fx / mass, fy / mass, fz / mass - gravity
        force_u, force_v, force_w = au, av, aw + gravity
        if coriolis != 0.0:
            au += coriolis * oz * ve
            av -= coriolis * oz * ue
            lx = tensor[0] * pe + tensor[1] * qe + tensor[2] * re
            ly = tensor[3] * pe + tensor[4] * qe + tensor[5] * re
            lz = tensor[6] * pe + tensor[7] * qe + tensor[8] * re
            body_x -= coriolis * (qe * lz - re * ly)
            body_y -= coriolis * (re * lx - pe * lz)
            body_z -= coriolis * (pe * ly - qe * lx)
        bx = inv[0] * body_x + inv[1] * body_y + inv[2] * body_z
        by = inv[3] * body_x + inv[4] * body_y + inv[5] * body_z
        bz = inv[6] * body_x + inv[7] * body_y + inv[8] * body_z

        # specific force at the accelerometer, body axes, through its low-pass (3.4)
        px, py, pz = p[SENSOR], p[SENSOR + 1], p[SENSOR + 2]
        centripetal = pe * px + qe * py + re * pz
        spin = pe * pe + qe * qe + re * re
        ax = cp * force_u - sp * force_w + by * pz - bz * py + pe * centripetal - spin * px
        ay = r01 * force_u + cr * force_v + r21 * force_w + bz * px - bx * pz + qe * centripetal - spin * py
        az = r02 * force_u + r12 * force_v + r22 * force_w + bx * py - by * px + re * centripetal - spin * pz
        if n == 0:
            _settle(history, ax, ay, az)
        ax = filter_step(history[0], ax, low_pass)
        ay = filter_step(history[1], ay, low_pass)
        az = filter_step(history[2], az, low_pass)

        if n % stride == 0:
            o = out[row]
            o[0], o[1], o[2], o[3], o[4], o[5] = ax, ay, az, pe, qe, re
            o[6], o[7], o[8], o[9], o[10], o[11] = x, y, z, roll, pitch, yaw
            o[12], o[13], o[14], o[15], o[16], o[17] = ue, ve, tension, head_now, rate_left, rate_right
            o[18] = any_sliding
            for i in range(4):
                o[19 + i] = load[i]
            row += 1
            if not (math.isfinite(x) and math.isfinite(z) and math.isfinite(yaw) and math.isfinite(az)):
                return n

        # kick: to the next half step (half a step at the very start)
        kick = step if n > 0 else 0.5 * step
        u, v, w = u + kick * au, v + kick * av, w + kick * aw
        wx, wy, wz = wx + kick * bx, wy + kick * by, wz + kick * bz
        # carcasses follow the hubs half a step on
        ox, oy, oz = cp * wx + r01 * wy + r02 * wz, cr * wy + r12 * wz, -sp * wx + r21 * wy + r22 * wz
        for i in range(4):
            rx, ry, rz = arm[i, 0], arm[i, 1], arm[i, 2]
            hub_x, hub_y = u + oy * rz - oz * ry, v + oz * rx - ox * rz
            rim = radius * (rate_left if p[POINTS + 3 * i + 1] > 0.0 else rate_right)
            deflection[i, 0] += step * (hub_x - rim - contact[i, 0])
            deflection[i, 1] += step * (hub_y - contact[i, 1])
        # drift: pose rates with the angles half a step ahead
        cr, sr = math.cos(roll + 0.5 * step * roll_rate), math.sin(roll + 0.5 * step * roll_rate)
        half_pitch = pitch + 0.5 * step * pitch_rate
        cp, sp = math.cos(half_pitch), math.sin(half_pitch)
        half_yaw = yaw + 0.5 * step * yaw_rate
        cyaw, syaw = math.cos(half_yaw), math.sin(half_yaw)
        turning = (sr * wy + cr * wz) / cp
        roll_rate, pitch_rate, yaw_rate = wx + sp * turning, cr * wy - sr * wz, turning
        x += step * (cyaw * u - syaw * v)
        y += step * (syaw * u + cyaw * v)
        z += step * w
        roll += step * roll_rate
        pitch += step * pitch_rate
        yaw += step * yaw_rate
        # motors hold their speed whatever the load (6.1): exact for a constant wish
        position = t / reference_step
        k = min(int(position), reference_last)
        rate_left = reference[k, 0] + (rate_left - reference[k, 0]) * decay
        rate_right = reference[k, 1] + (rate_right - reference[k, 1]) * decay
    return -1


@kernel
def _to_heading(roll, pitch, a, b, c):
    """A body vector along the heading axes: Ry(pitch)·Rx(roll)·(a, b, c)."""
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    across = sr * b + cr * c
    return cp * a + sp * across, cr * b - sr * c, -sp * a + cp * across


@kernel
def _settle(history, ax, ay, az):
    """Let the low-pass start as if the first value had always been there."""
    for j in range(4):
        history[0, j] = ax
        history[1, j] = ay
        history[2, j] = az
