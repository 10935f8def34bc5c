"""The cable between the robot's hook and the machine's head: it pulls, and never pushes."""

from __future__ import annotations

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import where

PULLED, CABLE_K, CABLE_D, PULL_X, PULL_Y, HOOK_X, HOOK_Y, HOOK_Z, HELD, MOBILITY = range(10)
PULLING = 10


@kernel
def head_motion(head, last, head_step, t):
    """Position [m] and speed [m/s] of the head at time t [s]: straight between its samples, at rest after the last."""
    position = t / head_step
    k = min(int(position + 1e-9), last)
    rate = (head[min(k + 1, last)] - head[k]) / head_step
    if k == last:
        return head[k], rate
    return head[k] + (position - k) * (head[k + 1] - head[k]), rate


@kernel
def hook_position(pulling, x, y, sin, cos, hx, hy):
    """Where the hook is along the direction of pull [m]; sine and cosine are those of yaw, and (hx, hy) is the hook
    along the heading axes [m]."""
    return pulling[PULL_X] * (x + cos * hx - sin * hy) + pulling[PULL_Y] * (y + sin * hx + cos * hy)


@kernel
def cable_tension(pulling, head, head_rate, hook, hook_rate, last, half):
    """K·stretch + D·rate [N], and 0 where that would push or the cable is slack.

    The hook's rate was carried forward with the tension of the last step; what this step's changes of it is taken
    along implicitly, so that a stiff damper asks for no short step.

    Parameters
    ----------
    head, hook : float [m]
    head_rate, hook_rate : float [m/s]
    last : float [N]
        Tension of the last step.
    half : float [s]
        Half a step.
    """
    stretch = head - hook
    share = pulling[CABLE_D] * pulling[MOBILITY] * half
    tension = pulling[CABLE_K] * stretch + pulling[CABLE_D] * (head_rate - hook_rate)
    tension = (tension + share * last) / (1.0 + share)
    return where((tension > 0.0) & (stretch >= 0.0), tension, 0.0)
