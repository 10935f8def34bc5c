"""From what moved to what a lab logs: accelerometers in volts through a converter, a load cell in newtons."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments import PULL
from ssmr_ident.physics.sensor import Accelerometer, Noise, quantise
from ssmr_ident.simulate.simulation import Simulation

AXES = ("ax", "ay", "az")


@dataclass(frozen=True)
class Converter:
    """An analogue-to-digital converter.

    Parameters
    ----------
    low, high : float [V]
        What lies beyond is logged as these.
    bits : int
    """

    low: float = 0.0
    high: float = 5.0
    bits: int = 12

    @property
    def quantum(self) -> float:
        """Step between two codes [V].

        >>> Converter().quantum
        0.001220703125
        """
        return (self.high - self.low) / 2**self.bits

    def digitise(self, volts: np.ndarray) -> np.ndarray:
        """Volts as logged, (n,) float [V]: whole steps from ``low``, none above the last code."""
        last = self.high - self.quantum
        return self.low + quantise(np.clip(volts, self.low, last) - self.low, self.quantum)


def accelerometer_log(
    simulation: Simulation,
    accelerometer: Accelerometer,
    noise: Noise,
    random: np.random.Generator,
    converter: Converter | None = None,
) -> Recording:
    """The three accelerometers of a simulated run, in volts.

    The sensor clips the motion at its range; noise and mains come in behind it, on the way to the converter.

    Parameters
    ----------
    simulation : Simulation
        Its ``ax``, ``ay``, ``az`` are specific forces [m/s^2] behind the sensor's low-pass.
    accelerometer : Accelerometer
        Turns them into volts; polarity and range are its own.
    noise : Noise
        In m/s^2, one draw and one mains phase per axis. Its ``quantum`` [V] rounds the volts where no converter
        is given.
    random : numpy Generator
    converter : Converter, optional

    Returns
    -------
    Recording
        ``ax``, ``ay``, ``az`` [V], labelled Voltage_0 to Voltage_2.
    """
    silence = np.zeros(len(simulation.time))
    channels = []
    for axis, name in enumerate(AXES):
        disturbance = noise.add(silence, simulation.time, random)
        volts = accelerometer.to_volts(simulation[name], axis) + accelerometer.volts_per_m_s2 * disturbance
        volts = quantise(volts, noise.quantum) if converter is None else converter.digitise(volts)
        channels.append(Channel(name, volts, "V", f"Voltage_{axis}"))
    source = Provenance(f"simulated {simulation.scenario.experiment}", "", "simulator")
    return Recording(simulation.time, tuple(channels), source)


def load_cell_log(
    time: np.ndarray,
    position: np.ndarray,
    force: np.ndarray,
    noise: Noise,
    random: np.random.Generator,
    experiment: str = PULL.name,
) -> Recording:
    """A testing machine's log: travel of its head and load.

    Parameters
    ----------
    time : (n,) float [s]
    position : (n,) float [m]
        Of the head; the machine counts it by its screw, so it has no noise here.
    force : (n,) float [N]
    noise : Noise
        In N; ``quantum`` is the cell's resolution [N].
    random : numpy Generator
    experiment : str
        Named in the recording's provenance.

    Returns
    -------
    Recording
        ``position`` [m] and ``force`` [N].
    """
    load = quantise(noise.add(force, time, random), noise.quantum)
    channels = (Channel("position", position, "m", "Position"), Channel("force", load, "N", "Load"))
    return Recording(time, channels, Provenance(f"simulated {experiment}", "", "simulator"))
