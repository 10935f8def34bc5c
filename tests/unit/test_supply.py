"""An accelerometer's volts end where its supply does, which may be before its range."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.experiments.quantities import _from_volts
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.trials.decay import decay_trial
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.readers.health import at_rails, ends_of_supply
from ssmr_ident.session import Entry, read_parameters
from ssmr_ident.simulate import simulate

STEP = 5.0 / 2**12
ROBOT = robot_from_parameters(read_parameters("p3at-extended"))
SENSOR = ROBOT.accelerometer


@pytest.mark.parametrize(("highest", "ends"), [(5.0, True), (5.0 - STEP, True), (5.1, False), (4.0, True)])
def test_a_log_that_goes_beyond_the_supply_has_another(highest: float, ends: bool) -> None:
    volts = np.array([2.6, 0.4, highest])
    assert np.isfinite(ends_of_supply(volts)).all() == ends
    assert at_rails(Channel("az", volts, "V")) == (highest > 4.9)


@pytest.mark.parametrize("bits", [8, 10, 12, 16])
def test_the_last_code_of_any_converter_is_at_the_end(bits: int) -> None:
    step = 5.0 / 2**bits
    swing = 2.6 + 2.6 * np.sin(np.linspace(0.0, 6.0 * np.pi, 3000))
    volts = np.clip(np.round(swing / step), 0, 2**bits - 1) * step
    last, first = np.sum(volts == volts.max()), np.sum(volts == 0.0)
    assert last > 100
    low, high = ends_of_supply(volts)
    assert np.sum(volts >= high) == last if bits <= 12 else np.sum(volts >= high) >= last
    assert np.sum(volts <= low) >= first > 0
    assert at_rails(Channel("az", volts, "V")) >= last


def test_a_log_with_gaps_or_of_gaps_alone_has_the_sensors_supply() -> None:
    for volts in (np.array([2.6, np.nan, 3.1]), np.full(3, np.nan)):
        low, high = ends_of_supply(volts)
        assert 0.0 < low < 0.01
        assert 4.99 < high < 5.0 - STEP


@pytest.mark.parametrize("polarity", [1.0, -1.0])
def test_samples_at_the_end_of_the_supply_are_told_and_do_not_count(polarity: float) -> None:
    made = simulate(ROBOT, free_response("pitch", duration=2.0), 1000.0)
    noise = 0.01 * np.random.default_rng(8).standard_normal((2, len(made.time)))
    swing = {axis: made[axis] + own for axis, own in zip(("ax", "az"), noise, strict=True)}
    swing["az"] = 9.81 + 14.0 * (swing["az"] - 9.81) / np.abs(made["az"] - 9.81).max()
    top = (5.0 - STEP - SENSOR.volts_zero) / SENSOR.volts_per_m_s2
    clipped = int(np.count_nonzero(swing["az"] > top - 0.5 * STEP / SENSOR.volts_per_m_s2))
    assert clipped > 20
    volts = {
        axis: np.round(np.clip(SENSOR.volts_zero + SENSOR.volts_per_m_s2 * a, 0.0, 5.0 - STEP) / STEP) * STEP
        for axis, a in swing.items()
    }
    where = Provenance("p.csv", "", "x")
    entry = Entry("p.csv", "free_response", motion="pitch")
    raw = Recording(made.time, tuple(Channel(axis, v, "V") for axis, v in volts.items()), where)
    turned = robot_from_parameters(read_parameters("p3at-extended")).accelerometer
    turned.polarity[:] = polarity
    channels, notes = zip(*(_from_volts(c, raw, entry, turned) for c in raw.channels), strict=True)
    assert channels[1].rails[int(polarity > 0)] == pytest.approx(polarity * top, abs=0.01)
    assert notes[0].level == "info"
    assert (notes[1].level, notes[1].text.split(" samples")[0]) == ("warning", f"az: {clipped}")
    if polarity > 0:
        trial = decay_trial(Measurement(entry, Recording(made.time, channels, where)), RobotBuilder(ROBOT))
        assert trial.counts is not None
        block = trial.step * 1000.0
        assert 0.5 * clipped < trial.facts["clipped"] * block < 2.0 * clipped
