"""A rig's recordings as pieces to be fitted: from a release, or the begin of a log, to the next one."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording
from ssmr_ident.estimate.foot import foot_motion
from ssmr_ident.estimate.motor import Given, course_of, given_of
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.quantities import UNITS
from ssmr_ident.session.entry import FURTHER
from ssmr_ident.signals.band import BESIDE, Band, inside, lines_in, quiet_std, series
from ssmr_ident.signals.grid import band_limited, even_samples
from ssmr_ident.signals.noise import median_std, rounding, third_difference_std

Array = np.ndarray

ORDER = {"position": 0, "angle": 0, "velocity": 1, "angular_rate": 1, "acceleration": 2}
"""Time derivatives of the deflection that a channel shows."""

FORCES, FEET = ("force", "torque"), ("base_position", "base_acceleration")
"""What drives; a position can be differentiated, an acceleration drifts."""

FINEST = 60
"""Samples a period that are kept; faster logs are averaged over blocks, by which a sine of 60 samples loses 0.05 %."""

STEPS = 60
"""Least integration steps a period: forces that jump and such that remember err by their square."""

STRAIGHT, FINER = 0.5, 4
"""Radians of a drive's fastest part in a step: what ``line_corners`` leaves is their fourth power over 90; and at most
so many steps a sample, for a blow goes up to half the rate."""

GEARED = 150
"""Least integration steps a period under a motor, whose gears stick and let go."""

FASTEST = 1e-3
"""Share of a drive's variance that may lie above its fastest part."""

RAISED = 3.0
"""Largest factor by which a known low-pass is undone: beyond it the log holds noise."""

AROUND, WILD = 25, 8.0
"""Samples on each side, and how many times what they leave a single one is off, to be taken for wild."""

QUIET = 0.1
"""Share of the loudest stretch below which a stretch is at rest."""


class Seen(NamedTuple):
    """What drives a recording, and what it shows.

    Parameters
    ----------
    orders, bodies : tuple of int
        Of each channel, the derivative of which body's coordinate it is.
    based : bool
        Whether the drive is the acceleration of the base, to which the coordinates are relative.
    into : int
        Body on which a force acts.
    """

    orders: tuple[int, ...]
    bodies: tuple[int, ...]
    based: bool
    into: int


@dataclass(frozen=True, eq=False)
class Piece:
    """A stretch of a recording that has one start.

    Parameters
    ----------
    name : str
        Of the recording.
    recording : int
        Number among those of the problem.
    channels : tuple of str
    orders : (c,) int
        Time derivatives of the deflection.
    time : (n,) float [s]
        The recording's own.
    y : (n, c) float [SI]
    counts : (n, c) bool
        False for single samples far off their neighbours.
    drive : (n·every + 1,) float [N], or [m/s^2] of the base
    based : bool
        Whether its foot drives it; ``y`` of a position or velocity is then relative to the foot.
    driven : bool
    step : float [s]
        Of the integration.
    every : int
        Steps a sample.
    white : (c,) float
        Standard deviation of white noise: by differences of the log, until that of what a fit leaves is known.
    begin : float [s]
        Time at which the recording, or the release, began that this is a part of.
    foot : (n, c) float
        What was taken off ``y`` for its being relative.
    bodies : tuple of int
        Of a network, on which each channel is measured; empty where there is one alone.
    into : int
        Body on which the drive acts.
    band : (float, float) or None [Hz]
        In which alone it counts.
    motor : Given or None
        What a motor is given, whose torque acts beside the drive.
    late : float [s]
        How much later a force acts that is held from one value of the log to the next.
    """

    name: str
    recording: int
    channels: tuple[str, ...]
    orders: Array
    time: Array
    y: Array
    counts: Array
    drive: Array
    based: bool
    driven: bool
    step: float
    every: int
    white: Array
    begin: float = 0.0
    foot: Array = field(default_factory=lambda: np.zeros(1))
    bodies: tuple[int, ...] = ()
    into: int = 0
    band: Band | None = None
    motor: Given | None = None
    late: float = 0.0

    def counted(self, columns: Array, skipped: int = 0) -> Array:
        """What counts of samples as long as ``y``, (n, c, …) to (m, c, …): all but single wild ones and those skipped
        at the begin; where there is a band, as a series of what lies in it."""
        wild = self.counts.reshape(*self.counts.shape, *[1] * (columns.ndim - 2))
        columns = columns if self.counts.all() else np.where(wild, columns, 0.0)
        return columns if self.band is None else series(columns, self.rate, self.band, skipped)

    @cached_property
    def sizes(self) -> Array:
        """(1 + c,) float: standard deviation of the drive, and how far each channel may be off zero."""
        return np.append(np.std(self.drive), 3.0 * self.y.std(axis=0) + np.abs(self.y.mean(axis=0)))

    def samples(self, skipped: int = 0) -> int:
        """How many numbers count, of all channels together."""
        if self.band is None:
            return int(self.counts[skipped:].sum())
        return self.y.shape[1] * lines_in(len(self.y), self.rate, self.band)

    @property
    def counted_rate(self) -> float:
        """Samples a second of what counts [Hz]."""
        return self.rate if self.band is None else 2.0 * (min(self.band[1], 0.5 * self.rate) - self.band[0])

    @property
    def counted_from(self) -> float:
        """Frequency [Hz] that is 0 in what counts."""
        return 0.0 if self.band is None else self.band[0]

    @property
    def seen(self) -> Seen:
        bodies = self.bodies or (0,) * len(self.orders)
        return Seen(tuple(self.orders.tolist()), bodies, self.based, self.into)

    @property
    def rate(self) -> float:
        return 1.0 / (self.step * self.every)

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(UNITS[name] for name in self.channels)


def cut(piece: Piece, first: int, after: int) -> Piece:
    """Samples ``first`` to before ``after`` of a piece, with a start of their own."""
    steps = first * piece.every, after * piece.every + 1
    drive = piece.drive[slice(*steps)] if piece.driven else piece.drive
    return replace(
        piece, time=piece.time[first:after], y=piece.y[first:after], counts=piece.counts[first:after], drive=drive,
        motor=piece.motor.part(*steps) if piece.motor else None,
        foot=piece.foot[first:after] if len(piece.foot) > 1 else piece.foot,
    )  # fmt: skip


def pieces_of(
    measurement: Measurement,
    index: int,
    frequency: float,
    bandwidth_hz: float,
    bodies: Sequence[str] = (),
    motor: bool = False,
) -> tuple[Piece, ...]:
    """Prepare a recording.

    Parameters
    ----------
    measurement : Measurement
    index : int
        Its number.
    frequency : float [Hz]
        Highest at which the rig is expected to move on its own.
    bandwidth_hz : float [Hz]
        Of the accelerometer, as known; ``inf`` where nothing has to be undone.
    bodies : sequence of str
        Of a network; none of a rig, which moves as one, and of whose sensors those of a second place are left out.
    motor : bool
        Whether a motor may drive the rig.

    Raises
    ------
    InputError
        No motion, or one that does not change.
    """
    recording = measurement.recording
    if bodies:
        channels, drive_name, places, into = placed_channels(measurement, bodies)
    else:
        (channels, drive_name), places, into = channels_of(recording), (), 0
    course = course_of(measurement) if motor else None
    wanted = [*channels, *([drive_name] if drive_name else [])]
    even = even_samples(recording.time, np.column_stack([recording[name] for name in wanted]))
    y, rate = even.samples[:, : len(channels)], even.sample_rate
    drive = even.samples[:, -1] if drive_name else np.zeros(len(y))
    orders = np.array([order_of(name) for name in channels])
    foot = np.zeros_like(y)
    if drive_name in FEET:
        moved = foot_motion(drive, drive_name, {n: order_of(n) for n in channels}, rate, recording.provenance.file)
        drive, foot = moved[:, 2], np.where(orders < 2, moved[:, orders], 0.0)
        y = y - foot
    band = _within(measurement, rate)
    found = []
    rounded = np.array([rounding(column) for column in y.T])  # by all of it: a part that stands still holds one value
    driven = bool(drive_name) or course is not None
    for first, after in stretches(y, rate, frequency) if not driven else [(0, len(y))]:
        part, force, block = y[first:after], drive[first:after], blocks_of(rate, FINEST * frequency, band)
        judged = [_single(column) for column in part.T]
        counts = ~np.column_stack([wild for wild, _ in judged])
        part = np.where(counts, part, np.column_stack([smooth for _, smooth in judged]))
        if math.isfinite(bandwidth_hz):
            slow = np.flatnonzero(orders == 2).tolist()
            part[:, slow] = before_low_pass(part[:, slow], rate, bandwidth_hz)
        if band is not None:
            part = inside(part, rate, band)
        averaged, kept = (_blocks(x, block) for x in (part, counts))
        every = max(1, math.ceil(STEPS * frequency * block / rate))
        if drive_name:
            every = max(
                every, min(FINER, math.ceil(2.0 * math.pi * fastest_part(force, rate) * block / rate / STRAIGHT))
            )
        given = None
        if course is not None:
            every = max(every, math.ceil(GEARED * frequency * block / rate))
            at = 0.5 * (block - 1) + np.arange(len(averaged) * every + 1) * (block / every)
            given = given_of(course, at)
        fine = _between(force, block, every, len(averaged)) if driven else np.zeros(2)
        white = np.maximum(white_of(averaged, rate / block, band), rounded / math.sqrt(block))
        middle = even.start + (first + np.arange(len(averaged)) * block + 0.5 * (block - 1)) / rate
        found.append(
            Piece(
                measurement.name,
                index,
                channels,
                orders,
                middle,
                averaged,
                kept > 0.5,
                fine,
                drive_name in FEET,
                driven,
                block / (rate * every),
                every,
                white,
                float(middle[0]),
                _blocks(foot[first:after], block),
                places,
                into,
                band,
                given,
                0.5 / rate if drive_name and drive_name not in FEET else 0.0,
            )
        )
    return tuple(found)


def _within(measurement: Measurement, rate: float) -> Band | None:
    """A recording's band.

    Raises
    ------
    InputError
        One that its rate cannot hold anything of.
    """
    band = measurement.entry.band_hz
    if band is not None and band[0] >= 0.5 * rate:
        raise InputError(
            f"{measurement.name}: band_hz",
            f"begins at {band[0]:g} Hz, and {rate:g} samples a second hold what is below {0.5 * rate:g} Hz",
            "Give a lower band, or take the key away",
        )
    return band


def blocks_of(rate: float, wanted: float, band: Band | None) -> int:
    """Samples that are averaged into one, for a wanted rate [Hz] at the least, and what a band needs."""
    least = wanted if band is None else max(wanted, 2.0 * (1.0 + BESIDE) * band[1])
    return max(1, int(rate / least))


def white_of(samples: Array, rate: float, band: Band | None) -> Array:
    """Standard deviation of white noise of each channel, (n, c) to (c,): by differences, or by what a band holds."""
    if band is None:
        return np.array([third_difference_std(column) for column in samples.T])
    return quiet_std(samples, rate, band)


def fastest_part(force: Array, rate: float) -> float:
    """Frequency above which next to nothing of a force is [Hz]; (n,) float, rate [Hz]."""
    power = np.abs(np.fft.rfft(force - force.mean())) ** 2
    above = np.cumsum(power[::-1])[::-1]
    return float(np.count_nonzero(above > FASTEST * above[0]) * rate / len(force))


def _blocks(samples: Array, block: int) -> Array:
    """Means of so many samples each, (n, c) to (n // block, c)."""
    count = len(samples) // block
    return samples[: count * block].reshape(count, block, -1).mean(axis=1)


def _between(force: Array, block: int, every: int, count: int) -> Array:
    """(count·every + 1,) float: a force averaged over blocks as the motion is, on the finer grid of integration."""
    if block == 1 and every > 1:
        fine = band_limited(force, every)
        return np.append(fine, np.full(count * every + 1 - len(fine), fine[-1]))
    means = np.convolve(force, np.full(block, 1.0 / block), "valid")  # at a block's middle, by where it begins
    return np.interp(np.arange(count * every + 1) * (block / every), np.arange(len(means)), means)


def before_low_pass(samples: Array, rate: float, bandwidth_hz: float) -> Array:
    """What went into a second-order Butterworth low-pass, (n, c) to (n, c); raised by ``RAISED`` at most."""
    around = min(len(samples) - 1, math.ceil(20.0 * rate / bandwidth_hz))
    padded = np.pad(samples, ((around, around), (0, 0)), mode="edge")
    over = np.fft.rfftfreq(len(padded), 1.0 / rate)[:, None] / bandwidth_hz
    raised = 1.0 + 1j * math.sqrt(2.0) * over - over**2
    raised *= np.minimum(RAISED / np.abs(raised), 1.0)
    return np.fft.irfft(raised * np.fft.rfft(padded, axis=0), len(padded), axis=0)[around : around + len(samples)]


def order_of(channel: str) -> int:
    """Time derivative of a coordinate that a channel shows, whichever sensor of its kind it is.

    >>> order_of("velocity"), order_of("acceleration_2")
    (1, 2)
    """
    return ORDER[re.sub("_[0-9]$", "", channel)]


def placed_channels(
    measurement: Measurement, bodies: Sequence[str]
) -> tuple[tuple[str, ...], str, tuple[int, ...], int]:
    """Motions that change, what drives (empty for nothing), and the numbers of the bodies of both.

    Of several bodies those channels count that name theirs; of a single one all do.

    Raises
    ------
    InputError
        No such motion, or a force that acts nobody knows where.
    """
    recording, said = measurement.recording, measurement.entry.bodies
    number = {name: k for k, name in enumerate(bodies)}
    known = {name: said.get(name, bodies[0]) for name in recording.names if name in said or len(bodies) == 1}
    motions = tuple(n for n in (*ORDER, *FURTHER) if n in known and np.ptp(recording[n]) > 0)
    where = recording.provenance.file or measurement.name
    drive = next((name for name in (*FORCES, *FEET) if name in recording), "")
    example = "{column: HEADER, body: " + bodies[0] + "}"
    if not motions:
        found = ", ".join(recording.names)
        raise InputError(where, f"needs the motion of a body; found {found}", f"channels: {{acceleration: {example}}}")
    if drive in FORCES and drive not in known:
        raise InputError(f"{where}: {drive}", "acts on nobody knows which body", f"channels: {{{drive}: {example}}}")
    return motions, drive, tuple(number[known[name]] for name in motions), number[known.get(drive, bodies[0])]


def channels_of(recording: Recording) -> tuple[tuple[str, ...], str]:
    """Motions that change, and the name of what drives (empty for none).

    Raises
    ------
    InputError
        None does.
    """
    motions = tuple(name for name in ORDER if name in recording and np.ptp(recording[name]) > 0)
    drive = next((name for name in (*FORCES, *FEET) if name in recording), "")
    if not motions:
        where, found = recording.provenance.file, ", ".join(recording.names)
        raise InputError(where, f"needs a motion that changes; found {found}", "Map the columns by channels:")
    return motions, drive


def stretches(y: Array, rate: float, frequency: float) -> list[tuple[int, int]]:
    """From each release to the next: begins where the motion jumps up by several times out of what was before.

    Parameters
    ----------
    y : (n, c) float
    rate, frequency : float [Hz]
    """
    width = max(4, round(0.5 * rate / frequency))
    count = len(y) // width
    if count < 6:
        return [(0, len(y))]
    # of differences, so that a mass held aside before the release is quiet as one at rest is
    moves = np.abs(np.diff(y / np.maximum(y.std(axis=0), 1e-300), axis=0, append=y[-1:])).sum(axis=1)
    level = np.sqrt((moves[: count * width] ** 2).reshape(count, width).mean(axis=1))
    loud = np.quantile(level, 0.98)
    begins: list[int] = []
    for k in range(1, count - 2):
        before = level[max(0, k - 3) : k].max()
        after = level[k : k + 3].max()
        if after > 3.0 * before and after > 3.0 * QUIET * loud and (not begins or k - begins[-1] > 4):
            begins.append(k)
    if not begins:
        return [(0, len(y))]
    exact = []
    for k in begins:
        stop = min((k + 3) * width, len(moves))
        inside = moves[(k - 1) * width : stop]
        noise = np.quantile(moves[max(0, (k - 4)) * width : max(1, k - 1) * width], 0.9)
        onset = (k - 1) * width + int(np.argmax(inside > max(4.0 * noise, 0.15 * inside.max())))
        # the release itself lasts a few samples, and a hit as long as its peak
        exact.append(onset + 1 + int(np.argmax(moves[onset : min(onset + width // 2 + 1, len(moves))])))
    first = [0] if level[: max(begins[0] - 1, 1)].max() > QUIET * loud else []
    edges = [*first, *exact, len(y)]
    return [(a, b) for a, b in itertools.pairwise(edges) if b - a > 4 * width]


def _single(samples: Array) -> tuple[Array, Array]:
    """(n,) bool, (n,) float: single samples far off the cubic through two neighbours on each side, and that cubic in
    their place. A single one leaves -2/3 of itself at both neighbours, which a jump does not."""
    off, smooth = np.zeros(len(samples)), samples.copy()
    wild = np.zeros(len(samples), dtype=bool)
    if len(samples) <= 2 * AROUND:
        return wild, smooth
    near = samples[1:-3] + samples[3:-1]
    smooth[2:-2] = (4.0 * near - samples[:-4] - samples[4:]) / 6.0
    off = samples - smooth
    sums, at = np.concatenate([[0.0], np.cumsum(off**2)]), np.arange(len(samples))
    low, high = np.maximum(at - AROUND, 0), np.minimum(at + AROUND + 1, len(samples))
    inner_low, inner_high = np.maximum(at - 2, 0), np.minimum(at + 3, len(samples))
    count = high - low - (inner_high - inner_low)
    around = (sums[high] - sums[low] - (sums[inner_high] - sums[inner_low])) / count
    wild = np.abs(off) > WILD * np.sqrt(np.maximum(around, median_std(off) ** 2))
    size = np.where(off == 0.0, 1.0, off)
    for side in (np.roll(off, 1), np.roll(off, -1)):
        wild &= np.abs(side / size + 2.0 / 3.0) < 0.25
    return wild, smooth
