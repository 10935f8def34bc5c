"""Verdicts on rigs that an integrator of their own made: what is said depends on the law, and on nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import butter, lfilter, sosfilt

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose import engine
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.session import Entry, Session
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

RATE, SECONDS, LEVELS = 500.0, 6.0, (1.0, 3.0, 6.0)
MASS, DAMPING, STIFFNESS = 6.0, 40.0, 15000.0
NOISE = 2e-5
"""m; a third of a percent of the motion, as an encoder or a laser gives it. With ten times less, the error of splitting
and of the force between its samples shows beside the noise."""


def rig(law, seed: int = 7, limit: float | None = None, sensor_hz: float | None = None) -> Campaign:
    """Three shaken runs of m x'' + d x' + k x + law(x, v) = F by classical Runge-Kutta, ten steps a sample.

    Their position is logged, or their acceleration by a sensor that reads no more than ``limit`` of the largest, and is
    a second-order Butterworth of ``sensor_hz``.
    """
    rng = np.random.default_rng(seed)
    tones = np.linspace(2.0, 14.0, 40)[:, None]
    phases = rng.uniform(0.0, 2.0 * np.pi, (40, len(LEVELS)))
    step, count = 0.1 / RATE, int(RATE * SECONDS)
    halves = 0.5 * step * np.arange(20 * count + 1)
    force = np.stack(
        [a * np.cos(2 * np.pi * tones * halves + phases[:, [k]]).sum(axis=0) for k, a in enumerate(LEVELS)], axis=1
    )

    def rate(f, x, v):
        return (f - DAMPING * v - STIFFNESS * x - law(x, v)) / MASS

    x, v, path = np.zeros(len(LEVELS)), np.zeros(len(LEVELS)), []
    for n in range(10 * count):
        f0, f1, f2 = force[2 * n], force[2 * n + 1], force[2 * n + 2]
        a1 = rate(f0, x, v)
        path.append(x if limit is None else a1)
        v2 = v + 0.5 * step * a1
        a2 = rate(f1, x + 0.5 * step * v, v2)
        v3 = v + 0.5 * step * a2
        a3 = rate(f1, x + 0.5 * step * v2, v3)
        v4 = v + step * a3
        a4 = rate(f2, x + step * v3, v4)
        x = x + step / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    fine, noise, channel, unit = np.array(path), NOISE, "position", "m"
    if sensor_hz is not None:
        fine = sosfilt(butter(2, sensor_hz, fs=10.0 * RATE, output="sos"), fine, axis=0)
    seen = fine[::10]
    if limit is not None:
        noise, channel, unit = 3e-3 * float(np.std(seen)), "acceleration", "m/s^2"
        seen = np.clip(seen, -limit * seen.max(), limit * seen.max())
    seen = seen + noise * rng.standard_normal(seen.shape)
    time = np.arange(count) / RATE
    measurements = []
    for k in range(len(LEVELS)):
        channels = (Channel("force", force[::20, k][:count], "N"), Channel(channel, seen[:, k], unit))
        entry = Entry(f"run-{k}.csv", "forced")
        measurements.append(Measurement(entry, Recording(time, channels, Provenance("drawn", "", "test"))))
    known = ParameterSet(
        "rig",
        {
            "mass_kg": Estimate(6.05, 0.12, "kg"),
            "damping_N_s_m": Estimate(45.0, 15.0, "N s/m"),
            "stiffness_N_m": Estimate(14600.0, 1500.0, "N/m"),
        },
    )
    if sensor_hz is not None:
        known = known.updated({"accelerometer.bandwidth_hz": Estimate(200.0, 5.0, "Hz")})
    session = Session("drawn", Path(), "rig", "sdof", tuple(m.entry for m in measurements))
    return Campaign(session, known, tuple(measurements))


def test_nothing_is_missing_where_nothing_is():
    found = diagnose(rig(lambda x, v: 0.0 * x))
    assert (found.verdict, found.effects) == ("nothing_missing", ())
    assert found.heldout.before < 1.1 * found.heldout.noise_floor
    assert found.before["stiffness_N_m"].value == pytest.approx(STIFFNESS, rel=0.01)
    assert not any("colour" in note for note in found.notes)


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
    assert "colour reads in it" in found.summary


def test_friction_of_another_formula_is_named_and_alone():
    found = diagnose(rig(lambda x, v: np.tanh(v / 1e-3)))
    assert [e.id for e in found.effects] == ["dry_friction"]
    assert float(found.effects[0].parameters["F_c_N"].value) == pytest.approx(1.0, rel=0.02)
    assert found.heldout.after < 1.1 * found.heldout.noise_floor < 0.1 * found.heldout.before


def test_hardening_is_named_with_its_size():
    found = diagnose(rig(lambda x, v: 6e8 * x**3))
    assert [e.id for e in found.effects] == ["nonlinear_stiffness"]
    assert float(found.effects[0].parameters["k3_N_m3"].value) == pytest.approx(6e8, rel=0.02)
    assert found.heldout.after < 1.2 * found.heldout.noise_floor


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


def test_a_law_of_no_determined_size_gives_way_to_the_next(monkeypatch):
    asked, laws = [], []

    def determined(fit):
        laws.append(fit.model.ids)
        return len(laws) > 1

    def leading(chosen, new, choose=engine.leading):
        asked.append({e.id for e in new})
        return choose(chosen, new)

    monkeypatch.setattr(engine, "significant", determined)
    monkeypatch.setattr(engine, "leading", leading)
    diagnose(rig(lambda x, v: 4.6e8 * x**3 + 220.0 * v * np.abs(v)))
    assert len(asked[0]) > 1
    assert asked[1] == asked[0] - {"+".join(laws[0])}


@pytest.mark.parametrize(("moves", "searches"), [(engine.MOST_MOVES, 2), (0, 1)])
def test_a_baseline_that_an_effect_led_to_a_better_place_is_searched_again(monkeypatch, moves, searches):
    def displaced(trials, setup, parameters, best=engine.best_baseline):
        fit, lengths = best(trials, setup, parameters)
        return differentiate(evaluate(fit.trials, fit.model, fit.point + 0.02, fit.nuisances)), lengths

    monkeypatch.setattr(engine, "best_baseline", displaced)
    monkeypatch.setattr(engine, "MOST_MOVES", moves)
    # as an effect does that has taken the motion's place
    monkeypatch.setattr(engine, "significant", lambda fit: True)
    session = rig(lambda x, v: 0.0 * x)
    outcome = engine.examine(set_up(session, session.parameters), session.parameters)
    assert outcome.chosen is outcome.baseline
    assert outcome.baseline.fit.rss < 1.1 * outcome.baseline.fit.size
    assert len(outcome.searches) == searches
