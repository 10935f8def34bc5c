"""From a parameter file and an experiment to a log."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.rig import rig_from_parameters
from ssmr_ident.physics.robot import accelerometer_from_parameters, robot_from_parameters
from ssmr_ident.physics.sensor import Noise
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.readers import ReadOptions, read_one, writers
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import bench, scenarios
from ssmr_ident.simulate.rig import simulate_rig
from ssmr_ident.simulate.simulation import simulate

EXPERIMENTS = ("free_response", "pull", "swivel", "straight", "wheel_drag", "vertical_compression", "forced")
_CHOICES = {"motion": ("roll", "pitch", "yaw"), "direction": ("lateral", "longitudinal"), "cable": ("steel", "rope")}
_DURATION = {"free_response": 4.096, "swivel": 20.0, "straight": 10.0, "pull": 16.0, "wheel_drag": 16.0}


@dataclass(frozen=True)
class Request:
    """What to simulate, as the command line asks for it (units are in the names)."""

    experiment: str
    motion: str = "roll"
    amplitude_mm: float = 0.3
    push_N: float = 0.0
    direction: str = "lateral"
    speed_mm_s: float = 1.0
    height_m: float = 0.05
    wheels_gripping: str = "1,2,3,4"
    cable: str = "steel"
    wheel_rate_rad_s: float = 0.0
    free_normal: bool = True
    yaw_rate_deg_s: float = 45.0
    speed_m_s: float = 0.3
    force: str = ""
    duration_s: float | None = None
    rate_hz: float | None = None
    noise: bool = False
    seed: int = 0
    effects: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """Of the recording [s]."""
        return _DURATION.get(self.experiment, 4.0) if self.duration_s is None else self.duration_s

    @property
    def rate(self) -> float:
        """Samples per second [Hz]: the accelerometers' 1 kHz, the testing machine's 100 Hz."""
        slow = self.experiment in ("pull", "wheel_drag", "vertical_compression")
        return (100.0 if slow else 1000.0) if self.rate_hz is None else self.rate_hz


def simulate_to_file(params: str, request: Request, output: Path) -> Recording:
    """Simulate, add noise if asked for, and write the log; its ending decides the format.

    Raises
    ------
    InputError
        An unknown experiment, a missing parameter, an ending without a writer.
    """
    if request.experiment not in EXPERIMENTS:
        raise InputError("--experiment", f"is {request.experiment!r}", did_you_mean(request.experiment, EXPERIMENTS))
    for option, known in _CHOICES.items():
        value = getattr(request, option)
        if value not in known:
            raise InputError(f"--{option}", f"is {value!r}", did_you_mean(value, known))
    if request.duration <= 0 or request.rate <= 0 or request.duration * request.rate > 5e7:
        raise InputError("--duration-s, --rate-hz", f"ask for {request.duration * request.rate:g} samples")
    parameters = _with_effects(read_parameters(params), request.effects)
    recording = _run(parameters, request)
    if request.noise:
        recording = _noisy(recording, parameters, request.seed)
    _write(output, recording, parameters)
    return recording


def _with_effects(parameters: ParameterSet, wanted: tuple[str, ...]) -> ParameterSet:
    """Effects as the command line names them, ``ID`` or ``ID:KEY=VALUE,…``, beside those of the file."""
    effects = dict(parameters.effects)
    for text in wanted:
        effect_id, _, pairs = text.partition(":")
        given: dict[str, Estimate] = {}
        for pair in pairs.split(",") if pairs else ():
            key, _, value = (part.strip() for part in pair.partition("="))
            try:
                given[key] = Estimate(float(value))
            except ValueError:
                raise InputError("--effect", f"{pair!r} is no KEY=VALUE", "Such as dry_friction:F_c_N=2") from None
        effects[effect_id] = given
    return replace(parameters, effects=effects)


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
    if request.experiment == "forced":
        return _forced(parameters, request)
    robot, effects = robot_from_parameters(parameters), effect_values(parameters)
    if request.experiment in ("wheel_drag", "vertical_compression"):
        time = np.arange(round(request.duration * request.rate)) / request.rate
        head = request.speed_mm_s * 1e-3 * time
        if request.experiment == "wheel_drag":
            force = bench.drag_wheel(robot, head, 1.0 / request.rate, request.free_normal, effects)
        else:
            force = bench.compress_wheel(robot, head, 1.0 / request.rate, effects=effects)
        return _recording(time, request.experiment, position=(head, "m"), force=(force, "N"))
    if request.experiment == "pull":
        scenario = scenarios.pull(
            request.direction,
            request.speed_mm_s,
            request.duration,
            request.cable,
            height=request.height_m,
            wheels_gripping=_wheels(request.wheels_gripping),
            wheel_rates=np.full((1, 2), request.wheel_rate_rad_s),
            held=scenarios.fixture_needed(_wheels(request.wheels_gripping), request.wheel_rate_rad_s),
        )
        result = simulate(robot, scenario, request.rate, effects=effects)
        return _recording(result.time, "pull", position=(result["head"], "m"), force=(result["force"], "N"))
    if request.experiment == "free_response":
        if request.push_N:
            scenario = scenarios.released(robot, request.motion, request.push_N, request.duration)
        else:
            scenario = scenarios.free_response(request.motion, request.amplitude_mm * 1e-3, request.duration)
    elif request.experiment == "swivel":
        rates = wheel_rates(robot, 0.0, float(np.deg2rad(request.yaw_rate_deg_s)))
        scenario = scenarios.swivel(rates, request.duration)
    else:
        scenario = scenarios.straight(wheel_rates(robot, request.speed_m_s, 0.0), request.duration)
    return simulate(robot, scenario, request.rate, effects=effects).recording("ax", "ay", "az")


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
        "forced",
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


def _wheels(text: str) -> tuple[int, ...]:
    try:
        wheels = tuple(sorted({int(part) for part in text.split(",") if part.strip()}))
    except ValueError:
        wheels = (0,)
    if not set(wheels) <= {1, 2, 3, 4}:
        raise InputError("--wheels-gripping", f"is {text!r}, expected numbers out of 1, 2, 3, 4", "Such as 1,2")
    return wheels
