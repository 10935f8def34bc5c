"""Bench tests of one wheel or one block: dragged sideways, pressed down, pulled over a surface."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.physics.rig import Block
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.tire import contact_force


def drag_wheel(robot: Robot, head: np.ndarray, step: float, free_normal: bool = True) -> np.ndarray:
    """Lateral force on one wheel whose hub follows the machine's head (section 3.3).

    The wheel carries a quarter of the weight. Held at a fixed height (``free_normal`` false) it wedges and does
    not let go, which is what the thesis saw.

    Parameters
    ----------
    robot : Robot
    head : (n,) float [m]
        Position of the head at multiples of ``step``.
    step : float [s]

    Returns
    -------
    (n,) float [N]
        What the load cell reads, pull positive.
    """
    load = robot.mass * GRAVITY / 4.0
    grip = (robot.mu_static * load, robot.mu_kinetic * load) if free_normal else (math.inf, math.inf)
    force = np.empty(len(head))
    substeps = max(1, math.ceil(step / 2e-4))
    _drag(robot.stiffness[1], robot.damping[1], robot.effective_mass, *grip, head - head[0], step, substeps, force)
    return force


def compress_wheel(robot: Robot, head: np.ndarray, step: float, gap: float = 0.0) -> np.ndarray:
    """Vertical force on one wheel pressed down by ``head`` (4.15); it touches after ``gap`` [m].

    Returns
    -------
    (n,) float [N]
        Compression positive.
    """
    depth = head - head[0] - gap
    force = robot.stiffness[2] * depth + robot.damping[2] * np.gradient(head, step)
    return np.where(depth > 0.0, np.maximum(force, 0.0), 0.0)


def pull_block(block: Block, head: np.ndarray, step: float) -> np.ndarray:
    """Force in the cable of a block whose cable end follows the machine's head.

    A stiff cable (infinite stiffness) carries the kinetic friction as long as the head moves; a compliant one
    stretches until the static friction is overcome, and the block may then stick and slip.

    Returns
    -------
    (n,) float [N]
    """
    weight = block.mass * GRAVITY
    if math.isinf(block.cable_stiffness):
        return np.where(np.gradient(head, step) > 0.0, block.mu_kinetic * weight, 0.0)
    force = np.empty(len(head))
    omega = math.sqrt(block.cable_stiffness / block.mass)
    substeps = max(1, math.ceil(step * omega / 0.05))
    # a cable that rings is damped like the thesis' cable (section 4)
    damping = 4.0 * math.sqrt(block.mass * block.cable_stiffness)
    _block(
        block.mass, block.cable_stiffness, damping, block.mu_static * weight, block.mu_kinetic * weight,
        head - head[0], step, substeps, force,
    )  # fmt: skip
    return force


@kernel
def _drag(stiffness, damping, mass, breakaway, grip, head, step, substeps, out):
    deflection, velocity, sliding = 0.0, 0.0, False
    h = step / substeps
    for n in range(out.shape[0]):
        hub = (head[n + 1] - head[n]) / step if n + 1 < out.shape[0] else 0.0
        for m in range(substeps):
            sliding, velocity, force = contact_force(
                deflection, sliding, velocity, hub, 0.0, stiffness, damping, mass, breakaway, grip, 0.0, h
            )
            if m == 0:
                out[n] = -force
            deflection += h * (hub - velocity)


@kernel
def _block(mass, stiffness, damping, breakaway, kinetic, head, step, substeps, out):
    x, v = 0.0, 0.0
    h = step / substeps
    for n in range(out.shape[0]):
        rate = (head[n + 1] - head[n]) / step if n + 1 < out.shape[0] else 0.0
        for m in range(substeps):
            position = head[n] + rate * m * h
            tension = max(0.0, stiffness * (position - x) + damping * (rate - v))
            if m == 0:
                out[n] = tension
            if v == 0.0 and tension <= breakaway:
                continue
            # implicit in the velocity, so that a stiff damper needs no short step
            driving = mass * v + h * (stiffness * (position - x) + damping * rate - kinetic)
            v = max(0.0, driving / (mass + h * damping))
            x += h * v
