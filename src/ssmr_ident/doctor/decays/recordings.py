"""A robot's decay as both fits take it: by its exponentials, and by the simulator."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.body.free_decays import blocks_of
from ssmr_ident.identify.body.response import sensor_gains
from ssmr_ident.identify.trials import Trial
from ssmr_ident.identify.trials.decay import AXES, STATES
from ssmr_ident.simulate.body import AWAY, MOVING

Array = np.ndarray

OFFSETS = np.array([STATES.index(name) for name in AWAY])
VELOCITIES = np.array([STATES.index(f"{name}_rate") for name in MOVING])
"""Where a release's offsets and velocities are among a trial's nuisances."""

BEND = 1e-5
"""Share of a pole by which it is moved to differentiate what sensors make of it, and of a bandwidth."""


@dataclass(frozen=True, eq=False)
class Sensed:
    """What sensor and averaging make of e^(st), and its slopes by s [s] and by the bandwidth [1/Hz]; (k,) complex."""

    gain: Array
    by_pole: Array
    by_band: Array


@dataclass(frozen=True, eq=False)
class Decay:
    """A recording and the grid that it is fitted on.

    Parameters
    ----------
    trial : Trial
    builder : RobotBuilder
    axes : tuple of int
        Which of ax, ay, az its channels are.
    first, step : float [s]
        Middle of the first block from the release, and from one to the next.
    log_step : float [s]
    block : int
        Samples of the log in one.
    """

    trial: Trial
    builder: RobotBuilder
    axes: tuple[int, ...]
    first: float
    step: float
    log_step: float
    block: int

    @property
    def times(self) -> Array:
        """(n,) float [s] from the release."""
        return self.first + self.step * np.arange(len(self.trial.times))

    def coarse(self) -> Decay:
        """The same, simulated in steps twice as long."""
        shorten = self.trial.shorten
        return self if shorten is None else replace(self, trial=shorten(1e6).with_noises(self.trial.noises))

    def later(self, seconds: float) -> Decay:
        """The same from so long after its release on; itself where it cannot be cut."""
        return replace(self, trial=self.trial.since(seconds))

    def whitened(self, columns: Array) -> Array:
        """(n, k) to (c, n', k), through each channel's noise, its zero and mains lines taken out."""
        count, channels = columns.shape[1], len(self.axes)
        stacked = np.broadcast_to(columns[:, None, :], (len(columns), channels, count))
        return self.trial.whitened(stacked).reshape(channels, -1, count)

    def sensed(self, poles: Array, bandwidth_hz: float, own: Array, banded: bool) -> Sensed:
        """What sensor and averaging make of e^(st); poles that are a sensor's ``own`` it does not filter."""

        def at(s: Array, hz: float) -> Array:
            lags = self.log_step * (np.arange(self.block) - (self.block - 1) / 2)
            mean = np.exp(np.outer(s, lags)).mean(axis=1)
            mean[~own] *= sensor_gains(s[~own], hz, self.log_step)
            return mean

        move = BEND * np.maximum(np.abs(poles), 1.0)
        gain = at(poles, bandwidth_hz)
        by_pole = (at(poles + move, bandwidth_hz) - at(poles - move, bandwidth_hz)) / (2.0 * move)
        by_band = np.zeros_like(gain)
        if banded:
            by_band = (at(poles, (1.0 + BEND) * bandwidth_hz) - gain) / (BEND * bandwidth_hz)
        return Sensed(gain, by_pole, by_band)


def decay_of(trial: Trial, builder: RobotBuilder) -> Decay:
    """A free response as ``decay_trial`` has prepared it."""
    times = trial.course.times
    log_step = float(times[-1] - times[0]) / (len(times) - 1)
    block = round(trial.step / log_step)
    skip = blocks_of(log_step, builder.nominal.accelerometer.bandwidth_hz)[1]
    own = RobotBuilder.once(builder.nominal.sliding_together())
    axes = tuple(AXES.index(name) for name in trial.channels)
    return Decay(trial, own, axes, (skip + (block - 1) / 2) * log_step, block * log_step, log_step, block)


def thinned(decay: Decay, seconds: float, every: int) -> Decay:
    """Every so many blocks of a decay's first part: cheap, for the choice of where to begin."""
    kept = slice(0, max(24 * every, min(len(decay.trial.times), round(seconds / decay.step))), every)
    trial = decay.trial
    drift = None if trial.drift is None else trial.drift[kept]
    counts = None if trial.counts is None else trial.counts[kept]
    trial = replace(trial, times=trial.times[kept], target=trial.target[kept], basis=trial.basis[kept], drift=drift,
                    counts=counts, shorten=None, delay=None)  # fmt: skip
    return replace(decay, trial=trial, step=decay.step * every)
