"""Saw-teeth in a pull: where the contact lets go and grips again, and whether it does so at all.

A finding of stick-slip needs three drops, each followed by a rise about as steep as the first one: the spring
that loads the contact is the same. A plateau that wanders (a rough or worn surface, a drifting zero) has neither.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.ndimage import median_filter

from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.forces.ramps import Ramp, find_ramps
from ssmr_ident.signals.noise import force_noise

Array = np.ndarray

FEWEST_TEETH = 3
"""Drops needed for a claim: one is a bump, two may be chance."""

FLAT, STEEP = 0.4, 2.5
"""Slopes over the first rise's between which a rise is about as steep."""


@dataclass(frozen=True)
class Tooth:
    """One drop: the force before it, after it, and the rise that follows.

    Parameters
    ----------
    sample : int
        At which the force is highest before the drop.
    peak, trough : float [N]
    slope, slope_std : float [N/m]
        Of the rise after it.
    """

    sample: int
    peak: float
    trough: float
    slope: float
    slope_std: float


@dataclass(frozen=True)
class Pull(Shown):
    """A pull taken apart.

    Parameters
    ----------
    first : Ramp
        The first rise, whose slope is the stiffness of all gripping contacts and the cable.
    teeth : tuple of Tooth
    slides_from : int
        First sample after the first rise and all knees of letting go, from which the level is that of sliding.
    level, level_std : float [N]
        Mean force from there on, its uncertainty with the wander counted.
    wander : float [N]
        Standard deviation about the mean from there on.
    zero, zero_std : float [N]
        Force before the pull; ``nan`` where the log begins in the rise.
    peak : float [N]
        Highest force, by the lines.
    """

    first: Ramp
    teeth: tuple[Tooth, ...]
    slides_from: int
    level: float
    level_std: float
    wander: float
    zero: float
    zero_std: float
    peak: float

    @property
    def stick_slip(self) -> bool:
        """True where three or more drops are each followed by a rise as steep as the first."""
        return len(self.teeth) >= FEWEST_TEETH

    @property
    def slides(self) -> bool:
        """True where the log goes on after the first rise long enough to speak of a level."""
        return bool(np.isfinite(self.level))

    def __str__(self) -> str:
        lines = [f"first rise {self.first.slope / 1e3:.4g} +/- {self.first.slope_std / 1e3:.2g} N/mm"]
        if self.slides:
            lines.append(f"sliding at {self.level:.4g} +/- {self.level_std:.2g} N, wander {self.wander:.2g} N")
        if self.stick_slip:
            peaks, troughs = np.array([[tooth.peak, tooth.trough] for tooth in self.teeth]).T
            lines.append(
                f"{len(self.teeth)} teeth: peaks {peaks.mean():.4g} (std {peaks.std(ddof=1):.2g}) N, "
                f"troughs {troughs.mean():.4g} (std {troughs.std(ddof=1):.2g}) N"
            )
        else:
            lines.append(f"no stick-slip ({len(self.teeth)} drops with a rise after them; three are asked for)")
        return "\n".join(lines)


def take_apart(position: Array, force: Array) -> Pull:
    """First rise, teeth and sliding level of a pull.

    Parameters
    ----------
    position : (n,) float [m]
        Of the machine.
    force : (n,) float [N]

    Returns
    -------
    Pull

    Raises
    ------
    ValueError
        When no stretch of the log rises.
    """
    moving = machine_moves(position)
    position, force = position[moving], force[moving]
    if len(force) < 30:
        raise ValueError("the machine hardly moves")
    ramps = find_ramps(position, force)
    noise = force_noise(force)
    first = first_rise(ramps, noise)
    peak = float(np.max(median_filter(force, size=5)))
    teeth = _teeth(ramps, first, noise, position, force)
    slides_from = _sliding_start(ramps, first, noise)
    zero, zero_std = _before(ramps, first, force)
    tail = force[slides_from:]
    if len(tail) < max(20, len(force) // 50):
        return Pull(first, teeth, slides_from, np.nan, np.nan, np.nan, zero, zero_std, peak)
    level, level_std = mean_with_wander(tail)
    return Pull(first, teeth, slides_from, level, level_std, float(np.std(tail)), zero, zero_std, max(peak, level))


def machine_moves(position: Array) -> Array:
    """True where the machine moves on, (n,) bool: a hold in between relaxes, which is neither ramp nor sliding.

    Speed is taken over a hundredth of the log; below a fifth of its 95th percentile the machine stands.
    """
    position = np.asarray(position, float)
    width = max(2, len(position) // 100)
    speed = np.abs(position[width:] - position[:-width])
    usual = float(np.quantile(speed, 0.95)) if len(speed) else 0.0
    if usual <= 0:
        return np.zeros(len(position), bool)
    slow = speed < 0.2 * usual
    standing = np.zeros(len(position), bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], slow.astype(int), [0]])))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        standing[begin : end + width] = True
        # the window reaches over the edge of a hold: give back what still moves
        at = np.arange(begin, min(end + width, len(position)))
        standing[at[np.abs(np.gradient(position)[at]) > 0.5 * usual / width]] = False
    return ~standing


def first_rise(ramps: tuple[Ramp, ...], noise: float) -> Ramp:
    """The stretch that rises most, among those that begin in the lower third of the force range.

    Raises
    ------
    ValueError
        When nothing rises above the noise.
    """
    highest = max(max(ramp.force_start, ramp.force_end) for ramp in ramps)
    lowest = min(min(ramp.force_start, ramp.force_end) for ramp in ramps)
    rising = [
        ramp
        for ramp in ramps
        if ramp.slope > 0
        and ramp.samples >= 5
        and ramp.force_end - ramp.force_start > 5 * noise
        and ramp.force_start < lowest + 0.35 * (highest - lowest)
    ]
    if not rising:
        raise ValueError("the force never rises")
    return max(rising, key=lambda ramp: ramp.force_end - ramp.force_start)


def _teeth(ramps: tuple[Ramp, ...], first: Ramp, noise: float, position: Array, force: Array) -> tuple[Tooth, ...]:
    after = [ramp for ramp in ramps if ramp.first >= first.first]
    # A stretch that falls faster than the spring rises is the letting go itself.
    steady = [ramp for ramp in after if ramp.slope > -first.slope and ramp.samples >= 4]
    found = []
    for index, before in enumerate(steady[:-1]):
        if before.slope > STEEP * first.slope:
            continue  # a rebound, from which the force does not let go but swings back
        following = steady[index + 1]
        begin, end = max(before.last - 2, 0), min(following.first + 3, len(force))
        gap = force[begin:end]
        # A drop of one sample still makes a stretch of three, which takes samples off its neighbours: both lines
        # are carried on to where the force falls most, halfway between two samples.
        fall = begin + int(np.argmin(np.diff(gap)))
        at = float(position[fall] + position[fall + 1]) / 2
        peak = before.force_end + before.slope * (at - before.x_end)
        peak = float(np.clip(peak, np.max(gap) - 2 * noise, np.max(gap) + 2 * noise))
        # 2 % of the level: below it a tooth says nothing about two friction coefficients.
        least = max(5 * noise, 0.02 * abs(peak))
        rise = _rise_after(steady[index:], first, least)
        if rise is not None:
            trough = rise.force_start + rise.slope * (at - rise.x_start)
            # no upper limit here: a single low sample is the body's swing, not the friction it grips again at
            trough = max(trough, float(np.min(gap)) - 2 * noise)
            found.append(Tooth(before.last, peak, trough, rise.slope, rise.slope_std))
    return tuple(found)


def _rise_after(ramps: Sequence[Ramp], first: Ramp, least: float) -> Ramp | None:
    """The rise about as steep as the first one that follows a drop by ``least`` [N] behind the first of some stretches.

    The body may swing in between: what is stretched as it grips again rebounds four times as fast, for a tenth of a
    second. Then the rise lasts longer than what it is behind of, and begins before the next drop.
    """
    before = ramps[0]
    for last, ramp in pairwise(ramps):
        falls = last.force_end - ramp.force_start > least and last.slope < STEEP * first.slope
        if (last is before) != falls:
            return None
        grips = FLAT * first.slope < ramp.slope < STEEP * first.slope and before.force_end - ramp.force_start > least
        if grips and (last is before or ramp.samples > ramp.first - before.last):
            return ramp
    return None


def _sliding_start(ramps: tuple[Ramp, ...], first: Ramp, noise: float) -> int:
    """After the first rise, the first stretch that no longer rises at a tenth of the first slope, or a drop."""
    previous = first
    for ramp in ramps:
        if ramp.first <= first.first:
            continue
        falls = ramp.force_start < previous.force_end - 5 * noise
        if ramp.samples >= 5 and (ramp.slope < 0.1 * first.slope or falls):
            return ramp.first
        if ramp.samples >= 5:
            previous = ramp
    return previous.last + 1


def _before(ramps: tuple[Ramp, ...], first: Ramp, force: Array) -> tuple[float, float]:
    """Force before the first rise, where there is a level stretch; otherwise nan."""
    level = [
        ramp for ramp in ramps if ramp.last < first.first and abs(ramp.slope) < 0.1 * first.slope and ramp.samples >= 10
    ]
    if not level:
        return np.nan, np.nan
    longest = max(level, key=lambda ramp: ramp.samples)
    return mean_with_wander(force[longest.first : longest.last + 1])


def mean_with_wander(samples: Array) -> tuple[float, float]:
    """Mean and its standard deviation for correlated samples, from the spread of 20 batch means."""
    batches = min(20, len(samples) // 5)
    if batches < 4:
        return float(np.mean(samples)), float(np.std(samples))
    width = len(samples) // batches
    means = samples[: width * batches].reshape(batches, width).mean(axis=1)
    spread = float(np.std(means, ddof=1))
    centred = means - means.mean()
    power = float(centred @ centred)
    correlation = float(np.clip(centred[1:] @ centred[:-1] / power, 0.0, 0.9)) if power > 0 else 0.0
    return float(np.mean(samples)), spread / np.sqrt(batches) * np.sqrt((1 + correlation) / (1 - correlation))
