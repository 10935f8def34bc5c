"""Where the misfit sits: recording, channel, time and frequency, and the part of the state space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_dilation, label

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.diagnosis import Located
from ssmr_ident.diagnose.ordering import CLEAR, Ordering, ordering, state_variables
from ssmr_ident.diagnose.residual_force import unexplained_force
from ssmr_ident.diagnose.residual_map import Cells, axes, cells, column, counting, excess, ranked
from ssmr_ident.diagnose.tire_force import is_robot, tire_state
from ssmr_ident.identify.fitting.joint import JointFit

Array = np.ndarray

CHANNELS = 4
"""Recordings and channels that are looked into, most misfit first."""

PER_CHANNEL = 2
"""Regions that are told of one channel."""

SMALLEST_SHARE = 0.03
FEWEST = 50
"""Samples of a region in which a variable is looked for."""

CORE = (0.05, 0.95)
"""Between these quantiles of its power a region's times and frequencies are given."""


@dataclass(frozen=True, eq=False)
class _Region:
    time: tuple[float, float]
    band: tuple[float, float]
    share: float


def located(fit: JointFit, parameters: ParameterSet, most: int = 4, seed: int = 0) -> tuple[Located, ...]:
    """Where a fit leaves more than noise, most important first; nothing where no region stands out.

    Parameters
    ----------
    fit : JointFit
        Its trials' noises are what the residual is held against.
    parameters : ParameterSet
        Of the session, for what is not fitted.
    most : int
    seed : int
        Of the test which variable orders the residual.
    """
    pairs = ranked(fit)
    sizes = {pair: excess(fit, *pair) for pair in pairs}
    total = sum(sizes.values())
    if not total > 0.0:
        return ()
    places = []
    for pair in pairs[:CHANNELS]:
        share = sizes[pair] / total
        if share < SMALLEST_SHARE:
            break
        index, channel = pair
        trial = fit.trials[index]
        counts = counting(fit, *pair)
        rest = column(fit, *pair)
        found = cells(rest, counts)
        regions = _regions(found, *axes(found, trial.times[trial.lost :], trial.step), trial.times)
        if not regions:
            continue
        for region in regions[:PER_CHANNEL]:
            if share * region.share >= SMALLEST_SHARE:
                where = _state(fit, *pair, region, parameters, seed)
                places.append(_place(trial.name, trial.channels[channel], region, share * region.share, where))
    return tuple(sorted(places, key=lambda place: -place.share)[:most])


def _state(
    fit: JointFit, index: int, channel: int, region: _Region, parameters: ParameterSet, seed: int
) -> Ordering | None:
    """What orders the unexplained force within a region's time."""
    trial = fit.trials[index]
    inside = (trial.times >= region.time[0]) & (trial.times <= region.time[1])
    inside[trial.lost :] &= counting(fit, index, channel)
    if np.count_nonzero(inside) < FEWEST:
        return None
    if is_robot(trial):
        state = tire_state(fit, index, parameters, [fit.simulated[index]])
        force, since = state.forces[0], trial.times - trial.times[0]
        variables = {"displacement": (state.deflection, "m"), "velocity": (state.rate, "m/s"), "time": (since, "s")}
    else:
        force, variables = unexplained_force(fit, index, channel, parameters), state_variables(trial, channel)
    return ordering(force[inside], {name: (v[inside], unit) for name, (v, unit) in variables.items()}, seed)


def _regions(found: Cells, time: Array, frequency: Array, times: Array) -> list[_Region]:
    """Connected parts of a map above what noise gives, most power first."""
    power = np.nan_to_num(found.power)
    above = power > found.threshold
    if not above.any():
        return []
    # cells that nearly touch are one region
    labels, count = label(binary_dilation(above, np.ones((3, 3))), np.ones((3, 3)))
    gain = np.where(above, power - 1.0, 0.0)
    whole = float(np.maximum(power - 1.0, 0.0).sum())
    half_hop = 0.5 * (time[1] - time[0]) if len(time) > 1 else 0.0
    half_row = 0.5 * frequency[1]
    regions = []
    for number in range(1, count + 1):
        inside = np.where(labels == number, gain, 0.0)
        columns, rows = _core(inside.sum(axis=0)), _core(inside.sum(axis=1))
        start = times[0] if columns[0] == 0 else time[columns[0]] - half_hop
        end = times[-1] if columns[1] == len(time) - 1 else time[columns[1]] + half_hop
        band = (max(frequency[rows[0]] - half_row, 0.0), frequency[rows[1]] + half_row)
        share = float(inside.sum()) / whole
        regions.append(_Region((float(start), float(end)), (float(band[0]), float(band[1])), share))
    return sorted(regions, key=lambda region: -region.share)


def _core(weight: Array) -> tuple[int, int]:
    """First and last place of the middle 90 % of a weight."""
    reached = np.cumsum(weight) / weight.sum()
    last = min(int(np.searchsorted(reached, CORE[1] - 1e-12)), len(weight) - 1)
    return int(np.searchsorted(reached, CORE[0] - 1e-12)), last


def _place(recording: str, channel: str, region: _Region, share: float, where: Ordering | None) -> Located:
    clear = where is not None and where.p_value < CLEAR
    (start, end), (low, high) = region.time, region.band
    sentence = (
        f"{100 * share:.0f} % of what is left sits in {channel} of {recording} between {start:.3g} and {end:.3g} s "
        f"and at {_band(low, high)} Hz"
    )
    if clear and where is not None:
        if where.follows:
            sentence += f"; the force left over follows the {where.variable} (to {100 * where.explained:.0f} %) and"
        else:
            sentence += "; it"
        sentence += f" is strongest {where.words} ({where.condition})"
    condition = where.condition if clear and where is not None else ""
    return Located(recording, channel, region.time, region.band, condition, share, f"{sentence}.")


def _band(low: float, high: float) -> str:
    digits = 0 if high >= 3.0 else 2
    return f"{low:.{digits}f} to {high:.{digits}f}"
