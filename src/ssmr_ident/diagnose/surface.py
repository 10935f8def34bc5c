"""Restoring-force surfaces: what a baseline leaves unexplained, over displacement and velocity."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.evidence import ForceSurface
from ssmr_ident.diagnose.motion import main_channel, motion_of
from ssmr_ident.diagnose.residual_force import force_of, oscillator
from ssmr_ident.diagnose.residual_map import excess
from ssmr_ident.diagnose.tire_force import is_robot, tire_state
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.trials.trial import Trial

Array = np.ndarray

MOST = 3
OFF_THE_ENDS = 0.04
"""Share at both ends of a recording that is left out: there a filter has seen only one side."""

AT_REST = 0.05
"""Share of the largest motion below which a sample is the rest after a decay."""


def surfaces(before: JointFit, after: JointFit | None, parameters: ParameterSet) -> tuple[ForceSurface, ...]:
    """Residual force of the channels with most misfit; recordings that show the same are put together.

    Parameters
    ----------
    before : JointFit
    after : JointFit or None
        On the same trials; None repeats ``before``.
    parameters : ParameterSet
        Of the session, for what is not fitted (a mass).
    """
    groups: dict[tuple[str, str, str], list[tuple[int, int]]] = defaultdict(list)
    for index, trial in enumerate(before.trials):
        if trial.channels == ("force",):
            groups[trial.experiment.name, trial.kind, "force"].append((index, 0))
        elif is_robot(trial):  # by the motion, not by a channel: a force is sought in all of them
            place = tire_state(before, index, parameters, []).place
            groups[trial.experiment.name, trial.kind, place].append((index, main_channel(trial)))
        else:
            channel = max(range(len(trial.channels)), key=lambda c: excess(before, index, c))
            groups[trial.experiment.name, trial.kind, trial.channels[channel]].append((index, channel))
    ordered = sorted(groups.values(), key=lambda pairs: -sum(_misfit(before, index) for index, _ in pairs))
    return tuple(_surface(before, after, pairs, parameters) for pairs in ordered[:MOST])


def _misfit(fit: JointFit, index: int) -> float:
    return sum(excess(fit, index, channel) for channel in range(len(fit.trials[index].channels)))


def _surface(
    before: JointFit, after: JointFit | None, pairs: list[tuple[int, int]], parameters: ParameterSet
) -> ForceSurface:
    parts, where, units = [], "", ("m", "m/s", "N")
    for index, channel in pairs:
        trial = before.trials[index]
        rests = [trial.colour(fit.simulated[index])[:, channel] for fit in (before, after or before)]
        if trial.channels == ("force",):
            travel = float(trial.facts["travel_m"]) * (trial.times - trial.times[0]) / np.ptp(trial.times)
            where = "travel of the pulling head"
            parts.append(np.column_stack([travel, np.gradient(travel, trial.step), *rests]))
            continue
        if is_robot(trial):
            state = tire_state(before, index, parameters, [fit.simulated[index] for fit in (before, after or before)])
            where = f"{trial.kind}: {state.place}"
            parts.append(_moving(np.column_stack([state.deflection, state.rate, *state.forces]), trial))
            continue
        # both are worked out by the baseline's own mass, damper and spring: what is left is compared, not two operators
        found = oscillator(before, index, channel, parameters)
        motion = motion_of(trial, trial.target[:, channel], channel)
        where, units = motion.place, motion.units
        forces = [force_of(rest, trial, channel, found) for rest in rests]
        parts.append(_moving(np.column_stack([motion.displacement, motion.velocity, *forces]), trial))
    points = np.concatenate(parts)
    names = [before.trials[index].name for index, _ in pairs]
    name = names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} more"
    displacement, velocity, first, second = points.T
    return ForceSurface(name, where, displacement, velocity, first, second, units)


def _moving(points: Array, trial: Trial) -> Array:
    """Without the ends, and without the rest after a decay."""
    count = len(points)
    cut = round(OFF_THE_ENDS * count)
    radius = np.hypot(*(points[:, k] / max(np.std(points[:, k]), 1e-300) for k in range(2)))
    inside = radius > AT_REST * radius.max()
    inside[:cut] = inside[count - cut :] = False
    if trial.counts is not None:
        inside &= trial.counts.all(axis=1)
    return points[inside]
