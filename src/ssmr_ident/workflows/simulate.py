"""From a parameter file and an experiment to a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from ssmr_ident.core.domain import Number
from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.nested_domain import declared
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.place import Place, shown
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments import EXPERIMENTS, Conditions, Experiment
from ssmr_ident.experiments.experiment import ACCELERATIONS
from ssmr_ident.physics.rig import rig_from_parameters
from ssmr_ident.physics.robot import Robot, accelerometer_from_parameters, robot_from_parameters
from ssmr_ident.physics.sensor import Noise
from ssmr_ident.physics.slots import Effects, effect_values
from ssmr_ident.readers import ReadOptions, read_one, writers
from ssmr_ident.session import read_parameters
from ssmr_ident.session.entry import RATE, WHEELS
from ssmr_ident.session.schema import CHOICES
from ssmr_ident.simulate.bench import load_wheel
from ssmr_ident.simulate.rig import simulate_rig
from ssmr_ident.simulate.simulation import Simulation, simulate


@dataclass(frozen=True)
class Request:
    """What to simulate, as the command line asks for it (units are in the names).

    Parameters
    ----------
    experiment : Experiment
    conditions : Conditions
    force : str
        Log with the force of a driven rig.
    duration_s, rate_hz : float or None
        None takes the experiment's own.
    noise : bool
        That of the parameter file.
    seed : int
    effects : tuple of str
        ``ID`` or ``ID:KEY=VALUE,…``, beside those of the file.
    contact : str or None
        Law of the contacts instead of the file's.
    """

    experiment: Experiment
    conditions: Conditions = field(default_factory=Conditions)
    force: str = ""
    duration_s: Annotated[float | None, Number("s", least=1e-6, most=1e6)] = None
    rate_hz: Annotated[float | None, RATE] = None
    noise: bool = False
    seed: int = 0
    effects: tuple[str, ...] = ()
    contact: Annotated[str | None, CHOICES["tire.contact"][0]] = None

    @property
    def duration(self) -> float:
        """Of the recording [s]."""
        return self.experiment.duration if self.duration_s is None else self.duration_s

    @property
    def rate(self) -> float:
        """Samples per second [Hz]."""
        return self.experiment.sample_rate if self.rate_hz is None else self.rate_hz


def simulate_to_file(params: str, request: Request, output: Path) -> Recording:
    """Simulate, add noise if asked for, and write the log; its ending decides the format.

    Raises
    ------
    InputError
        A missing parameter, an ending without a writer.
    """
    check(request)
    parameters = asked_for(read_parameters(params), request)
    recording = _run(parameters, request)
    if request.noise:
        recording = _noisy(recording, parameters, request.seed)
    _write(output, recording, parameters)
    return recording


def check(request: Request) -> None:
    """Whether a request can be met at all.

    Raises
    ------
    InputError
        A value out of its domain, or too many samples.
    """
    duration, rate = request.duration, request.rate
    options: tuple[tuple[object, type], ...] = ((request, Request), (request.conditions, Conditions))
    for asked, kind in options:
        for option, (domain, _) in declared(kind).items():
            value = getattr(asked, option)
            if value is not None:
                domain.check(Place(f"--{option.replace('_', '-')}"), value)
    if duration * rate > 5e7:
        raise InputError("--duration-s, --rate-hz", f"ask for {duration * rate:g} samples")


def asked_for(parameters: ParameterSet, request: Request) -> ParameterSet:
    """A file's parameters with the effects and the law of contacts that the command line names beside them."""
    choices = {"tire.contact": request.contact} if request.contact else parameters.choices
    effects = dict(parameters.effects)
    for text in request.effects:
        effect_id, _, pairs = text.partition(":")
        given: dict[str, Estimate] = {}
        for pair in pairs.split(",") if pairs else ():
            key, _, value = (part.strip() for part in pair.partition("="))
            try:
                given[key] = Estimate(float(value))
            except ValueError:
                problem = f"{shown(pair)} is no KEY=VALUE"
                raise InputError("--effect", problem, "Such as dry_friction:F_c_N=2") from None
        effects[effect_id] = given
    return replace(parameters, effects=effects, choices=choices)


def _write(output: Path, recording: Recording, parameters: ParameterSet) -> None:
    """Accelerations become volts in LabVIEW's formats, as the DAQ logs them; CSV keeps SI units."""
    suffix = output.suffix.lower()
    if suffix == ".csv":
        writers.write_csv(output, recording)
    elif suffix == ".txt" and "force" in recording and "position" in recording:
        writers.write_mtestquattro(output, recording)
    elif suffix in (".lvm", ".xlsx") and "ax" in recording:
        sensor = accelerometer_from_parameters(parameters)
        volts = [
            replace(recording.channel(name), samples=sensor.to_volts(recording[name], axis), unit="V", label=label)
            for axis, (name, label) in enumerate((("ax", "Voltage_0"), ("ay", "Voltage_1"), ("az", "Voltage_2")))
        ]
        write = writers.write_lvm if suffix == ".lvm" else writers.write_labview_xlsx
        write(output, recording.with_channels(volts))
    else:
        raise InputError(
            str(output),
            f"no writer for {suffix or 'a name without ending'} with {', '.join(recording.names)}",
            "Accelerations go to .csv, .lvm or .xlsx, forces to .csv or .txt",
        )


def _run(parameters: ParameterSet, request: Request) -> Recording:
    experiment, conditions = request.experiment, request.conditions
    if experiment.on_a_base:
        raise InputError("--experiment", f"{experiment.name} has no simulation of its own", "Drive the mass: forced")
    if experiment.driven:
        return _forced(parameters, request)
    robot, effects = robot_from_parameters(parameters), effect_values(parameters)
    if experiment.scenario is None:
        time = np.arange(round(request.duration * request.rate)) / request.rate
        head = conditions.speed_mm_s * 1e-3 * time
        force = load_wheel(robot, experiment, head, 1.0 / request.rate, conditions.free_normal, effects)
        return _recording(time, experiment.name, position=(head, "m"), force=(force, "N"))
    result = run_robot(robot, effects, request)
    if result.scenario.pulled:
        return _recording(result.time, experiment.name, position=(result["head"], "m"), force=(result["force"], "N"))
    return result.recording(*ACCELERATIONS)


def run_robot(
    robot: Robot, effects: Effects, request: Request, offset: Mapping[str, float] | None = None
) -> Simulation:
    """The whole robot in one of the experiments that are done with it, begun ``offset`` further away.

    N >= 0 (4.15) is part of the baseline here; in free responses it is the effect ``wheel_lift``, which decays tell.
    """
    experiment = request.experiment
    if experiment.scenario is None:
        raise InputError("--experiment", f"{experiment.name} is not done with a whole robot")
    if not experiment.free:
        effects = {"wheel_lift": {"active": 1.0}, **effects}
    scenario = experiment.scenario(robot, request.conditions, request.duration)
    if offset:
        scenario = replace(scenario, offset={**scenario.offset, **offset})
    return simulate(robot, scenario, request.rate, effects=effects)


def _forced(parameters: ParameterSet, request: Request) -> Recording:
    if not request.force:
        raise InputError("--force", "is missing", "Name a log with columns time and force")
    log = read_one(request.force, ReadOptions())
    if "force" not in log:
        raise InputError(request.force, f"has no force; found {', '.join(log.names)}", "Head the column 'force (N)'")
    bandwidth = parameters.number("accelerometer.bandwidth_hz", float("inf"))
    rig, effects = rig_from_parameters(parameters), effect_values(parameters)
    motion = simulate_rig(rig, log["force"], log.sample_rate, bandwidth_hz=bandwidth, effects=effects)
    position, velocity, acceleration = motion.T
    return _recording(
        log.time,
        request.experiment.name,
        force=(log["force"], "N"),
        position=(position, "m"),
        velocity=(velocity, "m/s"),
        acceleration=(acceleration, "m/s^2"),
    )


def _recording(time: np.ndarray, experiment: str, **channels: tuple[np.ndarray, str]) -> Recording:
    made = tuple(Channel(name, samples, unit, name) for name, (samples, unit) in channels.items())
    return Recording(time, made, Provenance(f"simulated {experiment}", "", "simulator"))


def _noisy(recording: Recording, parameters: ParameterSet, seed: int) -> Recording:
    """Accelerometers get the file's white noise and hum, load cells its load noise."""
    random = np.random.default_rng(seed)
    acceleration = Noise(parameters.number("noise.white_m_s2", 0.0), parameters.number("noise.hum_m_s2", 0.0))
    load = Noise(parameters.number("noise.load_N", 0.0))
    if not any(key.startswith("noise.") for key in parameters):
        raise InputError(parameters.file, "has no noise block", "Add noise: {white_m_s2: …} or leave --noise out")
    kinds = {"m/s^2": acceleration, "N": load}
    channels = [
        replace(c, samples=kinds[c.unit].add(c.samples, recording.time, random)) if c.unit in kinds else c
        for c in recording.channels
    ]
    return recording.with_channels(channels)


def experiment_of(name: str) -> Experiment:
    """The experiment that the command line names."""
    if name not in EXPERIMENTS:
        raise InputError("--experiment", f"is {name!r}", did_you_mean(name, EXPERIMENTS))
    return EXPERIMENTS[name]


def wheels_of(text: str) -> tuple[int, ...]:
    """Wheels as the command line names them.

    >>> wheels_of("2, 1")
    (1, 2)
    """
    parts = [part.strip() for part in text.split(",") if part.strip()]
    wheels = [int(part) if part in "1234" else part for part in parts]
    return tuple(sorted(WHEELS.check(Place("--wheels-gripping"), wheels)))
