"""Experiments that could be made next, as trials that can be simulated: the recorded ones once more or smaller, or at
another speed that was recorded. What was not shown to be possible is not proposed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.recording import Channel
from ssmr_ident.diagnose.motion import main_channel, motion_of
from ssmr_ident.diagnose.quantity import prefixed
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.trials import trial_of
from ssmr_ident.identify.trials.decay import SCALES
from ssmr_ident.identify.trials.trial import Trial

Array = np.ndarray

SHARES = {1.0: "", 0.5: "half", 0.25: "a quarter of", 0.125: "an eighth of"}
"""Of the largest that was recorded."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """A trial that has not been recorded.

    Parameters
    ----------
    words : str
        What to do, beginning with a capital letter.
    trial : Trial
        ``target`` means nothing.
    index : int
        Of the recorded trial that it is a variant of.
    growth : float
        Factor on that trial's nuisances.
    change : float
        Factor by which it differs from what was recorded, at least 1.
    """

    words: str
    trial: Trial
    index: int
    growth: float = 1.0
    change: float = 1.0


def experiments(setup: Setup, fit: JointFit) -> list[Experiment]:
    """One recording of each kind, the loudest, in all its variants; repeating it as it was comes first.

    Parameters
    ----------
    setup : Setup
    fit : JointFit
        Of the recordings that were fitted.
    """
    by_name = {m.name: m for m in setup.campaign.measurements}
    loudest: dict[tuple[str | None, ...], int] = {}
    for index, trial in enumerate(fit.trials):
        entry = by_name[trial.name].entry
        kind = (entry.experiment, entry.motion, entry.direction)
        if kind not in loudest or np.ptp(trial.target) > np.ptp(fit.trials[loudest[kind]].target):
            loudest[kind] = index

    def make(measurement: Measurement) -> Trial:
        return trial_of(setup.campaign.session.baseline, measurement, setup.campaign.parameters)

    return [
        e for index in loudest.values() for e in _variants(setup, fit, index, by_name[fit.trials[index].name], make)
    ]


def _variants(
    setup: Setup, fit: JointFit, index: int, recorded: Measurement, make: Callable[[Measurement], Trial]
) -> list[Experiment]:
    trial = fit.trials[index]
    if trial.channels == ("force",):
        return [_pulled(trial, index, recorded, share, make) for share in _speeds(setup, recorded)]
    if "force" in recorded.recording or "torque" in recorded.recording:
        return [_shaken(trial, index, recorded, share, make) for share in SHARES]
    motion, size = recorded.entry.motion, _release_size(setup, fit, index, recorded.entry.motion)
    what = motion or "the mass"
    found = []
    for share, part in SHARES.items():
        how = f"from {part} the displacement ({size(share)})" if part else f"as before ({size(1.0)})"
        limit = setup.campaign.parameters.number("accelerometer.range_m_s2", np.inf)
        found.append(
            Experiment(f"Release {what} {how}", _clipped(trial, fit, index, share, limit), index, share, _change(share))
        )
    return found


def _change(share: float) -> float:
    return max(share, 1.0 / share)


def _clipped(trial: Trial, fit: JointFit, index: int, share: float, limit: float) -> Trial:
    """The trial with what its sensor cannot show at this size left out."""
    inside = np.abs(share * fit.simulated[index]) < limit
    return replace(trial, counts=None if inside.all() or limit == np.inf else inside)


def _shaken(
    trial: Trial, index: int, recorded: Measurement, share: float, make: Callable[[Measurement], Trial]
) -> Experiment:
    """Under the same force, larger or smaller; start and motion grow with it."""
    new = make(_scaled(recorded, share)).with_noises(trial.noises)
    # nuisances are in units of the recorded motion and force, which have grown alike
    size = prefixed(
        share * float(np.std(recorded.recording["force" if "force" in recorded.recording else "torque"])), "N"
    )
    if share == 1.0:
        return Experiment(f"Shake as in {recorded.name} ({size} rms)", new, index, 1.0, _change(share))
    return Experiment(
        f"Shake as in {recorded.name} with {SHARES[share]} the force ({size} rms)", new, index, 1.0, _change(share)
    )


def _pulled(
    trial: Trial, index: int, recorded: Measurement, share: float, make: Callable[[Measurement], Trial]
) -> Experiment:
    """The same travel, faster or slower."""
    recording = replace(recorded.recording, time=recorded.recording.time / share)
    speed = recorded.entry.speed_mm_s
    entry = replace(recorded.entry, speed_mm_s=None if speed is None else speed * share)
    new = make(replace(recorded, entry=entry, recording=recording)).with_noises(trial.noises)
    rate = float(trial.facts["travel_m"]) / float(trial.times[-1] - trial.times[0])
    how = "as before, at" if share == 1.0 else "at"
    words = f"{trial.experiment.verb} {how} {prefixed(rate * share, 'm/s')}"
    return Experiment(words, new, index, 1.0, _change(share))


def _speeds(setup: Setup, recorded: Measurement) -> list[float]:
    """The speeds of the session's pulls, in that of one of them, its own first."""
    own = recorded.entry.speed_mm_s
    every = {m.entry.speed_mm_s for m in setup.campaign.measurements} - {None, own}
    return [1.0, *(speed / own for speed in sorted(filter(None, every)))] if own else [1.0]


def _scaled(recorded: Measurement, share: float) -> Measurement:
    channels = tuple(Channel(c.name, share * c.samples, c.unit, c.label) for c in recorded.recording.channels)
    return replace(recorded, recording=replace(recorded.recording, channels=channels))


def _release_size(setup: Setup, fit: JointFit, index: int, motion: str | None) -> Callable[[float], str]:
    """How far a release goes, in words, for a share of the recorded one."""
    trial = fit.trials[index]
    channel = main_channel(trial)
    moved = motion_of(trial, fit.simulated[index][:, channel], channel)
    if motion is None:
        reach = float(np.max(np.abs(moved.displacement)))
        return lambda share: f"about {prefixed(share * reach, moved.units[0])}"
    points = RobotBuilder.of(setup.campaign.parameters).nominal.contact_points
    place, lever = {"roll": (3, points[:, 1]), "pitch": (4, points[:, 0]), "yaw": (5, points[:, 1])}[motion]
    state = (fit.nuisances[index] * SCALES)[:12]
    angle = float(np.hypot(state[place], state[place + 6] / (2.0 * np.pi * moved.frequency)))
    return lambda share: f"about {prefixed(share * angle * float(np.max(np.abs(lever))), 'm')} at the wheels"
