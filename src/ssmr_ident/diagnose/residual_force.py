"""The force that a model leaves unexplained, from what its simulation differs by.

If the true motion x obeys m·x'' + d·x' + k·x + f = F and the simulated one s obeys the same without f, then their
difference r = x − s obeys f = −(m·r'' + d·r' + k·r), whatever drives them: no force need be measured.
Source: Masri and Caughey, J. Appl. Mech. 46 (1979) 433 (the force-state idea; here on the output error).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.motion import ORDER, filtered, integrated, main_frequency
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.trials.trial import Trial
from ssmr_ident.physics.rig import RIG_KEYS

Array = np.ndarray

LOWEST, HIGHEST = 0.5, 6.0
"""Band in which a force is worked out, in units of the oscillator's frequency: below, integrated noise drowns it."""

STANDS_OUT = 3.0
"""Times the noise's density."""


@dataclass(frozen=True)
class Oscillator:
    """m·x'' + d·x' + k·x, of a rig or of a robot's main motion in one channel."""

    mass: float
    damping: float
    stiffness: float

    def frequency(self) -> float:
        return float(np.sqrt(max(self.stiffness, 0.0) / self.mass) / (2.0 * np.pi))


def unexplained_force(fit: JointFit, index: int, channel: int, parameters: ParameterSet) -> Array:
    """Residual force of one channel, (n,) [N, or N m]; of a pull the difference of the force itself.

    Parameters
    ----------
    fit : JointFit
    index, channel : int
    parameters : ParameterSet
        Of the session, for what is not fitted.
    """
    trial = fit.trials[index]
    rest = trial.colour(fit.simulated[index])[:, channel]
    if trial.channels == ("force",):
        return rest
    return force_of(rest, trial, channel, oscillator(fit, index, channel, parameters))


def force_of(rest: Array, trial: Trial, channel: int, found: Oscillator) -> Array:
    """−(m·r'' + d·r' + k·r) of a residual of any order, within the band."""
    order = ORDER.get(trial.channels[channel], 2)
    frequency = found.frequency() or main_frequency(trial.target[:, channel], trial.step, order)

    def operator(s: Array) -> Array:
        return -(found.mass * s**2 + found.damping * s + found.stiffness) / s**order

    # a position needs no lower limit: there the spring's part is the residual itself
    return filtered(
        rest, trial.step, operator, LOWEST * frequency if order else 0.0, highest(rest, trial, channel, frequency)
    )


def highest(rest: Array, trial: Trial, channel: int, frequency: float) -> float:
    """Up to where a residual stands out of its noise [Hz]: beyond, a force would be differentiated noise."""
    noise = trial.noises[channel]
    count = len(rest)
    places = np.fft.rfftfreq(count, trial.step)
    power = 2.0 * trial.step / count * np.abs(np.fft.rfft((rest - rest.mean()) * np.hanning(count))) ** 2 / 0.375
    width = max(3, round(0.5 * frequency * count * trial.step))
    smooth = np.convolve(power / noise.density(places, trial.step), np.ones(width) / width, "same")
    out = np.flatnonzero((smooth > STANDS_OUT) & (places < HIGHEST * frequency))
    return float(np.clip(places[out[-1]] if len(out) else 0.0, 1.5 * frequency, HIGHEST * frequency))


def oscillator(fit: JointFit, index: int, channel: int, parameters: ParameterSet) -> Oscillator:
    """The rig itself, or the oscillator of the robot's mass whose motion is nearest to what was simulated."""
    values, _ = fit.model.split(fit.point)
    for keys in RIG_KEYS.values():
        if all(key in parameters for key in keys):
            return Oscillator(*(float(values.get(key, parameters.number(key))) for key in keys))
    mass = values.get("mass_kg", parameters.number("mass_kg", 1.0))
    trial = fit.trials[index]
    signal = fit.simulated[index][:, channel]
    order = ORDER.get(trial.channels[channel], 2)
    frequency = main_frequency(signal, trial.step, order)
    x, v, a = (integrated(signal, trial.step, order - k, frequency) for k in range(3))
    inner = slice(len(x) // 20, -len(x) // 20)
    # x'' = -(k/m) x - (d/m) x' by least squares
    stiffness, damping = np.linalg.lstsq(np.column_stack([x, v])[inner], -a[inner], rcond=None)[0]
    return Oscillator(mass, mass * float(damping), mass * float(stiffness))
