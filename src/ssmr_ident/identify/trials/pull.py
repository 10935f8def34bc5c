"""Pulls and bench tests as trials: the slack before the cable tightens varies, and the load cell's zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments import Experiment
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.trials.machine import QUICK, force_model
from ssmr_ident.identify.trials.moments import lets_go, tightening
from ssmr_ident.identify.trials.teeth import find_teeth
from ssmr_ident.identify.trials.trial import Array, Asked, Course, Trial, Values
from ssmr_ident.physics.slots import Effects
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.signals.noise import AutoregressiveNoise, white_std

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

FALLS = 0.2
"""Share of a drag's range of forces that a wheel loses while the head goes on, from which it has let go: what holds
loses none."""

SMOOTH, COARSE = 2.0, 10.0
"""On the steps of differences. Where teeth come at other times after every step, as they do where friction falls when a
contact lets go, slopes want a wide one: a percent of a stiffness, and a thousandth of the travel."""

BLIND = ("accelerometer.",)
BLIND_TEETH = ("inertia_", "accelerometer.", "tire.damping_")
BLIND_WHEEL = ("inertia_", "accelerometer.", "contact_shift", "height", "tire.damping_")
"""What no recording depends on. A pull depends on the body's inertia and on the tires' damping as well: a robot that
slides swings on its tires, and one deviation of either changes what a load cell reads by 0.3 to 1.5 of its noise. Held
at the file's values they left up to 7 times the noise's variance of a robot that nothing was missing from. Of teeth,
which are compared by their sizes, no swing is left; tires without any damping make teeth of their own."""

SIDEWAYS = ("contact_shift_y_m", "inertia_kg_m2.xy", "inertia_kg_m2.yz")
"""What a pull lengthwise is first taken not to depend on. The wheels of a robot that is alike left and right to the
last bit let go at one moment, and a millionth of a metre makes another run of it: then no step away from what is known
beforehand is ever an improvement. Once other pulls have told how far from the middle its centre of mass lies, it
counts (``Trial.uneven``): 12 mm make a misfit of 28 times a load cell's noise where wheels let go."""

POINTS = 1000
"""Samples at which a slack is looked for."""


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
    as_it_is = _trial(measurement, parameters, ())
    robot = measurement.experiment.drags_everything and "tire.stiffness_y_N_m" in parameters
    if not robot or measurement.entry.direction != "longitudinal":
        return as_it_is
    return replace(_trial(measurement, parameters, SIDEWAYS), uneven=as_it_is)


def _trial(measurement: Measurement, parameters: ParameterSet, unseen: tuple[str, ...]) -> Trial:
    """A recording that does not depend on some parameters, whatever their values."""
    measured, travel, step, start = travelled(measurement)
    forces = force_model(measurement, parameters, holds(measured, travel), unseen)
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
        result: Array = share * (averages if teeth is None else teeth.ordered(averages))
        return result

    def simulated(asked: Sequence[Asked], inner: float | None = QUICK) -> Array:
        heads = [
            (values, effects, np.maximum(head - float(np.clip(nuisance[0], 0.0, 0.5)) * size, 0.0))
            for values, effects, nuisance in asked
        ]
        return forces(heads, step, inner)[:, :-1]

    def whole(values: Values, effects: Effects, nuisance: Array) -> Array:
        result: Array = simulated([(values, effects, nuisance)], None)[0][:, None]
        return result

    def many(asked: Sequence[Asked]) -> Array:
        return np.array([averaged(one) for one in simulated(asked)])

    def run(values: Values, effects: Effects, nuisance: Array) -> Array:
        result: Array = many([(values, effects, nuisance)])[0]
        return result

    def begin(values: Values, effects: Effects) -> Array:
        tight = simulated([(values, effects, np.zeros(1))])[0]
        found = find_slack(measured[rising], travel[rising], tight[rising]) / size
        if not measurement.entry.wheel_rate_rad_s:
            return np.array([found])
        # wheels that spin all the while have turned further when a slack ends: one simulation does not tell another's
        around = travel[[min(max(tight_at + k, 0), len(travel) - 1) for k in (-1, 0, 1)]] / size
        slacks = [np.array([s]) for s in (found, *around)]
        white = trial.whitened(trial.runs([(values, effects, own) for own in slacks]))
        misfits = np.sum((trial.white_target[:, None] - white) ** 2, axis=0)
        return slacks[int(np.argmin(np.where(np.isfinite(misfits), misfits, np.inf)))]

    # a block alone has nothing to swing on
    robot = RobotBuilder.of(parameters).facts if "tire.stiffness_y_N_m" in parameters else {}
    swings = measurement.experiment.drags_everything and bool(robot)
    noise = white_std(averaged(measured)[:, 0] / share[:, 0]) if teeth is None else teeth.noise
    target = averaged(measured)
    trial = Trial(
        measurement.name,
        measurement.experiment,
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
        {"travel_m": size, "teeth": 0.0 if teeth is None else float(teeth.count), **robot},
        (*_blind(measurement.experiment, teeth is not None), *unseen),
        SMOOTH if teeth is None and _steady(parameters) else COARSE,
        searched=True,
        quiet=teeth is not None,
        jolt=(tightened + JOLT[0], tightened + JOLT[1]),
        many=many,
        abreast=swings,
        slides_from=float(times[lets_go(target / share)]) if swings and teeth is None else None,
    )
    return trial


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


def _steady(parameters: ParameterSet) -> bool:
    """Whether what is known has contacts slide at the force at which they let go, or along both axes together."""
    static, kinetic = (parameters.number(f"tire.mu_{name}", np.nan) for name in ("static", "kinetic"))
    cone = parameters.choices.get("tire.contact", "cone") == "cone"
    return static == kinetic or (cone and parameters.number("tire.sliding_speed_m_s", 0.0) > 0.0)


def _blind(experiment: Experiment, toothed: bool) -> tuple[str, ...]:
    if experiment.of_one_wheel:
        return BLIND_WHEEL
    return BLIND_TEETH if toothed else BLIND


def holds(force: Array, travel: Array) -> bool:
    """Whether the contact holds as long as the head moves: at the end the force still rises with the travel.

    A single wheel is dragged under a load that no log tells, and may wedge; where it does not let go within the
    recording, the friction under a quarter of the weight is not what holds it.
    """
    inside = _moving(travel)
    if len(inside) < 4 * ENDS or falls(force, travel):
        return False
    gains = np.diff([float(force[part].mean()) for part in np.array_split(inside, ENDS)])
    return bool(gains[-1] > STILL_RISES * gains.max() > 0.0)


def falls(force: Array, travel: Array) -> bool:
    """Whether the force falls while the head goes on, as it does where a stick lets go."""
    inside = _moving(travel)
    if len(inside) < 4 * ENDS:
        return False
    width = max(1, len(inside) // 100)
    smooth = np.convolve(force[inside], np.full(width, 1.0 / width), "valid")
    return bool(np.max(np.maximum.accumulate(smooth) - smooth) > FALLS * np.ptp(smooth))


def _moving(travel: Array) -> Array:
    """Samples from the head's first motion to its last."""
    speed = np.abs(np.gradient(travel))
    moving = np.flatnonzero(speed > 0.2 * np.quantile(speed, 0.95))
    return np.arange(moving[0], moving[-1] + 1) if len(moving) else np.arange(0)


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
