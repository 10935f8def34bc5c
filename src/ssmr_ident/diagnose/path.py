"""A rig's measured motion as a path, and the force of effects along it.

If the measured motion x obeys m·x'' + d·x' + k·x + f = F and a linear rig's simulated one obeys the same without f,
their difference tells f along x, whatever the motion does afterwards (`residual_force`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.diagnose.motion import LOWEST, ORDER, Band, integrated, main_channel, main_frequency
from ssmr_ident.diagnose.residual_force import Oscillator, force_of, highest
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.physics.effects import unlisted
from ssmr_ident.physics.element import element_force, element_next
from ssmr_ident.physics.slots import UNLISTED, checked, effect_vector

Array = np.ndarray

LONGEST = 4096
"""Samples of a path: of a longer recording the part in which most is unexplained. Chosen, for time; a start needs no
more."""

_unlisted = unlisted.force


@kernel
def _along(x, v, since, step, stiffness, e, out):
    z, free = (0.0, 0.0, 0.0), e[UNLISTED:]
    for n in range(len(x)):
        if n > 0:
            z = element_next(z, (x[n] - x[n - 1]) / step, step, True, e)
        out[n] = element_force(x[n], v[n], z, stiffness, 1.0, 1.0, True, e)
        out[n] += _unlisted(x[n], v[n], since + n * step, 1.0, free)


def force_along(
    x: Array, v: Array, step: float, stiffness: float, effects: Mapping[str, Mapping[str, float]], since: float = 0.0
) -> Array:
    """Force of effects beside spring and damper along a path, (n,) float [N]; hidden states begin at rest.

    Parameters
    ----------
    x, v : (n,) float [m], [m/s]
    step : float [s]
    stiffness : float [N/m]
    effects : mapping of effect id to parameters
    since : float [s]
        Time at the first sample, from the recording's start.
    """
    out = np.empty(len(x))
    _along(x, v, since, step, stiffness, effect_vector(checked(effects)), out)
    return out


@dataclass(frozen=True, eq=False)
class Path:
    """One recording's measured motion, and the force that a linear rig leaves unexplained along it.

    Parameters
    ----------
    displacement, velocity : (n,) float [m], [m/s]
    unexplained : (n,) float [N]
        In the band in which it can be told.
    linear : (n, 3) float
        Acceleration, velocity and displacement in that band.
    since, step : float [s]
        First sample, from the recording's start, and from one to the next.
    band : callable
        A force to as much of it as lies in that band.
    """

    displacement: Array
    velocity: Array
    unexplained: Array
    linear: Array
    since: float
    step: float
    band: Callable[[Array], Array]

    def force(self, stiffness: float, effects: Mapping[str, Mapping[str, float]]) -> Array:
        """Of effects, (n,) float [N], in the band; as it is where it is no number."""
        force = force_along(self.displacement, self.velocity, self.step, stiffness, effects, self.since)
        return self.band(force) if np.isfinite(force).all() else force


def path_of(fit: JointFit, index: int, rig: Oscillator) -> Path:
    """The path of one recording, or of its part in which most is unexplained.

    Parameters
    ----------
    fit : JointFit
        Its effects are left out.
    index : int
    rig : Oscillator
        The fit's.
    """
    trial = fit.trials[index]
    channel = main_channel(trial)
    order = ORDER.get(trial.channels[channel], 2)
    signal = trial.target[:, channel]
    frequency = main_frequency(signal, trial.step, order)
    values, _ = fit.model.split(fit.point)
    rest = trial.colour(trial.run(values, {}, fit.nuisances[index]))[:, channel]
    main = rig.frequency() or frequency
    limits = LOWEST * main, highest(rest, trial, channel, main)
    x, v, a = (integrated(signal, trial.step, order - k, frequency) for k in range(3))
    force = force_of(rest, trial, channel, rig)
    part = loudest(force)
    band = Band(part.stop - part.start, trial.step, np.ones_like, *limits)
    linear = np.column_stack([band(column[part]) for column in (a, v, x)])
    return Path(x[part], v[part], band(force[part]), linear, part.start * trial.step, trial.step, band)


def loudest(force: Array) -> slice:
    """The part of a signal, no longer than ``LONGEST``, with the largest squares."""
    count = min(len(force), LONGEST)
    squares = np.concatenate([[0.0], np.cumsum(force**2)])
    first = int(np.argmax(squares[count:] - squares[:-count]))
    return slice(first, first + count)
