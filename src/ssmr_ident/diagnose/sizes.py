"""How large the motions, forces and times of a session are: the units in which effects are looked for."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.trials import Trial
from ssmr_ident.identify.trials.trial import Array
from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.effects.sensor_saturation import ACCELERATIONS

_SHOWS = {"position": 0, "angle": 0, "velocity": 1, "angular_rate": 1}


def sizes_of(fit: JointFit) -> dict[str, float]:
    """Natural sizes by name, SI, as ``physics.effect.Sized`` asks for them.

    A motion of angular frequency ω and acceleration a goes as far as a/ω². ω is the root mean square of the fitted
    motion's slope over that of its own; of what was measured it is the noise's. A pull deflects
    the tires until its largest force.
    """
    values, _ = fit.model.split(fit.point)
    moving = any(trial.channels != ("force",) for trial in fit.trials)
    known = {**fit.trials[0].facts, **values}
    mass, height = _mass(known), known.get("height_m", math.nan)
    duration = max(float(trial.times[-1] - trial.times[0]) for trial in fit.trials)
    loads = [(float(np.ptp(trial.target)), trial) for trial in fit.trials if trial.channels == ("force",)]
    load = max((force for force, _ in loads), default=math.nan)
    rises = [force / t.facts["travel_m"] for force, t in loads if not t.experiment.vertical]
    stiffness = _stiffness(values)
    if moving:
        largest, omega, far = 0.0, 0.0, []
        for trial, simulated in zip(fit.trials, fit.simulated, strict=True):
            if trial.channels == ("force",):
                continue
            acceleration, rate, axis = _swing(trial, simulated)
            far.append((acceleration / rate**2, values.get(f"tire.stiffness_{axis}_N_m") or stiffness))
            if acceleration > largest:
                largest, omega = acceleration, rate
        deflection = largest / omega**2
        stiffness = stiffness or mass * omega**2
        speed, time = deflection * omega, 1.0 / omega
        # where a spring that changes with deflection has changed most
        reach, slope = min(((d, k or stiffness) for d, k in far), key=lambda one: one[1] / one[0] ** 2)
    else:
        largest = math.nan
        wheels = 4.0 if any(t.experiment.drags_everything for t in fit.trials) else 1.0
        stiffness = stiffness or load / max(max(t.facts["travel_m"] for t in fit.trials), 1e-12)
        deflection = load / (wheels * stiffness)
        speed = max(t.facts["travel_m"] / float(t.times[-1] - t.times[0]) for t in fit.trials)
        time = deflection / speed
        slopes = [_along(trial, values) or stiffness for trial in fit.trials]
        reach, slope = max((float(np.ptp(t.target)) / (wheels * k), k) for t, k in zip(fit.trials, slopes, strict=True))
    weight, beyond = _gravity(fit)
    return {
        "mass": mass,
        "height": height,
        "swing": math.sqrt(mass / ((1.0 if math.isnan(height) else 4.0) * stiffness)),
        "weight": weight,
        "beyond_weight": beyond,
        "reading": largest if math.isnan(weight) else math.nan,
        "level_reading": math.nan if math.isnan(weight) else _level(fit),
        "deflection": deflection,
        "stiffness": stiffness,
        "force": stiffness * deflection,
        "time": time,
        "speed": speed,
        "duration": duration,
        "acceleration": largest,
        "load": load,
        "rise": max(rises, default=math.nan),
        "reach": reach,
        "slope": slope,
    }


def limits_of(fit: JointFit, effect: Effect) -> dict[str, tuple[float, float]]:
    """Between which values a fit of an effect stays in this session, SI, by parameter; none where a size is
    not known."""
    sizes = sizes_of(fit) if effect.limits else {}
    found = {name: (low.value(sizes), high.value(sizes)) for name, (low, high) in effect.limits.items()}
    return {name: ends for name, ends in found.items() if not np.isnan(ends).any()}


def _swing(trial: Trial, simulated: Array) -> tuple[float, float, str]:
    """Largest acceleration, angular frequency and last letter of the channel that moves most."""
    signal = trial.target - trial.target.mean(axis=0)
    column = int(np.argmax(signal.std(axis=0)))
    own = simulated[:, column]
    if not np.std(own) > 0.0:
        own = signal[:, column]
    rate = float(np.std(np.diff(own)) / np.std(own) / trial.step)
    order = _SHOWS.get(trial.channels[column], 2)
    return float(np.max(np.abs(signal[:, column]))) * rate ** (2 - order), rate, trial.channels[column][-1]


def _gravity(fit: JointFit) -> tuple[float, float]:
    """What the axis that reads most reads at rest [m/s^2], and how far it is seen to go beyond; NaN where that is more
    than the rest, and no gravity."""
    largest = (math.nan, math.nan)
    for trial, simulated in zip(fit.trials, fit.simulated, strict=True):
        for column, name in enumerate(trial.channels):
            rest = float(np.mean(simulated[:, column]))
            swing = float(np.max(math.copysign(1.0, rest) * (trial.target[:, column] - trial.target[:, column].mean())))
            if name in ACCELERATIONS and abs(rest) > swing and not swing <= largest[1]:
                largest = abs(rest), swing
    return largest


def _level(fit: JointFit) -> float:
    """The most that an axis reads which carries no gravity [m/s^2]; NaN where there is none."""
    largest = math.nan
    for trial, simulated in zip(fit.trials, fit.simulated, strict=True):
        for column, name in enumerate(trial.channels):
            reads = float(np.max(np.abs(trial.target[:, column])))
            carries = abs(float(np.mean(simulated[:, column]))) > float(np.std(trial.target[:, column]))
            if name in ACCELERATIONS and not carries and not reads <= largest:
                largest = reads
    return largest


def _along(trial: Trial, values: Mapping[str, float]) -> float:
    """Stiffness of what a force log deflects [N/m], 0 where the file does not say."""
    axis = "z" if trial.experiment.vertical else "x" if trial.kind == "longitudinal" else "y"
    return values.get(f"tire.stiffness_{axis}_N_m") or _stiffness(values)


def _stiffness(values: Mapping[str, float]) -> float:
    for key in ("tire.stiffness_y_N_m", "stiffness_N_m", "stiffness_N_m_rad", "cable.stiffness_N_m"):
        if values.get(key, 0.0) > 0.0:
            return values[key]
    return 0.0


def _mass(values: Mapping[str, float]) -> float:
    return values.get("mass_kg") or values.get("inertia_kg_m2") or math.nan
