"""Pulls and bench tests as trials: the slack before the cable tightens varies, and the load cell's zero."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from ssmr_ident.campaign import Measurement
from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.decay_record import spread
from ssmr_ident.identify.noise import AutoregressiveNoise
from ssmr_ident.identify.robot_map import RobotBuilder
from ssmr_ident.identify.trials.moments import lets_go, tightening
from ssmr_ident.identify.trials.teeth import find_teeth
from ssmr_ident.identify.trials.trial import Array, Asked, Course, Trial, Values
from ssmr_ident.physics.rig import Block, block_from_parameters
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.slots import Effects
from ssmr_ident.session import Entry
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.simulate.bench import compress_wheel, drag_wheel, pull_block
from ssmr_ident.simulate.many import simulate_pulls
from ssmr_ident.simulate.scenarios import Scenario, cable_properties, fixture_needed
from ssmr_ident.simulate.simulation import simulate

STARTING = 3
"""Samples at the start that do not count: how the head takes up speed is not in the log."""

JOLT, SHARE = (-0.15, 0.35), 0.1
"""Seconds about the tightening of the cable, and the share by which they count. Its damper takes up the head's speed
with a jolt of some 20 N for each mm/s, which the body swings out within two periods: larger than all else that is left,
it would hold the fit by the moment at which the slack ends. But a log that begins without slack has the cell's zero
nowhere else."""

LONGEST_BLOCK, FEWEST_BLOCKS = 0.25, 150.0
"""Seconds that are averaged into one number at the most, and numbers that a recording keeps at the least: a pull is
slow, and the chatter of sliding contacts repeats in no second run."""

ENDS, STILL_RISES = 6, 0.3
"""Parts of a drag, and the gain of mean force into its last part over the largest from part to part, from which the
contact holds: a sliding one keeps its force, and a carcass that creeps or softens loses half of its slope at most."""

SMOOTH, COARSE = 2.0, 10.0
"""On the steps of differences. Where teeth come at other times after every step, or a relay chatters, slopes want a
wide one: a percent of a stiffness, and a thousandth of the travel."""

BLIND = {
    "pull": ("inertia_", "accelerometer.", "tire.damping_"),
    "wheel": ("inertia_", "accelerometer.", "contact_shift", "height", "tire.damping_"),
}

SIDEWAYS = ("contact_shift_y_m", "inertia_kg_m2.xy", "inertia_kg_m2.yz")
"""What a pull lengthwise is first taken not to depend on. The wheels of a robot that is alike left and right to the
last bit let go at one moment, and a millionth of a metre makes another run of it: then no step away from what is known
beforehand is ever an improvement. Once other pulls have told how far from the middle its centre of mass lies, it
counts (``Trial.uneven``): 12 mm make a misfit of 28 times a load cell's noise where wheels let go."""

POINTS = 1000
"""Samples at which a slack is looked for."""

Head = tuple[Values, Effects, Array]
Forces = Callable[[Sequence[Head], float, float | None], Array]
"""``forces(asked, step, inner)``: what the load cell reads for each (values, effects, head), (k, n) [N], NaN where that
cannot be simulated; ``inner`` is the longest step of the integration, None for the simulator's own choice."""

QUICK = 2e-3
"""Integration step of fits [s]: averages of a pull without teeth then differ by 0.01 to 0.12 N rms from those at the
simulator's own choice (the body's swing after the start), of a dragged wheel by less than 0.1 N; a load cell's noise is
some 0.5 N."""


FIXTURE_STEP = 2e-4
"""The same where a stiff fixture holds the robot while its wheels spin: its own vibration would burst beyond 4e-4 s."""


def pull_trial(measurement: Measurement, parameters: ParameterSet) -> Trial:
    """Prepare a pull of the robot or a block, a drag of one wheel, or a compression.

    A pull lengthwise is one of a robot that is alike left and right; what it is of one that is not goes with it.

    Parameters
    ----------
    measurement : Measurement
        With a force, and a position or a constant speed.
    parameters : ParameterSet

    Raises
    ------
    InputError
        Neither a position nor a speed.
    """
    as_it_is, entry = _trial(measurement, parameters, ()), measurement.entry
    robot = entry.experiment == "pull" and "tire.stiffness_y_N_m" in parameters
    if not robot or entry.direction != "longitudinal":
        return as_it_is
    return replace(_trial(measurement, parameters, SIDEWAYS), uneven=as_it_is)


def _trial(measurement: Measurement, parameters: ParameterSet, unseen: tuple[str, ...]) -> Trial:
    """A recording that does not depend on some parameters, whatever their values."""
    measured, travel, step, start = travelled(measurement)
    forces = force_model(measurement.entry, parameters, holds(measured, travel), unseen)
    elapsed = step * np.arange(len(travel))
    speed = float(np.polyfit(elapsed, travel, 1)[0])
    size = float(travel.max())
    # the head goes on after the last sample: a simulation that stops it there would show the jolt
    head = np.append(travel, travel[-1] + step * speed * (travel[-1] > travel[-2]))
    block = max(1, int(min(LONGEST_BLOCK, elapsed[-1] / FEWEST_BLOCKS) / step))
    count = len(measured) // block
    counts = np.ones((count, 1), dtype=bool)
    counts[: -(-STARTING // block)] = False

    teeth = find_teeth(measured, travel, block)
    rising = slice(None) if teeth is None else slice(teeth.rise)
    tight_at = tightening(measured, block)
    tightened = start + step * tight_at
    times = start + step * (block * np.arange(count) + 0.5 * (block - 1))
    since = times - tightened
    share = np.where((since > JOLT[0]) & (since < JOLT[1]), SHARE, 1.0)[:, None]

    def averaged(signal: Array) -> Array:
        averages = signal[: count * block].reshape(count, block).mean(axis=1)[:, None]
        return share * (averages if teeth is None else teeth.ordered(averages))

    def simulated(asked: Sequence[Asked], inner: float | None = QUICK) -> Array:
        heads = [
            (values, effects, np.maximum(head - float(np.clip(nuisance[0], 0.0, 0.5)) * size, 0.0))
            for values, effects, nuisance in asked
        ]
        return forces(heads, step, inner)[:, :-1]

    def whole(values: Values, effects: Effects, nuisance: Array) -> Array:
        return simulated([(values, effects, nuisance)], None)[0][:, None]

    def many(asked: Sequence[Asked]) -> Array:
        return np.array([averaged(one) for one in simulated(asked)])

    def run(values: Values, effects: Effects, nuisance: Array) -> Array:
        return many([(values, effects, nuisance)])[0]

    def begin(values: Values, effects: Effects) -> Array:
        tight = simulated([(values, effects, np.zeros(1))])[0]
        found = find_slack(measured[rising], travel[rising], tight[rising]) / size
        if not measurement.entry.wheel_rate_rad_s:
            return np.array([found])
        # wheels that spin all the while have turned further when a slack ends: one simulation does not tell another's
        around = travel[[min(max(tight_at + k, 0), len(travel) - 1) for k in (-1, 0, 1)]] / size
        return min((np.array([s]) for s in (found, *around)), key=lambda own: _misfit(trial, values, effects, own))

    # a block alone has nothing to swing on
    swings = measurement.entry.experiment == "pull" and "tire.stiffness_y_N_m" in parameters
    noise = spread(averaged(measured)[:, 0] / share[:, 0]) if teeth is None else teeth.noise
    target = averaged(measured)
    trial = Trial(
        measurement.name,
        measurement.entry.experiment,
        measurement.entry.direction or "",
        ("force",),
        times,
        target,
        (AutoregressiveNoise(np.ones(1), noise),),
        share if teeth is None else share * teeth.weight[:, None],
        run,
        begin,
        ("slack_m",),
        np.array([size]),
        Course(start + elapsed, measured[:, None], whole, ("N",), None),
        counts,
        {"travel_m": size, "teeth": 0.0 if teeth is None else float(teeth.count)},
        (*BLIND["pull" if measurement.entry.experiment == "pull" else "wheel"], *unseen),
        SMOOTH if teeth is None and parameters.number("tire.sliding_speed_m_s", 0.0) > 0.0 else COARSE,
        searched=True,
        quiet=teeth is not None,
        jolt=(tightened + JOLT[0], tightened + JOLT[1]),
        many=many,
        abreast=swings,
        slides_from=float(times[lets_go(target / share)]) if swings and teeth is None else None,
    )
    return trial


def _misfit(trial: Trial, values: Values, effects: Effects, own: Array) -> float:
    left = trial.white_target - trial.whitened(trial.run(values, effects, own))
    misfit = float(left @ left)
    return misfit if np.isfinite(misfit) else np.inf


def travelled(measurement: Measurement) -> tuple[Array, Array, float, float]:
    """Force [N], travel of the head from its start [m], step and start of the grid [s]."""
    recording, entry = measurement.recording, measurement.entry
    if "position" in recording:
        even = even_samples(recording.time, np.column_stack([recording["force"], recording["position"]]))
        travel = even.samples[:, 1] - even.samples[0, 1]
        if abs(travel.min()) > abs(travel.max()):
            travel = -travel
    elif entry.speed_mm_s:
        even = even_samples(recording.time, recording["force"][:, None])
        travel = entry.speed_mm_s * 1e-3 * (even.time - even.time[0])
    else:
        raise InputError(recording.provenance.file, "has no position, and session.yaml no speed_mm_s", "Give one")
    return even.samples[:, 0], travel, 1.0 / even.sample_rate, even.start


def holds(force: Array, travel: Array) -> bool:
    """Whether the contact holds as long as the head moves: at the end the force still rises with the travel.

    A single wheel is dragged under a load that no log tells, and may wedge; where it does not let go within the
    recording, the friction under a quarter of the weight is not what holds it.
    """
    moving = np.flatnonzero(np.abs(np.gradient(travel)) > 0.2 * np.quantile(np.abs(np.gradient(travel)), 0.95))
    inside = np.arange(moving[0], moving[-1] + 1) if len(moving) else np.arange(0)
    if len(inside) < 4 * ENDS:
        return False
    gains = np.diff([float(force[part].mean()) for part in np.array_split(inside, ENDS)])
    return bool(gains[-1] > STILL_RISES * gains.max() > 0.0)


def force_model(entry: Entry, parameters: ParameterSet, held: bool = False, unseen: tuple[str, ...] = ()) -> Forces:
    """The simulator of an entry's experiment; ``held`` says that a dragged wheel does not let go, and ``unseen`` which
    parameters a pull stays as the file has them in."""
    if "tire.stiffness_y_N_m" not in parameters:
        block = block_from_parameters(parameters)
        return _each(lambda values, effects, head, step, inner: pull_block(_block(block, values), head, step, effects))
    builder = RobotBuilder.of(parameters)
    if entry.experiment == "vertical_compression":
        return _each(
            lambda values, effects, head, step, inner: compress_wheel(builder(values), head, step, effects=effects)
        )
    if entry.experiment == "wheel_drag":
        free = entry.free_normal and not held
        return _each(
            lambda values, effects, head, step, inner: drag_wheel(builder(values), head, step, free, effects, inner)
        )

    def pulled(asked: Sequence[Head], step: float, inner: float | None) -> Array:
        pulls = []
        for values, effects, head in asked:
            seen = {name: value for name, value in values.items() if name not in unseen}
            pulls.append((builder(seen), effects, _scenario(entry, head, step)))
        if inner is None:  # each has a step of its own
            return np.array([_by_its_own_step(*one, step) for one in pulls])
        longest = min(inner, FIXTURE_STEP) if pulls[0][2].held else inner
        return simulate_pulls(pulls, 1.0 / step, longest, ("force",))[:, :, 0]

    return pulled


def _by_its_own_step(robot: Robot, effects: Effects, scenario: Scenario, step: float) -> Array:
    try:
        return simulate(robot, scenario, 1.0 / step, effects=effects)["force"]
    except SimulationError:
        return np.full(len(scenario.head), np.nan)


def _each(force: Callable[[Values, Effects, Array, float, float | None], Array]) -> Forces:
    """Experiments that are quick, one after the other."""

    def forces(asked: Sequence[Head], step: float, inner: float | None) -> Array:
        found = []
        for values, effects, head in asked:
            try:
                found.append(force(values, effects, head, step, inner))
            except SimulationError:
                found.append(np.full(len(head), np.nan))
        return np.array(found)

    return forces


def _scenario(entry: Entry, head: Array, step: float) -> Scenario:
    stiffness, damping = cable_properties(entry.cable)
    rate = entry.wheel_rate_rad_s or 0.0
    return Scenario(
        "pull",
        len(head) * step,
        head=head,
        head_step=step,
        direction=entry.direction or "lateral",
        height=0.05 if entry.height_m is None else entry.height_m,
        wheels_gripping=entry.wheels_gripping,
        cable_stiffness=stiffness,
        cable_damping=damping,
        wheel_rates=np.full((1, 2), rate),
        held=fixture_needed(entry.wheels_gripping, rate),
    )


def _block(nominal: Block, values: Values) -> Block:
    mu_static = values.get("mu_static", nominal.mu_static)
    return Block(
        values.get("mass_kg", nominal.mass),
        mu_static,
        values.get("mu_kinetic", mu_static if nominal.mu_kinetic == nominal.mu_static else nominal.mu_kinetic),
        values.get("cable.stiffness_N_m", nominal.cable_stiffness),
    )


def find_slack(force: Array, travel: Array, tight: Array) -> float:
    """Travel of the head before the cable tightens [m], by least squares with the load cell's zero eliminated.

    Up to a third of the travel; a log that starts under load is told apart by the zero. What a slack does is taken
    from one simulation without: the same force over the travel that is left, which is exact at constant speed; where
    the head stands still, the force goes on by itself and does not count.

    Parameters
    ----------
    force : (n,) float [N]
    travel : (n,) float [m]
    tight : (n,) float [N]
        Simulated without slack.
    """
    last = int(np.argmax(travel > (1.0 - 1e-3) * travel.max()))
    every = max(1, last // POINTS)
    force, travel, tight = (a[: last + 1 : every] for a in (force, travel, tight))
    rising = np.maximum.accumulate(travel) + 1e-9 * travel.max() * np.linspace(0.0, 1.0, len(travel))

    def misfits(slacks: Array) -> Array:
        rest = force - np.interp(rising - slacks[:, None], rising, tight, left=0.0)
        costs = np.sum((rest - rest.mean(axis=1, keepdims=True)) ** 2, axis=1)
        return np.where(np.isfinite(costs), costs, np.inf)

    def misfit(slack: float) -> float:
        return float(misfits(np.array([slack]))[0])

    grid = np.linspace(0.0, travel.max() / 3.0, 400)
    costs = misfits(grid)
    best = int(np.argmin(costs))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    refined = minimize_scalar(misfit, bounds=(low, high), method="bounded", options={"maxiter": 12})
    return float(refined.x) if refined.fun < costs[best] else float(grid[best])
