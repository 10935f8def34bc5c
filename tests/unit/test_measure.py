"""From motion to log: volts, clipping, converter, mains and noise, each against what it must be."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.sensor import Accelerometer, Noise
from ssmr_ident.simulate.measure import AXES, Converter, accelerometer_log, load_cell_log
from ssmr_ident.simulate.simulation import Simulation

SAMPLES = 8000
TIME = np.arange(SAMPLES) / 1000.0
SENSOR = Accelerometer(polarity=np.array([1.0, -1.0, 1.0]))


def motion(ax: np.ndarray, ay: np.ndarray, az: np.ndarray) -> Simulation:
    """A simulation that holds nothing but three accelerations."""
    return Simulation(TIME, np.column_stack([ax, ay, az]), AXES, Scenario("swivel", 8.0), 1e-4)


def quiet(level: float = 0.0) -> np.ndarray:
    return np.full(SAMPLES, level)


def log(simulation: Simulation, noise: Noise | None = None, converter: Converter | None = None, seed: int = 1):
    return accelerometer_log(simulation, SENSOR, noise or Noise(), np.random.default_rng(seed), converter)


def test_volts_are_those_of_the_thesis_formula() -> None:
    wave = 5.0 * np.sin(2 * np.pi * 3.0 * TIME)
    recording = log(motion(wave, wave, wave + 9.8))
    assert [channel.unit for channel in recording.channels] == ["V"] * 3
    # a = 3.4 * 9.8 / 5 * (V - 2.6), thesis section 1; y is mounted upside down
    for name, sign, expected in zip(AXES, (1, -1, 1), (wave, wave, wave + 9.8), strict=True):
        np.testing.assert_allclose(sign * 3.4 * 9.8 / 5 * (recording[name] - 2.6), expected, atol=1e-12)


def test_motion_beyond_the_range_is_cut_off() -> None:
    recording = log(motion(quiet(30.0), quiet(30.0), quiet(-30.0)))
    volts = [recording[name][0] for name in AXES]
    assert volts == pytest.approx([2.6 + 2.5, 2.6 - 2.5, 2.6 - 2.5])  # ±1.7 g is ±2.5 V


def test_noise_rides_on_a_clipped_signal() -> None:
    recording = log(motion(quiet(30.0), quiet(), quiet()), Noise(white=0.1))
    assert np.std(recording["ax"]) == pytest.approx(0.1 * SENSOR.volts_per_m_s2, rel=0.05)


def test_noise_and_mains_have_the_sizes_asked_for() -> None:
    noise = Noise(white=0.02, hum=0.06)
    recording = log(motion(quiet(), quiet(), quiet()), noise, seed=5)
    phases = []
    for name in AXES:
        disturbance = (recording[name] - 2.6) / SENSOR.volts_per_m_s2
        # 480 whole periods of 60 Hz in 8 s: the line is one bin of the transform
        line = 2 * np.mean(disturbance * np.exp(-2j * np.pi * 60.0 * TIME))
        # standard deviation of a line's amplitude in white noise: white * sqrt(2 / n)
        assert abs(line) == pytest.approx(0.06, abs=5 * 0.02 * np.sqrt(2 / SAMPLES))
        rest = disturbance - np.real(line * np.exp(2j * np.pi * 60.0 * TIME))
        assert np.std(rest) == pytest.approx(0.02, rel=5 / np.sqrt(2 * SAMPLES))
        phases.append(np.angle(line))
    assert len(np.unique(np.round(phases, 2))) == 3  # each axis has its own phase


def test_axes_have_independent_noise() -> None:
    recording = log(motion(quiet(), quiet(), quiet()), Noise(white=1.0))
    correlation = np.corrcoef([recording[name] for name in AXES])
    assert np.abs(correlation - np.eye(3)).max() < 5 / np.sqrt(SAMPLES)


def test_same_seed_same_log_and_another_seed_another_log() -> None:
    simulation, noise = motion(quiet(), quiet(), quiet()), Noise(white=0.02, hum=0.06)
    first, again, other = (log(simulation, noise, Converter(), seed) for seed in (1, 1, 2))
    assert np.array_equal(first["ay"], again["ay"])
    assert not np.array_equal(first["ay"], other["ay"])


def test_converter_has_its_codes_and_no_others() -> None:
    converter = Converter(low=0.0, high=5.0, bits=12)
    volts = np.linspace(-1.0, 6.0, 30001)
    digital = converter.digitise(volts)
    codes = digital / converter.quantum
    np.testing.assert_array_equal(codes, np.round(codes))
    assert (codes.min(), codes.max(), len(np.unique(codes))) == (0, 4095, 4096)
    inside = (volts > 0.0) & (volts < converter.high - converter.quantum)
    assert np.abs(digital - volts)[inside].max() <= converter.quantum / 2 * (1 + 1e-9)


def test_rounding_adds_the_noise_of_a_twelfth_of_the_step_squared() -> None:
    converter = Converter(bits=6)
    ramp = np.linspace(-3.0, 3.0, SAMPLES)
    simulation = motion(ramp, ramp, ramp)
    fine, coarse = log(simulation), log(simulation, converter=converter)
    error = coarse["ax"] - fine["ax"]
    assert np.std(error) == pytest.approx(converter.quantum / np.sqrt(12), rel=0.05)


def test_load_cell_reads_the_force_with_its_noise_and_resolution() -> None:
    force, travel = 200.0 * TIME / TIME[-1], 1e-3 * TIME
    recording = load_cell_log(TIME, travel, force, Noise(white=0.3, quantum=1e-3), np.random.default_rng(3))
    assert [(c.name, c.unit) for c in recording.channels] == [("position", "m"), ("force", "N")]
    np.testing.assert_array_equal(recording["position"], travel)
    assert np.std(recording["force"] - force) == pytest.approx(0.3, rel=5 / np.sqrt(2 * SAMPLES))
    steps = recording["force"] / 1e-3
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)


def test_a_quantum_without_a_converter_rounds_the_volts() -> None:
    ramp = np.linspace(-3.0, 3.0, SAMPLES)
    steps = log(motion(ramp, ramp, ramp), Noise(quantum=0.01))["ay"] / 0.01
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
