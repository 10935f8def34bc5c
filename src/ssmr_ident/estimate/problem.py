"""From measurements and what is known of a rig to one inverse problem: its scales, priors and first noise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.motor import course_of, drive_coordinates
from ssmr_ident.estimate.noise import first_white
from ssmr_ident.estimate.pieces import ORDER, Piece, channels_of, fastest_part, pieces_of
from ssmr_ident.estimate.values import Problem
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.physics.rig import RIG_KEYS
from ssmr_ident.physics.voltage_drive import VoltageDrive, drive_from_parameters
from ssmr_ident.signals.band import inside
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.signals.noise import AutoregressiveNoise

Array = np.ndarray

BANDWIDTH = "accelerometer.bandwidth_hz"

VAGUE = 1.0
"""Standard deviation of the logarithm of a mass or stiffness of which the file says no uncertainty."""

VAGUE_DAMPING = 3.0
"""The same of a damping, in critical ones over two."""

FAR = 3.0
"""Factor between the file's natural frequency and the motion's from which the motion is believed."""


SHARPEST = 10.0
"""Times the frequency of the motion up to which the force is followed where no spring holds the mass: friction turns
as fast as the force does."""


def problem_of(
    measurements: Sequence[Measurement], parameters: ParameterSet, as_fast: Problem | None = None
) -> Problem:
    """Prepare recordings of a rig.

    Parameters
    ----------
    measurements : sequence of Measurement
    parameters : ParameterSet
        Mass, damping, stiffness, as known.
    as_fast : Problem, optional
        Other recordings, up to whose fastest motion these are followed; else up to their own.
    """
    frequency = natural_hz(parameters)
    seen = [seen_hz(m) for m in measurements]
    moving = float(np.median(seen))
    if not 1.0 / FAR < frequency / moving < FAR:
        frequency = moving
    bandwidth = known_bandwidth(measurements, parameters)
    fastest = max(frequency, moving)
    if not natural_hz(parameters):
        fastest = max(fastest, *(min(drive_hz(m), SHARPEST * moving) for m in measurements))
    motor = drive_from_parameters(parameters)
    if motor is not None:
        fastest = max(fastest, *(in_the_loop_hz(m, parameters, motor) for m in measurements))
    if as_fast is not None:
        frequency, fastest = as_fast.frequency, as_fast.fastest
    problem = made(measurements, (), (), frequency, fastest, bandwidth, motor is not None)
    driven = any(p.driven and not p.based for p in problem.pieces)
    baseline = (*baseline_of(parameters, driven, problem.size, frequency), *drive_coordinates(parameters))
    return replace(problem, baseline=baseline)


def in_the_loop_hz(measurement: Measurement, parameters: ParameterSet, motor: VoltageDrive) -> float:
    """Natural frequency of a rig that its controller holds, beside its own spring."""
    mass, _, stiffness = RIG_KEYS["inertia_kg_m2" in parameters]
    course = course_of(measurement)
    held = motor.gain * course.controller.gain if course is not None and course.controller is not None else 0.0
    stiff = max(float(parameters[stiffness].value), 0.0) + held
    return math.sqrt(stiff / (float(parameters[mass].value) + motor.inertia)) / (2.0 * math.pi)


def known_bandwidth(measurements: Sequence[Measurement], parameters: ParameterSet) -> float:
    """Of the accelerometers [Hz]; infinite where it is beyond what was logged."""
    bandwidth = parameters.number(BANDWIDTH, math.inf)
    if bandwidth >= 0.5 * min(m.recording.sample_rate for m in measurements):
        return math.inf  # cancels with the low-pass of the force's own converter
    return bandwidth


def made(
    measurements: Sequence[Measurement], bodies: Sequence[str], baseline: tuple[Coordinate, ...], frequency: float,
    fastest: float, bandwidth: float, motor: bool = False,
) -> Problem:  # fmt: skip
    """The problem of recordings of a rig, or of a network of given bodies; frequencies in Hz."""
    pieces = first_white(
        [p for i, m in enumerate(measurements) for p in pieces_of(m, i, fastest, bandwidth, bodies, motor)]
    )
    size = float(np.sqrt(np.mean([_size(p, frequency) ** 2 for p in pieces])))
    if not size:
        raise InputError(
            ", ".join(m.name for m in measurements),
            "nothing moves but single samples, which stand out as no motion does",
            "Look whether the sensor was connected, or map another column by channels:",
        )
    noises = tuple(tuple(AutoregressiveNoise(np.ones(1), float(white)) for white in p.white) for p in pieces)
    return Problem(pieces, baseline, noises, frequency, size, bandwidth, fastest)


def natural_hz(parameters: ParameterSet) -> float:
    """Of the file's mass and stiffness; 0 without a spring."""
    mass, _, stiffness = RIG_KEYS["inertia_kg_m2" in parameters]
    stiff = float(parameters[stiffness].value)
    return math.sqrt(max(stiff, 0.0) / float(parameters[mass].value)) / (2.0 * math.pi)


def baseline_of(parameters: ParameterSet, driven: bool, size: float, frequency: float) -> tuple[Coordinate, ...]:
    """Mass, damping and stiffness with their priors. Without a measured force the mass only scales, and stays."""
    keys = RIG_KEYS["inertia_kg_m2" in parameters]
    mass, damping, stiffness = (parameters[key] for key in keys)
    m = float(mass.value)
    omega = 2.0 * math.pi * frequency
    spread = (mass.std / m if mass.std else VAGUE) if driven and not mass.fixed else 0.0
    found = [Coordinate(keys[0], m, True, 0.05 * m, 20.0 * m, 0.0, spread or 1e-9, mass.unit)]
    unit, value = m * omega, float(damping.value)
    known = damping.std / unit if damping.std else VAGUE_DAMPING
    known = 1e-9 if damping.fixed else known
    found.append(Coordinate(keys[1], unit, False, 0.0, 50.0 * unit, value / unit, known, damping.unit))
    k = float(stiffness.value)
    if k <= 0.0:
        found.append(Coordinate(keys[2], m * omega**2, False, 0.0, math.inf, 0.0, 1e-9, stiffness.unit))
        return tuple(found)
    own = stiffness.std / k if stiffness.std else VAGUE
    own = 1e-9 if stiffness.fixed else own
    found.append(Coordinate(keys[2], k, True, 0.01 * k, 100.0 * k, 0.0, own, stiffness.unit))
    return tuple(found)


def seen_hz(measurement: Measurement) -> float:
    """Frequency of the deflection, from the loudest motion's spectrum, in acceleration divided by its square."""
    channels, drive = channels_of(measurement.recording)
    name = channels[0]
    even = even_samples(measurement.recording.time, measurement.recording[name][:, None])
    y = even.samples[:, 0] - even.samples[:, 0].mean()
    if measurement.entry.band_hz is not None:
        y = inside(y, even.sample_rate, measurement.entry.band_hz)
    frequency = np.fft.rfftfreq(len(y), 1.0 / even.sample_rate)
    power = np.abs(np.fft.rfft(y * np.hanning(len(y)))) ** 2
    low = 3.0 / (len(y) / even.sample_rate)
    # what noise has at every frequency would win once it is weighed by its square
    weight = np.where((frequency >= low) & (power > 0.01 * power.max()), power - np.median(power), 0.0)
    if ORDER[name] and drive:
        weight = weight / np.maximum(frequency, low) ** (2 * ORDER[name])
    if weight.sum() <= 0.0:
        return float(frequency[int(np.argmax(power[1:])) + 1])
    return float(np.interp(0.5, np.cumsum(weight) / weight.sum(), frequency))


def drive_hz(measurement: Measurement) -> float:
    """Fastest part of the force on a mass that no spring holds, which has no frequency of its own; 0 without a force.

    A jump of friction lasts as long as the force takes to turn the motion.
    """
    _, drive = channels_of(measurement.recording)
    return fastest_part(measurement.recording[drive], measurement.recording.sample_rate) if drive else 0.0


def _size(piece: Piece, frequency: float) -> float:
    """RMS deflection, from whatever was measured."""
    order = int(piece.orders[0])
    return float(piece.y[:, 0].std()) / (2.0 * math.pi * frequency) ** order
