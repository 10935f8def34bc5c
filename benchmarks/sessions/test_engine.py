"""Verdicts on rigs that an integrator of their own made: what is said depends on the law, and on nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from integrated_rigs import LEVELS, NOISE, RATE, SECONDS, rig
from scipy.signal import lfilter

from ssmr_ident.workflows.diagnose import diagnose


def test_what_may_be_noise_of_another_colour_is_said_beside_nothing():
    """Four fifths of the noise's variance are first-order noise of 19 ms, which the floor does not see."""
    session, rng, keep = rig(lambda x, v: 0.0 * x), np.random.default_rng(3), 0.9
    slow = [
        lfilter([2.0 * NOISE * np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(round(RATE * SECONDS)))
        for _ in LEVELS
    ]
    measurements = []
    for measurement, noise in zip(session.measurements, slow, strict=True):
        force, position = measurement.recording.channels
        seen = replace(position, samples=position.samples + noise)
        measurements.append(replace(measurement, recording=replace(measurement.recording, channels=(force, seen))))
    found = diagnose(replace(session, measurements=tuple(measurements)))
    assert (found.verdict, found.effects) == ("nothing_missing", ())
    assert found.heldout.before > 3.0 * found.heldout.noise_floor
    assert any("noise of another colour" in note for note in found.notes)


def test_one_recording_that_nothing_explains_is_not_nothing():
    """A knock in the loudest of the recordings, whose mean stays within what noise of some colour reads."""
    session = rig(lambda x, v: 0.0 * x)
    *others, loudest = session.measurements
    force, position = loudest.recording.channels
    time = np.arange(len(position.samples)) / RATE
    knock = 60.0 * NOISE * np.exp(-0.5 * ((time - 0.6 * SECONDS) / 0.05) ** 2)
    shaken = replace(loudest.recording, channels=(force, replace(position, samples=position.samples + knock)))
    found = diagnose(replace(session, measurements=(*others, replace(loudest, recording=shaken))))
    assert (found.verdict, found.effects) == ("undetermined", ())
    assert loudest.name in found.summary
    assert "noise of no colour" in found.summary


def test_friction_of_another_formula_is_named_and_alone():
    found = diagnose(rig(lambda x, v: np.tanh(v / 1e-3)))
    assert [e.id for e in found.effects] == ["dry_friction"]
    assert float(found.effects[0].parameters["F_c_N"].value) == pytest.approx(1.0, rel=0.02)
    assert found.heldout.after < 1.1 * found.heldout.noise_floor < 0.1 * found.heldout.before


def test_a_law_that_no_list_holds_is_called_unlisted():
    found = diagnose(rig(lambda x, v: 30.0 * np.abs(v)))
    assert [e.id for e in found.effects] == ["unlisted"]
    assert list(found.effects[0].parameters) == ["c_abs_v_N_s_m"]
    assert float(found.effects[0].parameters["c_abs_v_N_s_m"].value) == pytest.approx(30.0, rel=0.02)


def test_hardening_with_quadratic_damping_is_named_as_the_two_that_it_is():
    found = diagnose(rig(lambda x, v: 4.6e8 * x**3 + 220.0 * v * np.abs(v)))
    assert {e.id for e in found.effects} == {"nonlinear_stiffness", "quadratic_damping"}
    sizes = {name: float(e.value) for effect in found.effects for name, e in effect.parameters.items()}
    assert sizes["k3_N_m3"] == pytest.approx(4.6e8, rel=0.03)
    assert sizes["d2_N_s2_m2"] == pytest.approx(220.0, rel=0.05)
    assert found.heldout.after < 1.2 * found.heldout.noise_floor


def test_a_range_that_only_the_end_of_one_run_reaches_is_named():
    session = rig(lambda x, v: 0.0 * x, limit=0.97)
    reached = np.abs(session.measurements[-1].recording["acceleration"])
    assert np.flatnonzero(reached > 0.96 * reached.max())[0] > 1.5 * RATE  # effects are tried on the first second alone
    found = diagnose(session)
    assert [e.id for e in found.effects] == ["sensor_saturation"]
    assert float(found.effects[0].parameters["range_m_s2"].value) == pytest.approx(reached.max(), rel=0.02)


def test_friction_is_found_under_a_sensor_that_was_taken_for_noise():
    found = diagnose(rig(lambda x, v: 4.0 * np.tanh(v / 1e-3), limit=1.0, sensor_hz=30.0))
    assert {e.id for e in found.effects} == {"dry_friction", "sensor_bandwidth"}
    sizes = {name: float(e.value) for effect in found.effects for name, e in effect.parameters.items()}
    assert sizes["F_c_N"] == pytest.approx(4.0, rel=0.05)
    assert sizes["bandwidth_hz"] == pytest.approx(30.0, rel=0.03)
