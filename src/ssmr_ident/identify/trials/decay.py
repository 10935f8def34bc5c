"""A robot's free response as a trial: the state at the release is what differs from one release to the next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments import FREE_RESPONSE
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.body.free_decays import BodyDecay, body_decay
from ssmr_ident.identify.body.output_error import START_SCALES
from ssmr_ident.identify.body.response import body_response, sensor_gains
from ssmr_ident.identify.trials.pure_rotation import PureRotation, seen_axis
from ssmr_ident.identify.trials.trial import Array, Asked, Course, Trial, Values
from ssmr_ident.physics.linear import COORDINATES
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.slots import Effects
from ssmr_ident.signals.metrics import LOW_PASS_HZ
from ssmr_ident.signals.noise import rounding, white_noise
from ssmr_ident.simulate.body import AWAY, MOVING
from ssmr_ident.simulate.many import Release, simulate_many

AXES = ("ax", "ay", "az")
SWAY = ("sway_x", "sway_y")
SWAYING = (*SWAY, *(f"{name}_rate" for name in SWAY))
BRACE = ("brace_x", "brace_y")
OWN = {"loaded": ("dry_friction", "hysteresis", "viscoelastic_relaxation"), "unseen": ("sensor_bandwidth",)}
STATES = (*COORDINATES, *(f"{name}_rate" for name in COORDINATES), *SWAYING, *BRACE, *OWN)
SCALES = np.concatenate([START_SCALES, [0.02, 0.02, 1.0, 1.0], [0.01, 0.01], [1.0, 1.0]])
"""Standard deviations of the starting state, ten times what a push by hand gives. After the body's come a mast's, and
what the tires are strained against each other: a wheel that a push relieves slides a few millimetres. The last two are
how much of what a push leaves in friction, loops and relaxing branches is there when they are let go, and how much of
the first acceleration a slow sensor has not met by then."""

_OFFSETS = np.array([STATES.index(name) for name in AWAY])
_VELOCITIES = np.array([STATES.index(f"{name}_rate") for name in MOVING])

STEP = 5e-4
"""Of the simulator [s]: the leapfrog is then off by 3 in 100 000 at 8 Hz, and by 2 in 10 000 at 20 Hz."""

LOUD = 1.25
"""Rms of a quarter of a second over the quiet tail's, above which a decay counts as not over yet: samples in which
nothing moves tell nothing of the physics, and cost as much as the others."""

FINE_STEP = 2e-4
"""Of what is compared and drawn."""

ROUGH_STEP = 1e-3
"""Of parts of a recording, whose fits only lead to that of the whole."""

FEWEST = 24
"""Blocks that even the shortest part of a decay keeps."""

RUNAWAY = 1e30
"""m/s^2 per starting state, beyond which modes of a robot that falls over tell nothing of where a decay began."""

WANDER = 0.02
"""m/s^2 by which a zero may drift within a recording, evenly or in an arc (standard deviations): 2 mg, chosen as what
the benchmark's sensors do at most. What drifts further counts as motion; with no limit creep would not."""

SHORTEST_REST = 64
"""Blocks behind a decay that is over from which they show the noise alone."""

LONGEST_QUIET = 0.35
"""Share of a record's end from which the noise is taken."""


def decay_trial(measurement: Measurement, builder: RobotBuilder, decoupled: bool = False) -> Trial:
    """Prepare a free response.

    Parameters
    ----------
    measurement : Measurement
        With at least one of ax, ay, az.
    builder : RobotBuilder
        From values to a robot.
    decoupled : bool
        Pure rotations (5.3) in place of the six degrees of freedom, seen in the channel that (5.8) reads them from.

    Raises
    ------
    InputError
        No accelerations, or nothing that decays.
    """
    # a wheel that is nearly off the floor slides, and along one axis it holds nothing while it slides along the other
    builder = RobotBuilder.once(builder.nominal.sliding_together())
    recording, sensor = measurement.recording, builder.nominal.accelerometer
    wanted = (seen_axis(measurement),) if decoupled else AXES
    names = tuple(name for name in wanted if name in recording and np.ptp(recording[name]) > 0)
    if not names:
        found = ", ".join(recording.names)
        raise InputError(
            recording.provenance.file,
            f"needs {' or '.join(wanted)} that changes; found {found}",
            "Map the columns by channels:",
        )
    channels = [(AXES.index(name), recording[name]) for name in names]
    decay = body_decay(measurement.name, recording.time, channels, sensor.bandwidth_hz)
    whole = decay.nuisances()
    quiet = int((1.0 - LONGEST_QUIET) * len(decay.samples))
    rest = decay.samples - whole @ np.linalg.lstsq(whole[quiet:], decay.samples[quiet:], rcond=None)[0]
    # second differences hardly see a motion that goes on to the end; a fitted noise model would take it for noise
    noises = tuple(
        white_noise(rest[quiet:, c], rounding(column) / math.sqrt(decay.block))
        for c, (_, column) in enumerate(channels)
    )
    kept = _loud_until(rest, quiet, decay.step)
    model = PureRotation(names[0]) if decoupled else None
    since = np.linspace(-1.0, 1.0, len(rest))
    drift = WANDER * np.column_stack([since, since**2])
    after = rest[kept:] if len(rest) - kept >= SHORTEST_REST else rest[:0]
    shows = np.array([recording.channel(name).shows(sensor.range_m_s2) for name in names])
    facts = _Facts(measurement.name, measurement.entry.motion or "", names, shows, STEP, builder, model, whole, drift)
    return replace(_trial(replace(decay, noises=noises), kept, facts), at_rest=after)


@dataclass(frozen=True, eq=False)
class _Facts:
    """What a decay's trial is made of whatever its length."""

    name: str
    kind: str
    channels: tuple[str, ...]
    shows: Array
    step: float
    builder: RobotBuilder
    model: PureRotation | None
    basis: Array
    drift: Array


def _trial(whole: BodyDecay, kept: int, facts: _Facts) -> Trial:
    """The first ``kept`` blocks of a decay."""
    decay = replace(whole, samples=whole.samples[:kept])
    builder, model = facts.builder, facts.model
    skip, length = _window(decay)
    raw = decay.record.samples[skip:length].reshape(kept, decay.block, -1)
    counts = np.all((raw > facts.shows[:, 0]) & (raw < facts.shows[:, 1]), axis=1)

    def simulated(asked: Sequence[Asked], samples: int, step: float) -> tuple[Array, Array, Array]:
        """Releases that differ, which of them each is asked for, and by what its axes' gains differ."""
        states = np.array([nuisance for _, _, nuisance in asked]) * SCALES
        away, moving = states[:, _OFFSETS], states[:, _VELOCITIES]
        places: dict[tuple[int, int, int], int] = {}
        releases: list[Release] = []
        rows, gains = [], []
        for index, (values, effects, nuisance) in enumerate(asked):
            robot, gain = builder.read(values)
            place = places.setdefault((id(robot), id(effects), id(nuisance)), len(releases))
            if place == len(releases):
                releases.append(Release(robot, effects, away[index], moving[index]))
            rows.append(place)
            gains.append(gain)
        seconds = decay.record.step
        names = [AXES[axis] for axis in decay.axes]
        found = simulate_many(releases, samples * seconds, 1.0 / seconds, step, names)
        return found, np.array(rows), np.array(gains)[:, list(decay.axes)]

    def read(asked: Sequence[Asked], samples: int, step: float) -> Array:
        found, rows, gain = simulated(asked, samples, step)
        result: Array = found[rows] * gain[:, None, :]
        return result

    def rotated(values: Values, effects: Effects, nuisance: Array, samples: int, step: float) -> Array:
        assert model is not None
        others = {name: effect for name, effect in effects.items() if name != "translation_coupling"}
        if "translation_coupling" in effects:
            coupled: Array = read([(values, others, nuisance)], samples, step)[0]
            return coupled
        pure: Array = model.responses(builder(values), samples, decay.record.step) @ nuisance[:12]
        if not others:
            return pure
        # what an effect adds to the six degrees of freedom, added to the pure rotation
        more, plain = read([(values, e, nuisance) for e in (others, {})], samples, step)
        result: Array = pure + more - plain
        return result

    def followed(asked: Sequence[Asked], samples: int, step: float) -> Array:
        if model is None:
            return read(asked, samples, step)
        return np.stack([rotated(*one, samples, step) for one in asked])

    def many(asked: Sequence[Asked]) -> Array:
        if model is None:
            return decay.averaged(*simulated(asked, length, facts.step))
        return decay.averaged(followed(asked, length, facts.step))

    def run(values: Values, effects: Effects, nuisance: Array) -> Array:
        result: Array = many([(values, effects, nuisance)])[0]
        return result

    everything = decay.record.samples

    def settled(values: Values, effects: Effects, nuisance: Array) -> Array:
        # until the sensor's own transient is over, nobody knows what it was doing before the release
        return followed([(values, effects, nuisance)], len(everything), FINE_STEP)[0, skip:]

    def begin(values: Values, effects: Effects) -> Array:
        robot = builder(values)
        if model is None or "translation_coupling" in effects:
            return _linear_start(trial, _columns(robot, decay))
        responses = model.responses(robot, length, decay.record.step)[:, 0]
        return _linear_start(trial, decay.averaged(responses[None])[0][:, None, :])

    trial = Trial(
        facts.name,
        FREE_RESPONSE,
        facts.kind,
        facts.channels,
        decay.record.start_s + decay.first + decay.step * np.arange(kept),
        decay.samples,
        decay.noises,
        facts.basis[:kept],
        run,
        begin,
        STATES,
        SCALES,
        Course(
            decay.record.start_s + decay.record.times[skip:],
            everything[skip:],
            settled,
            ("m/s^2",) * len(facts.channels),
            LOW_PASS_HZ,
        ),
        None if counts.all() else counts,
        {"clipped": float((~counts).sum()), **builder.facts},
        ("cable.",),
        quiet=True,
        many=many,
        abreast=model is None,
        idle={**dict.fromkeys(SWAYING, ("flexible_mast",)), **dict.fromkeys(BRACE, ("wheel_lift",)), **OWN},
        even=BRACE,
        lined=bool(whole.record.lines),
        drift=facts.drift[:kept],
        shorten=lambda seconds: _trial(
            whole, min(kept, max(FEWEST, round(seconds / whole.step))), replace(facts, step=ROUGH_STEP)
        ),
        delay=lambda seconds: _later(whole, kept, facts, round(seconds / whole.step)),
    )
    return trial


def _later(whole: BodyDecay, kept: int, facts: _Facts, blocks: int) -> Trial:
    """The same decay from so many blocks after its release on, or from where the fewest are left."""
    blocks = max(0, min(blocks, kept - FEWEST))
    record, cut = whole.record, blocks * whole.block
    record = replace(record, samples=record.samples[cut:], start_s=record.start_s + cut * record.step)
    rest = replace(whole, samples=whole.samples[blocks:], record=record)
    own = replace(facts, basis=facts.basis[blocks:], drift=facts.drift[blocks:], step=ROUGH_STEP)
    return _trial(rest, kept - blocks, own)


def _window(decay: BodyDecay) -> tuple[int, int]:
    """First and last sample of the record that the blocks are made of."""
    skip = round((decay.first - (decay.block - 1) / 2 * decay.record.step) / decay.record.step)
    return skip, skip + len(decay.samples) * decay.block


def _loud_until(rest: Array, quiet: int, step: float) -> int:
    """Blocks until the motion is over in all channels."""
    width = max(4, round(0.25 / step))
    count = len(rest)
    size = np.std(rest[quiet:], axis=0) + 1e-300
    rms = np.array([np.sqrt(np.mean(rest[i : i + width] ** 2, axis=0)) for i in range(0, count - width, width)])
    loud = np.flatnonzero((rms > LOUD * size).any(axis=1))
    last = (int(loud[-1]) + 2) * width if len(loud) else count
    return max(min(count, last), min(count, round(0.5 / step)))


def _columns(robot: Robot, decay: BodyDecay) -> Array:
    """Small motions on the block grid over the scaled starting state, (n, c, 12)."""
    response = body_response(robot)
    times = decay.first + decay.step * np.arange(len(decay.samples))
    bandwidth = robot.accelerometer.bandwidth_hz
    gains = sensor_gains(response.poles, bandwidth, decay.record.step) * decay.averaging(response.poles)
    with np.errstate(over="ignore", invalid="ignore"):  # a robot that falls over has no start
        waves = response.waves(times)
        weights = response.weights(np.broadcast_to(gains, (len(decay.axes), len(gains))), decay.axes)
        seen = np.stack([waves @ weight for weight in weights], axis=1) * START_SCALES
    result: Array = seen * robot.accelerometer.gain[list(decay.axes), None]
    return result


def _linear_start(trial: Trial, columns: Array) -> Array:
    if not np.all(np.abs(columns) < RUNAWAY):
        return np.zeros(len(SCALES))
    design = trial.whitened(columns)
    gram = design.T @ design + np.eye(design.shape[1])
    start = np.linalg.solve(gram, design.T @ trial.white_target)
    return np.concatenate([start, np.zeros(len(SCALES) - len(start))])
