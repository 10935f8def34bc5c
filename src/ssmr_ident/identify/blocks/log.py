"""One pull of a block as it was logged: what the head did, what the load cell read, and what is rest and what rise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.forces.sawtooth import machine_moves
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.signals.noise import force_noise

Array = np.ndarray

LOW, HIGH = 0.2, 0.7
"""Shares of the first load between which the rise is taken to be straight."""

TAKES_UP = 2.0
"""Samples about the jump of a force that is up at once."""

BESIDE, CLEAR, GOES_ON = 5, 6.0, 0.2
"""Samples on either side of a step of the force, sizes of noise from which it is one, and the share of it by which the
force may go on changing over as many samples more."""

STANDS = 0.05
"""Share of a pull for which a position has to stand, after the rise, for it to say more than the speed does. It may be
the block's own, which stands while the force comes up."""


@dataclass(frozen=True, eq=False)
class PulledLog:
    """A pull on an even grid.

    Parameters
    ----------
    name : str
    time, force : (n,) float [s, N]
    head : (n,) float [m]
        Of the drive, as if the cable had no slack: from its first sample at constant speed, or as logged.
    speed : float [m/s]
    noise : float [N]
        White, per sample.
    rests : float [N]
        Force before the drive starts.
    starts : float [s]
        From the first sample until the force begins to rise.
    jumps : float [s]
        From the first sample until the force is up, if it comes up within a sample.
    rise : float [N/s]
        Rate of the first rise.
    load : float [N]
        That it rises by, about.
    """

    name: str
    time: Array
    force: Array
    head: Array
    speed: float
    noise: float
    rests: float
    starts: float
    jumps: float
    rise: float
    load: float

    @property
    def counts(self) -> Array:
        """Samples that are compared, (n,) bool: how a head takes up its speed as the cable tightens is in no log."""
        away: Array = np.abs((self.time - self.time[0]) / self.step - self.jumps / self.step) > TAKES_UP
        return away

    @property
    def step(self) -> float:
        return float(self.time[1] - self.time[0])

    def until(self, sample: int) -> PulledLog:
        """Its beginning."""
        return replace(self, time=self.time[:sample], force=self.force[:sample], head=self.head[:sample])


def pulled_log(measurement: Measurement) -> PulledLog:
    """Read a pull.

    Raises
    ------
    InputError
        No force, neither position nor speed, or a force that never rises.
    """
    recording, entry = measurement.recording, measurement.entry
    where = recording.provenance.file
    if "force" not in recording:
        raise InputError(where, "has no force channel", "Map the header in session.yaml under channels")
    names = ["force", *(["position"] if "position" in recording else [])]
    even = even_samples(recording.time, np.column_stack([recording[name] for name in names]))
    force, time = even.samples[:, 0], even.time
    step = 1.0 / even.sample_rate
    if len(force) < 30:
        raise InputError(where, f"has {len(force)} samples", "A pull needs 30 at least")
    noise = force_noise(force)
    low, high, rests, load = _at_once(force, noise) or _rise(force)
    if not high > low + 1:
        low, high = max(high - 1, 0), min(high + 1, len(force) - 1)
    rise = float((force[high] - force[low]) / ((high - low) * step))
    rise = max(rise, load / (len(force) * step))  # a drift may fall faster than the drive loads
    starts = max((low - (force[low] - rests) / max(rise * step, 1e-300)) * step, 0.0)
    elapsed = time - time[0]
    logged = even.samples[:, 1] - even.samples[0, 1] if "position" in recording else None
    if logged is not None and abs(logged.min()) > abs(logged.max()):
        logged = -logged
    speed = entry.speed_mm_s * 1e-3 if entry.speed_mm_s else 0.0
    head = speed * elapsed
    if logged is not None:
        usual = float((logged[-1] - logged[high]) / max((len(force) - 1 - high) * step, step))
        stands = float(np.mean(~machine_moves(logged[high:]))) > STANDS
        if stands or not speed:
            head, speed = logged, speed or usual
    if not speed > 0.0:
        raise InputError(where, "has no position that moves on, and session.yaml no speed_mm_s", "Give speed_mm_s")
    return PulledLog(
        measurement.name,
        time,
        force,
        head,
        speed,
        max(noise, 1e-9 * load),
        rests,
        starts,
        _jump(force, low, high) * step,
        rise,
        load,
    )


def _at_once(force: Array, noise: float) -> tuple[int, int, float, float] | None:
    """The same of a force that is up within some samples and goes on as it then is; None where no such step stands out.
    Its rest may be a single sample, and a zero that drifts may have gone further than the step."""
    total = np.concatenate([[0.0], np.cumsum(force)])
    at = np.arange(1, len(force) - 2 * BESIDE)
    before = (total[at] - total[np.maximum(at - BESIDE, 0)]) / np.minimum(at, BESIDE)
    after = (total[at + BESIDE] - total[at]) / BESIDE
    further = (total[at + 2 * BESIDE] - total[at + BESIDE]) / BESIDE
    step = after - before
    best = int(np.argmax(step))
    if step[best] < CLEAR * noise or abs(further[best] - after[best]) > GOES_ON * step[best]:
        return None
    return best, best + 1, float(np.median(force[: best + 1])), float(step[best])


def _rise(force: Array) -> tuple[int, int, float, float]:
    """Samples between which the first rise is straight, the force before it, and what it rises by."""
    width = max(1, len(force) // 500)
    smooth = np.convolve(np.pad(force, width, mode="edge"), np.full(2 * width + 1, 1.0 / (2 * width + 1)), "valid")
    top = float(np.quantile(smooth, 0.9))
    rests = float(np.quantile(smooth[: max(int(np.argmax(smooth > 0.5 * (smooth[0] + top))), 3)], 0.25))
    load = max(top - rests, 1e-12)
    high = int(np.argmax(smooth > rests + HIGH * load))
    below = np.flatnonzero(smooth[: high + 1] < rests + LOW * load)
    quiet = int(below[-1]) if len(below) else 0
    before = force[: max(quiet - width, 3)]
    return quiet, high, float(np.median(before[: max(len(before) // 2, 3)])), load


def _jump(force: Array, low: int, high: int) -> float:
    """Between which samples two levels fit best, near the rise."""
    around = 2 * (high - low) + 10
    begin, end = max(low - around, 0), min(high + around, len(force))
    part = force[begin:end]
    count, total = np.arange(1, len(part)), np.cumsum(part)[:-1]
    gain = total**2 / count + (part.sum() - total) ** 2 / (len(part) - count)
    return begin + int(np.argmax(gain)) + 0.5
