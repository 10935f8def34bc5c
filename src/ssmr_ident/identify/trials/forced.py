"""A rig under a measured force, or let go, as a trial: start, zero of the force and gain of a second sensor vary.

A sensor's zero drifts within its sheet; what moves steadily through a recording says nothing of a spring, and would be
taken for one that is stiffer to one side. The path of a mass that nothing holds may itself go on and on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.estimate.foot import foot_motion
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.experiment import BASES
from ssmr_ident.experiments.quantities import UNITS
from ssmr_ident.identify.trials.trial import Array, Course, Trial, Values
from ssmr_ident.physics.rig import RIG_KEYS, Rig, rig_from_parameters
from ssmr_ident.physics.slots import Effects
from ssmr_ident.session.entry import MOTIONS
from ssmr_ident.signals.grid import band_limited, even_samples
from ssmr_ident.signals.metrics import LOW_PASS_HZ
from ssmr_ident.signals.noise import AutoregressiveNoise, rounding, white_noise
from ssmr_ident.simulate.rig import simulate_rig

COLUMN = {"position": 0, "angle": 0, "velocity": 1, "angular_rate": 1, "acceleration": 2, "acceleration_2": 2}
INPUTS = ("force", "torque")

LOWEST_RATE_HZ, RATE_PER_FREQUENCY = 250.0, 12.0
"""Block averages keep at least this rate, and this many blocks in a period of the rig."""

UNHELD_RATE_HZ = 50.0
"""Rate at which the path of a mass without a spring is compared: slow enough that its encoder's steps average out."""

OVERSAMPLING = 4
"""Of the force, for what is compared and drawn."""

FINE, ROUGH = 100.0, 40.0
"""Integration steps in a period of the rig: in fits of whole recordings, and of their beginnings. The rig itself is
propagated exactly; effects kick it with an error of (2 pi / steps)^2 / 24."""

FEWEST = 64
"""Blocks that even the shortest part of a recording keeps."""

BANDWIDTH = "accelerometer.bandwidth_hz"

FREQUENCY_REACH = 0.5
"""Share by which a rig's natural frequency may lie above the file's and still be sampled well."""


@dataclass(frozen=True)
class RigBuilder:
    """From values to a rig."""

    nominal: Rig

    @staticmethod
    def of(parameters: ParameterSet) -> RigBuilder:
        return RigBuilder(rig_from_parameters(parameters))

    def __call__(self, values: Values) -> Rig:
        rig = self.nominal
        mass, damping, stiffness = (
            values.get(key, default)
            for key, default in zip(RIG_KEYS[rig.rotary], (rig.mass, rig.damping, rig.stiffness), strict=True)
        )
        return Rig(mass, damping, stiffness, rig.rotary)


def forced_trial(measurement: Measurement, parameters: ParameterSet) -> Trial:
    """Prepare a rig's recording.

    Parameters
    ----------
    measurement : Measurement
        With a motion, and a force or torque unless it swings freely.
    parameters : ParameterSet

    Raises
    ------
    InputError
        No motion, or one that does not change.
    """
    builder = RigBuilder.of(parameters)
    rig, recording = builder.nominal, measurement.recording
    outputs = tuple(name for name in (*MOTIONS, "acceleration_2") if name in recording and np.ptp(recording[name]) > 0)
    on_a_base = measurement.experiment.on_a_base
    inputs = BASES[::-1] if on_a_base else INPUTS  # a position can be differentiated, an acceleration drifts
    drive = next((name for name in inputs if name in recording), None)
    if not outputs:
        where, found = recording.provenance.file, ", ".join(recording.names)
        raise InputError(where, f"needs a motion that changes; found {found}", "Map the columns by channels:")
    wanted = (*outputs, drive) if drive else outputs
    even = even_samples(recording.time, np.column_stack([recording[name] for name in wanted]))
    measured, rate = even.samples[:, : len(outputs)], even.sample_rate
    force = even.samples[:, -1] if drive else np.zeros(len(measured))
    motions = {name: COLUMN[name] for name in outputs}
    foot = foot_motion(force, str(drive), motions, rate, recording.provenance.file) if on_a_base else None
    if foot is not None:
        force = foot[:, 2]
    bandwidth = parameters.number(BANDWIDTH, math.inf)
    if bandwidth >= 0.5 * rate:
        # the force comes through a sensor and a converter of the same kind: what both delay alike cancels
        bandwidth = math.inf
    natural = math.sqrt(max(builder.nominal.stiffness, 0.0) / builder.nominal.mass) / (2.0 * math.pi)
    unheld = builder.nominal.stiffness == 0.0 and COLUMN[outputs[0]] == 0
    needed = UNHELD_RATE_HZ if unheld else max(LOWEST_RATE_HZ, RATE_PER_FREQUENCY * (1.0 + FREQUENCY_REACH) * natural)
    block = max(1, int(rate / needed))
    slow = math.isfinite(bandwidth)
    columns = [COLUMN[name] for name in outputs]
    second = outputs.index("acceleration_2") if "acceleration_2" in outputs and len(outputs) > 1 else None
    nuisances = ("start_position", "start_velocity", *(("force_zero",) if drive else ()))
    nuisances += ("gain_2",) if second is not None else ()
    scales = _scales(builder.nominal, measured, outputs, force, rate)[: 3 if drive else 2]
    scales = np.append(scales, 1.0) if second is not None else scales
    least = 8.0 * bandwidth / rate if slow else 1.0

    def finer(wanted: float, samples: int) -> tuple[int, Array]:
        factor = max(1, math.ceil(least), math.ceil(wanted))
        return factor, force[:samples] if factor == 1 else band_limited(force[:samples], factor)

    def motion(values: Values, effects: Effects, nuisance: Array, factor: int, fine: Array, samples: int) -> Array:
        state = nuisance * scales
        now = builder(values)
        driving = fine + state[2] if drive else fine
        try:
            run = simulate_rig(
                now,
                -now.mass * driving if on_a_base else driving,  # against its foot it moves as if pushed by its inertia
                rate,
                float(state[0]),
                float(state[1]),
                oversampling=factor,
                bandwidth_hz=values.get(BANDWIDTH, bandwidth) if slow else math.inf,
                effects=effects,
                fine=True,
            )[:, columns]
        except SimulationError:
            return np.full((samples, len(columns)), math.nan)
        if foot is not None:
            run += foot[: len(run), columns]
        if second is not None:
            run[:, second] *= state[-1]
        return run

    def assembled(count: int, steps_a_period: float) -> Trial:
        samples = count * block
        factor, fine = finer(steps_a_period * natural / rate, samples)

        def averaged(signal: Array) -> Array:
            result: Array = signal[:samples].reshape(count, block, -1).mean(axis=1)
            return result

        def run(values: Values, effects: Effects, nuisance: Array) -> Array:
            return averaged(motion(values, effects, nuisance, factor, fine, samples))

        def begin(values: Values, effects: Effects) -> Array:
            return linear_start(trial, lambda nuisance: run(values, {}, nuisance), second)

        target = averaged(measured)
        trial = Trial(
            measurement.name,
            measurement.experiment,
            "",
            outputs,
            even.start + (np.arange(count) + 0.5 * (block - 1) / block) * block / rate,
            target,
            tuple(
                _noise(target[:, c], unheld and COLUMN[name] == 0, rounding(measured[:, c]) / math.sqrt(block))
                for c, name in enumerate(outputs)
            ),
            np.vander(np.linspace(-1.0, 1.0, count), 1 if unheld else 2, increasing=True),
            run,
            begin,
            nuisances,
            scales,
            course,
            facts=dict(zip(RIG_KEYS[rig.rotary], (rig.mass, rig.damping, rig.stiffness), strict=True)),
            shorten=lambda seconds: assembled(max(FEWEST, min(whole, round(seconds * rate / block))), ROUGH),
        )
        return trial

    everything = finer(OVERSAMPLING, len(measured))
    course = Course(
        even.time,
        measured,
        lambda values, effects, nuisance: motion(values, effects, nuisance, *everything, len(measured)),
        tuple(UNITS[name] for name in outputs),
        LOW_PASS_HZ,
    )
    whole = len(measured) // block
    return assembled(whole, FINE)


def _noise(samples: Array, unheld: bool, least: float) -> AutoregressiveNoise:
    """White, or where nothing holds the mass white in its second difference: a small error of force carries a free mass
    away for good, so its path is compared by its curvature."""
    bend = np.array([1.0, -2.0, 1.0]) if unheld else np.ones(1)
    least *= float(np.linalg.norm(bend))
    return white_noise(samples, least, bend)


def linear_start(trial: Trial, run: Callable[[Array], Array], second: int | None = None) -> Array:
    """Nuisances that enter linearly, by least squares with their priors."""
    size = len(trial.scales)
    base = np.zeros(size)
    if second is not None:
        base[-1] = 1.0
    centre = run(base)
    columns = []
    for index in range(size - (second is not None)):
        moved = base.copy()
        moved[index] += 1.0
        columns.append(run(moved) - centre)
    design = trial.whitened(np.stack(columns, axis=-1))
    # a channel in metres and one in m/s^2 count by their own noise, which differences of samples only guess at
    rest = trial.white_target - trial.whitened(centre)
    weight = 1.0 / max(float(np.std(trial.white_target)), 1e-300)
    design, rest = design * weight, rest * weight
    found = np.linalg.solve(design.T @ design + 1e-6 * np.eye(design.shape[1]), design.T @ rest)
    base[: len(found)] += found
    return base


def _scales(rig: Rig, measured: Array, outputs: tuple[str, ...], force: Array, rate: float) -> Array:
    """Prior standard deviations of start and force zero: the size of the recorded motion and force themselves."""
    omega = math.sqrt(rig.stiffness / rig.mass) if rig.stiffness > 0 else 2.0 * math.pi / (len(measured) / rate)
    column = COLUMN[outputs[0]]
    size = float(np.std(measured[:, 0])) + abs(float(measured[0, 0])) * (column == 0)
    position = size / omega**column
    zero = max(float(np.std(force)), 1e-12)
    return np.array([2.0 * position, 2.0 * position * omega, zero])
