"""Bench tests of one wheel or one block: dragged sideways, pressed down, pulled over a surface."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.experiments import Experiment
from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE, nonlinear_stiffness, stribeck, unlisted
from ssmr_ident.physics.element import STATES, element_advance, element_force
from ssmr_ident.physics.rig import Block
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.physics.slots import (
    KINETIC_SHARE,
    KNEE,
    KNEE_SHARE,
    STRIBECK_EXPONENT,
    STRIBECK_SPEED,
    UNLISTED,
    Effects,
    checked_for_robot,
    effect_vector,
)
from ssmr_ident.physics.tire import contact_force, printed_force, release_share
from ssmr_ident.simulate.pulled_block import pull
from ssmr_ident.simulate.sensed import sensed

LONGEST_STEP = 2e-4
"""s; a tenth of the carcass' time constant D/K."""

_friction_law, _unlisted, _beyond = stribeck.coefficient, unlisted.force, nonlinear_stiffness.beyond


def drag_wheel(
    robot: Robot,
    head: np.ndarray,
    step: float,
    free_normal: bool = True,
    effects: Effects | None = None,
    longest: float | None = None,
) -> np.ndarray:
    """Lateral force on one wheel whose hub follows the machine's head (section 3.3).

    The wheel carries a quarter of the weight. Held at a fixed height (``free_normal`` false) it wedges and does
    not let go, which is what the thesis saw.

    Parameters
    ----------
    robot : Robot
    head : (n,) float [m]
        Position of the head at multiples of ``step``.
    step : float [s]
    effects : mapping of effect id to parameters
    longest : float, optional [s]
        Of the steps inside, by default ``LONGEST_STEP``; friction that falls with the speed takes none longer.

    Returns
    -------
    (n,) float [N]
        What the load cell reads, pull positive.
    """
    active = checked_for_robot(effects or {})
    load = robot.mass * GRAVITY / 4.0
    grip = (robot.mu_static * load, robot.mu_kinetic * load) if free_normal else (math.inf, math.inf)
    force = np.empty(len(head))
    e = effect_vector(active)
    falling = e[KINETIC_SHARE] != 1.0 or robot.mu_kinetic != robot.mu_static
    substeps = max(1, math.ceil(step / (LONGEST_STEP if falling or longest is None else longest)))
    cable = _cable(math.inf, active)
    tire = (robot.stiffness[1], robot.damping[1], robot.effective_mass, robot.contact == "printed_6_4")
    _drag(*tire, *grip, load, cable, e, head - head[0], step, substeps, force)
    return _read(force, step, active)


def load_wheel(
    robot: Robot,
    experiment: Experiment,
    head: np.ndarray,
    step: float,
    free_normal: bool = True,
    effects: Effects | None = None,
    longest: float | None = None,
) -> np.ndarray:
    """What the load cell reads of an experiment on one wheel: ``compress_wheel`` along z, else ``drag_wheel``."""
    if experiment.vertical:
        return compress_wheel(robot, head, step, effects=effects)
    return drag_wheel(robot, head, step, free_normal, effects, longest)


def compress_wheel(
    robot: Robot, head: np.ndarray, step: float, gap: float = 0.0, effects: Effects | None = None
) -> np.ndarray:
    """Vertical force on one wheel pressed down by ``head`` (4.15); it touches after ``gap`` [m].

    Returns
    -------
    (n,) float [N]
        Compression positive.
    """
    active = checked_for_robot(effects or {})
    force = np.empty(len(head))
    ratio = robot.stiffness[2] / robot.stiffness[1]
    depth = head - head[0] - gap
    _press(robot.stiffness[2], robot.damping[2], ratio, effect_vector(active), depth, step, force)
    return _read(force, step, active)


def pull_block(block: Block, head: np.ndarray, step: float, effects: Effects | None = None) -> np.ndarray:
    """Force in the cable of a block whose cable end follows the machine's head.

    A stiff cable (infinite stiffness) carries the kinetic friction as long as the head moves; a compliant one
    stretches until the static friction is overcome, and the block may then stick and slip.

    Returns
    -------
    (n,) float [N]
    """
    active = checked_for_robot(effects or {})
    weight = block.mass * GRAVITY
    stiffness = _cable(block.cable_stiffness, active)
    if math.isinf(stiffness):
        return _read(np.where(_on_the_way(head), block.mu_kinetic * weight, 0.0), step, active)
    static, kinetic = block.mu_static * weight, block.mu_kinetic * weight
    falling, exponent = 0.0, 2.0
    if "stribeck" in active:
        law = active["stribeck"]
        kinetic, falling, exponent = static * law["kinetic_share"], law["stribeck_velocity_m_s"], law["exponent"]
    force = pull(
        block.mass, stiffness, block.cable_damping, np.full(len(head), kinetic), static - kinetic, head - head[0], step,
        falling=falling, exponent=exponent,
    )[0]  # fmt: skip
    return _read(force, step, active)


def _on_the_way(head: np.ndarray) -> np.ndarray:
    """Between the head's first motion and its last; an encoder that stands still for a sample has not stopped.

    What lies within a thousandth of the way from either end is taken to be passed at the speed of the rest.
    """
    travel = head - head[0]
    total = travel[-1]
    if total == 0.0:
        return np.zeros(len(head), dtype=bool)
    first = int(np.argmax(travel > 1e-3 * total))
    last = len(head) - 1 - int(np.argmax(travel[::-1] < (1.0 - 1e-3) * total))
    index = np.arange(len(head))
    if last <= first:
        return index == first
    each = (travel[last] - travel[first]) / (last - first)
    begin, end = first - travel[first] / each, last + (total - travel[last]) / each
    return (index > begin + 1e-6) & (index < end - 1e-6)


def _cable(stiffness: float, active: Effects) -> float:
    for effect_id, values in active.items():
        change = CATALOGUE[effect_id].acts.get(Site.PULL)
        if change:
            stiffness = change(stiffness, **values)
    return stiffness


def _read(force: np.ndarray, step: float, active: Effects) -> np.ndarray:
    return sensed(np.arange(len(force)) * step, {"force": force}, active)["force"]


@kernel
def _drag(stiffness, damping, mass, printed, breakaway, grip, load, cable, e, head, step, substeps, out):
    deflection, velocity, sliding, hub_position = 0.0, 0.0, False, 0.0
    hidden, free = np.zeros(STATES), e[UNLISTED:]
    h = step / substeps
    series, falling = math.isfinite(cable), e[KINETIC_SHARE] != 1.0 and math.isfinite(grip)
    drag = grip * release_share(breakaway, grip, 0.0) if math.isfinite(grip) and not printed else 0.0
    coast, rate_before = math.exp(-damping * h / mass) if mass > 0.0 else 0.0, math.nan
    for n in range(out.shape[0]):
        rate = (head[n + 1] - head[n]) / step if n + 1 < out.shape[0] else 0.0
        for m in range(substeps):
            slip = rate - velocity
            beside = element_force(deflection, slip, hidden, stiffness, 1.0, 1.0, True, e)
            beside += _unlisted(deflection, slip, n * step + m * h, 1.0, free)
            hub = rate
            if series:  # the hub is light: cable and tire carry the same force, taken implicitly
                target = head[n] + rate * (m + 1) * h
                hub = (
                    cable * (target - hub_position) - stiffness * deflection - beside
                    + (stiffness * h + damping) * velocity
                ) / (cable * h + stiffness * h + damping)  # fmt: skip
            if falling:
                mu = _friction_law(
                    breakaway / load, e[KINETIC_SHARE], abs(velocity), e[STRIBECK_SPEED], e[STRIBECK_EXPONENT]
                )
                grip = load * mu
                drag = grip
            if printed:
                faster = 0.0 if math.isnan(rate_before) else (hub - rate_before) / h
                rate_before = hub
                sliding, velocity, force = printed_force(
                    deflection, sliding, velocity, (hub, faster), beside, stiffness, damping, mass, breakaway, grip,
                    drag, coast, h,
                )  # fmt: skip
            else:
                sliding, velocity, force = contact_force(
                    deflection, sliding, velocity, hub, beside, stiffness, damping, mass, breakaway, grip, drag, h
                )
            if m == 0:
                out[n] = -force
            deflection += h * (hub - velocity)
            hub_position += h * hub
            element_advance(hidden, hub - velocity, h, True, e)


@kernel
def _press(stiffness, damping, ratio, e, depth, step, out):
    hidden = np.zeros(STATES)
    for n in range(out.shape[0]):
        rate = (depth[min(n + 1, out.shape[0] - 1)] - depth[n]) / step
        out[n] = 0.0
        if depth[n] > 0.0:
            beside = element_force(depth[n], rate, hidden, stiffness, ratio, 0.0, False, e)
            # from the unloaded tire on; K_z of a robot that stands is its slope there, short of the knee or beyond
            beside += _beyond(depth[n], stiffness, e[KNEE_SHARE], e[KNEE])
            out[n] = max(0.0, stiffness * depth[n] + damping * rate + beside)
            element_advance(hidden, rate, step, False, e)
