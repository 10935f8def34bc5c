"""From a parameter file and an experiment to a log."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.physics.robot import accelerometer_from_parameters
from ssmr_ident.physics.sensor import Noise
from ssmr_ident.readers import writers
from ssmr_ident.session import read_parameters
from ssmr_ident.workflows.simulate.request import Request, asked_for, check
from ssmr_ident.workflows.simulate.table import simulated

ENDINGS = (".csv", ".txt", ".lvm", ".xlsx")


def simulate_to_file(params: str, request: Request, output: Path) -> Recording:
    """Simulate, add noise if asked for, and write the log; its ending decides the format.

    Raises
    ------
    InputError
        A missing parameter, an ending without a writer.
    """
    check(request)
    if output.suffix.lower() not in ENDINGS:
        raise _no_writer(output, "a simulated log")
    parameters = asked_for(read_parameters(params), request)
    recording = simulated(parameters, request)
    if request.noise:
        recording = _noisy(recording, parameters, request.seed)
    _write(output, recording, parameters)
    return recording


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
        raise _no_writer(output, ", ".join(recording.names))


def _no_writer(output: Path, what: str) -> InputError:
    return InputError(
        str(output),
        f"no writer for {output.suffix or 'a name without ending'} with {what}",
        "Accelerations go to .csv, .lvm or .xlsx, forces to .csv or .txt",
    )


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
