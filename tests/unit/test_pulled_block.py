"""A block behind a drive: against an integrator that shares no code with it, and found again from its pulls."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.compare.prediction import predict
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.blocks.log import pulled_log
from ssmr_ident.identify.blocks.search import pulls_of
from ssmr_ident.identify.blocks.teeth import moments
from ssmr_ident.session import Entry, Session
from ssmr_ident.simulate.pulled_block import pull
from ssmr_ident.workflows.diagnose import diagnose
from ssmr_ident.workflows.fit.run import fit_campaign

MASS, WEIGHT = 5.0, 5.0 * 9.8
UNKNOWN = ParameterSet(
    "block",
    {
        "mass_kg": Estimate(MASS, 0.01, "kg"),
        "mu_static": Estimate(0.4, None, "1"),
        "mu_kinetic": Estimate(0.4, None, "1"),
        "cable.stiffness_N_m": Estimate(np.inf, None, "N/m"),
    },
)


def pulled(
    stiffness: float = 2500.0,
    ratio: float = 0.02,
    static: float = 0.5,
    kinetic: float = 0.35,
    speeds: tuple[float, ...] = (1.0, 2.0, 5.0),
    wander: float = 0.0,
    known: ParameterSet = UNKNOWN,
) -> Campaign:
    """Pulls at some speeds [mm/s], a second of rest before; tops scatter, friction may wander by a share."""
    random = np.random.default_rng(8)
    made = []
    for speed in speeds:
        time = np.arange(round(min(40.0 / speed, 30.0) * 100.0)) / 100.0
        head = 1e-3 * speed * np.maximum(time - 1.0 - 0.3 * random.random(), 0.0)
        way = np.interp(head, np.linspace(0.0, head[-1], 5), wander * random.standard_normal(5))
        level = kinetic * WEIGHT * (1.0 + way)
        damping = 2.0 * ratio * np.sqrt(stiffness * MASS)
        clean = pull(MASS, stiffness, damping, level, (static - kinetic) * WEIGHT, head, 0.01)[0]
        force = clean + 0.3 * random.standard_normal(len(time)) + random.normal(0.0, 0.2)
        entry = Entry(f"pull-{speed:g}.csv", "wheel_drag", speed_mm_s=speed)
        channel = Channel("force", force, "N")
        made.append(Measurement(entry, Recording(time, (channel,), Provenance(entry.file, "", "test"))))
    return Campaign(Session("block", Path(), "block", "drag", tuple(m.entry for m in made)), known, tuple(made))


def test_teeth_are_those_of_small_steps() -> None:
    """Explicit steps of two microseconds, written anew."""
    stiffness, damping, speed, step = 2500.0, 20.0, 0.02, 0.002
    head = speed * np.maximum(np.arange(400) * step - 0.1, 0.0)
    force, tops = pull(MASS, stiffness, damping, np.full(400, 0.35 * WEIGHT), 0.15 * WEIGHT, head, step)
    x, v, sticks, small, fine = 0.0, 0.0, True, [], 1000
    for n in range(400 * fine):
        along = n * step / fine - 0.1
        tension = stiffness * (speed * max(along, 0.0) - x) + damping * (speed * (along >= 0.0) - v)
        if n % fine == 0:
            small.append(tension)
        if sticks and tension > 0.5 * WEIGHT:
            sticks = False
        if not sticks:
            v += step / fine * (tension - 0.35 * WEIGHT) / MASS
            sticks, v = v < 0.0, max(v, 0.0)
            x += step / fine * v
    assert len(tops) >= 1
    away = np.abs(force - small)
    away[50] = 0.0  # the drive's first sample has the damper's jump on one side or the other
    assert away.max() < 0.02


def test_given_moments_are_when_it_slides() -> None:
    head = 1e-3 * np.arange(3000) / 100.0
    level = np.full(3000, 0.35 * WEIGHT)
    free, tops = pull(MASS, 2500.0, 5.0, level, 0.15 * WEIGHT, head, 0.01)
    again, other = pull(MASS, 2500.0, 5.0, level, 0.15 * WEIGHT, head, 0.01, np.array([9.0, 15.0]))
    assert other[0] == pytest.approx(2500.0 * 9e-3 + 5e-3, rel=1e-9)
    assert tops == pytest.approx(np.full(len(tops), 0.5 * WEIGHT), rel=1e-9)
    assert not np.array_equal(free, again)


def named(found: Diagnosis) -> set[str]:
    return {effect.id for effect in found.effects}


@pytest.mark.slow
def test_teeth_behind_an_unknown_drive_are_two_frictions_and_a_spring() -> None:
    found = diagnose(pulled())
    assert (found.verdict, named(found)) == ("missing_physics", {"stribeck", "cable_compliance"})
    assert found.after["mu_static"].value == pytest.approx(0.5, rel=0.02)
    assert found.after["mu_kinetic"].value == pytest.approx(0.35, rel=0.02)
    assert found.after.effects["cable_compliance"]["K_cable_N_m"].value == pytest.approx(2500.0, rel=0.02)
    assert found.heldout.after < 1.2 * found.heldout.noise_floor


@pytest.mark.slow
def test_nothing_is_missing_where_the_file_knows_teeth_and_drive() -> None:
    known = UNKNOWN.updated(
        {
            "mu_static": Estimate(0.5, 0.02, "1"),
            "mu_kinetic": Estimate(0.35, 0.02, "1"),
            "cable.stiffness_N_m": Estimate(2500.0, 100.0, "N/m"),
        }
    )
    campaign = pulled(known=known)
    assert diagnose(campaign).verdict == "nothing_missing"
    truth = predict(campaign, campaign.measurements[1], known)
    assert truth.nuisances["drive_starts_s"] == pytest.approx(1.15, abs=0.2)


@pytest.mark.slow
def test_one_peak_before_steady_sliding_is_friction_that_falls() -> None:
    known = UNKNOWN.updated({"cable.stiffness_N_m": Estimate(3e4, 600.0, "N/m")})
    found = diagnose(pulled(3e4, 0.12, 0.42, 0.36, (5.0, 10.0, 20.0), known=known))
    assert (found.verdict, named(found)) == ("missing_physics", {"stribeck"})
    assert found.after["mu_kinetic"].value == pytest.approx(0.36, rel=0.02)


@pytest.mark.slow
def test_friction_that_wanders_is_of_the_kind_that_changes() -> None:
    found = diagnose(pulled(3e4, 0.2, 0.36, 0.36, (1.0, 2.0, 5.0), wander=0.15))
    assert found.verdict == "missing_physics"
    assert named(found) == {"cable_compliance", "unlisted"}
    assert {e.id: e.kind for e in found.effects}["unlisted"] == "changing"


@pytest.mark.slow
def test_a_fit_tells_starts_teeth_and_frictions() -> None:
    fit = fit_campaign(pulled())
    for name, numbers in fit.results.items():
        assert numbers["teeth"] >= 3, name
        assert 1.0 < numbers["drive_starts_s"] < 1.31
        assert numbers["tooth_height_N"] == pytest.approx(2 * 0.15 * WEIGHT, rel=0.1)
    assert fit.parameters["mu_static"].value == pytest.approx(0.5, rel=0.02)


def logged(force: np.ndarray, speed: float = 1.0) -> Measurement:
    """A pull of this force at 100 Hz and ``speed`` [mm/s]."""
    entry = Entry("pull.csv", "wheel_drag", speed_mm_s=speed)
    channel = Channel("force", force, "N")
    return Measurement(entry, Recording(np.arange(len(force)) / 100.0, (channel,), Provenance(entry.file, "", "test")))


@pytest.mark.parametrize(("rest", "drift"), [(1, -0.3), (1, 2.0), (30, 2.0), (30, -0.3)])
def test_a_force_that_is_up_at_once_is_told_from_a_drift(rest: int, drift: float) -> None:
    """However short the rest before it, and however far the drift goes in the end."""
    noise = 0.1 * np.random.default_rng(3).standard_normal(3000)
    force = np.where(np.arange(3000) < rest, 0.5, 6.5) + drift * np.arange(3000) / 100.0 + noise
    log = pulled_log(logged(force))
    assert log.rests == pytest.approx(0.5, abs=0.5)
    assert log.load == pytest.approx(6.0, abs=0.4)
    assert log.rise > 0.0
    assert log.jumps == pytest.approx((rest - 0.5) / 100.0, abs=0.011)


def test_the_first_tooth_is_one_though_the_next_is_higher() -> None:
    head = 2e-3 * np.maximum(np.arange(150) / 100.0 - 0.05, 0.0)
    force = pull(2.0, 15e3, 3.0, np.full(150, 4.5), 1.5, head, 0.01)[0]
    force = np.where(np.arange(150) > 35, force + 0.2, force)
    own = moments(pulled_log(logged(force + 0.03 * np.random.default_rng(4).standard_normal(150), 2.0)))
    assert own[0] == pytest.approx(0.05 + 6.0 / 15e3 / 2e-3, abs=0.03)


@pytest.mark.slow
def test_a_drift_is_no_friction_that_falls() -> None:
    """Moments of letting go, of which there are none, have no evidence to give, whatever their number."""
    random, made = np.random.default_rng(5), []
    for speed, samples in ((1.0, 900), (0.3, 3000), (2.0, 500), (0.6, 1500)):
        time = np.arange(samples) / 100.0
        head = 1e-3 * speed * np.maximum(time - 0.2, 0.0)
        clean = pull(3.5, 1e4, 4.0, np.full(samples, 10.5), 0.0, head, 0.01)[0]
        log = logged(clean - 2.3 * time + 0.12 * random.standard_normal(samples), speed)
        made.append(replace(log, entry=replace(log.entry, file=f"pull-{speed:g}.csv")))
    mu = Estimate(0.3, 0.03, "1")
    known = ParameterSet("block", {"mass_kg": Estimate(3.5, 0.01, "kg"), "mu_static": mu, "mu_kinetic": mu,
                                   "cable.stiffness_N_m": Estimate(1e4, 1e3, "N/m")})  # fmt: skip
    campaign = Campaign(Session("block", Path(), "block", "drag", tuple(m.entry for m in made)), known, tuple(made))
    found = diagnose(campaign)
    assert (found.verdict, named(found)) == ("missing_physics", {"load_cell_drift"})
    assert found.effects[0].parameters["zero_drift_N_s"].value == pytest.approx(-2.3, rel=0.02)


@pytest.mark.slow
def test_friction_that_falls_over_a_speed_is_told_with_that_speed() -> None:
    random, made = np.random.default_rng(5), []
    for speed in (1.0, 0.5, 2.0, 1.5):
        head = 1e-3 * speed * np.maximum(np.arange(round(900 / speed)) / 100.0 - 0.5, 0.0)
        clean = pull(3.0, 10.5e3, 4.0, np.full(len(head), 10.6), 1.9, head, 0.01, None, 3.6e-3)[0]
        made.append(logged(clean + 0.2 * random.standard_normal(len(head)), speed))
        made[-1] = replace(made[-1], entry=replace(made[-1].entry, file=f"pull-{speed:g}.csv"))
    mu = Estimate(0.4, 0.04, "1")
    known = ParameterSet("block", {"mass_kg": Estimate(3.0, 0.01, "kg"), "mu_static": mu, "mu_kinetic": mu,
                                   "cable.stiffness_N_m": Estimate(10e3, 1e3, "N/m")})  # fmt: skip
    found = diagnose(
        Campaign(Session("block", Path(), "block", "drag", tuple(m.entry for m in made)), known, tuple(made))
    )
    assert (found.verdict, named(found)) == ("missing_physics", {"stribeck"})
    speed = found.effects[0].parameters["stribeck_velocity_m_s"]
    assert abs(speed.value - 3.6e-3) < max(3.0 * speed.std, 0.15 * 3.6e-3)
    assert found.heldout.after < 1.3 * found.heldout.noise_floor


@pytest.mark.slow
def test_nothing_is_missing_without_a_name_where_the_file_has_two_frictions() -> None:
    """A file of two frictions holds no speed over which one becomes the other, so that none can be its answer."""
    random, made = np.random.default_rng(6), []
    for speed in (1.0, 2.0, 1.5):
        head = 1e-3 * speed * np.maximum(np.arange(round(900 / speed)) / 100.0 - 0.5, 0.0)
        clean = pull(3.0, 10.5e3, 4.0, np.full(len(head), 10.6), 1.9, head, 0.01, None, 3.6e-3)[0]
        log = logged(clean + 0.2 * random.standard_normal(len(head)), speed)
        made.append(replace(log, entry=replace(log.entry, file=f"pull-{speed:g}.csv")))
    values = {"mu_static": Estimate(0.425, 0.02, "1"), "mu_kinetic": Estimate(0.36, 0.02, "1")}
    known = ParameterSet("block", {"mass_kg": Estimate(3.0, 0.01, "kg"), **values,
                                   "cable.stiffness_N_m": Estimate(10.5e3, 200.0, "N/m")})  # fmt: skip
    found = diagnose(
        Campaign(Session("block", Path(), "block", "drag", tuple(m.entry for m in made)), known, tuple(made))
    )
    assert (found.verdict == "missing_physics") == bool(found.effects)


def test_a_wandering_level_has_no_teeth() -> None:
    campaign = pulled(3e4, 0.2, 0.36, 0.36, (2.0, 5.0), wander=0.15)
    assert pulls_of(replace(campaign).measurements, MASS).teeth == (0, 0)
