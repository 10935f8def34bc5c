"""The cable between the robot's hook and the machine's head: it pulls, and never pushes."""

from __future__ import annotations

import math

from ssmr_ident.core.kernel import kernel

PULLED, CABLE_K, CABLE_D, PULL_X, PULL_Y, HOOK_X, HOOK_Y, HOOK_Z, HELD = range(9)
PULLING = 9


@kernel
def head_motion(head, head_step, t):
    """Position [m] and speed [m/s] of the head at time t [s]: straight between its samples, at rest after the end."""
    last = head.shape[0] - 1
    position = t / head_step
    k = min(int(position + 1e-9), last)
    if k == last:
        return head[last], 0.0
    rate = (head[k + 1] - head[k]) / head_step
    return head[k] + (position - k) * (head[k + 1] - head[k]), rate


@kernel
def hook_position(pulling, x, y, yaw, hx, hy):
    """Where the hook is along the direction of pull [m]; (hx, hy) is the hook along the heading axes [m]."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return pulling[PULL_X] * (x + cos * hx - sin * hy) + pulling[PULL_Y] * (y + sin * hx + cos * hy)


@kernel
def cable_tension(pulling, head, head_rate, hook, hook_rate):
    """K·stretch + D·rate [N], and 0 where that would push or the cable is slack; all [m] and [m/s]."""
    stretch = head - hook
    tension = pulling[CABLE_K] * stretch + pulling[CABLE_D] * (head_rate - hook_rate)
    return tension if tension > 0.0 and stretch >= 0.0 else 0.0
