"""Decays of linear models fitted exactly, and the search that takes them for a start."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.setup import unknowns_of
from ssmr_ident.doctor.decays.closed_slopes import closed_slopes
from ssmr_ident.doctor.decays.laws import exact, linear_states
from ssmr_ident.doctor.decays.linear import fit_linear, system
from ssmr_ident.doctor.decays.linear_members import within_reach
from ssmr_ident.doctor.decays.recordings import Decay, decay_of, thinned
from ssmr_ident.doctor.decays.run import alone, diagnose, takes
from ssmr_ident.doctor.robots.answer import WEIGHED
from ssmr_ident.doctor.robots.found import cost_of
from ssmr_ident.doctor.table import Row
from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import differentiate, evaluate
from ssmr_ident.identify.trials.decay import decay_trial
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, Session, read_parameters
from ssmr_ident.simulate import simulate

KNOWN = read_parameters("p3at-extended")
MAST = {"f_mast_Hz": 8.0, "mass_kg": 2.0, "height_above_com_m": 0.3, "damping_ratio": 0.04}
RELEASES = {
    "roll": {"y": -4e-4, "roll": 2.5e-3, "x": 1e-4},
    "pitch": {"x": -1e-3, "pitch": 2e-3, "z": 1e-4},
    "yaw": {"yaw": 3e-3, "y": 1e-4},
}
AXES = ("ax", "ay", "az")


def released(effects, trials: int = 1, seconds: float = 2.0) -> Campaign:
    """A robot as the file has it, with effects and white noise, let go in every motion."""
    robot, random, made = robot_from_parameters(KNOWN), np.random.default_rng(1), []
    for motion, offset in RELEASES.items():
        for trial in range(1, trials + 1):
            scenario = Scenario("free_response", seconds, offset={n: v / trial for n, v in offset.items()})
            run = simulate(robot, scenario, 500.0, step=2e-4, effects=effects)
            name = f"{motion}-{trial}.csv"
            noisy = [run[a] + 0.005 * random.standard_normal(len(run.time)) for a in AXES]
            channels = tuple(Channel(a, s, "m/s^2") for a, s in zip(AXES, noisy, strict=True))
            entry = Entry(name, "free_response", role="target", trial=trial, motion=motion)
            made.append(Measurement(entry, Recording(run.time, channels, Provenance(name, "", "test"))))
    entries = tuple(m.entry for m in made)
    return Campaign(Session("test", Path("test"), "robot.yaml", "rigid6", entries), KNOWN, tuple(made))


def stacked(slopes) -> np.ndarray:
    """Shared columns of all recordings, (N, p) float."""
    return np.concatenate([one.shared for one in slopes])


def prepared(campaign: Campaign) -> tuple[list[Decay], Model]:
    builder = RobotBuilder.of(KNOWN)
    decays = [decay_of(decay_trial(m, builder), builder) for m in campaign.measurements]
    return decays, Model(unknowns_of(campaign, KNOWN))


@pytest.fixture(scope="module")
def swaying() -> tuple[list[Decay], Model]:
    return prepared(released({"flexible_mast": MAST}))


EVERY = {
    "flexible_mast": {**MAST, "f_mast_Hz": 8.5},
    "motor_belt": {"K_b_N_m": 3e4, "D_b_N_s_m": 40.0, "rim_mass_kg": 1.2},
    "viscoelastic_relaxation": {"K_m_N_m": 2e3, "tau_s": 0.04},
    "com_offset": {"offset_x_m": 0.01, "offset_y_m": -0.02},
    "sensor_misalignment": {"angle_x_rad": 0.05, "angle_y_rad": -0.02, "angle_z_rad": 0.03},
    "sensor_bandwidth": {"bandwidth_hz": 25.0},
}


@pytest.mark.compiles
@pytest.mark.parametrize("effect", EVERY)
def test_slopes_are_those_of_the_cost(swaying, effect: str) -> None:
    decays, model = swaying
    at = EVERY[effect]
    model, own = model.with_effect(effect, at, {name: abs(value) for name, value in at.items()})
    count = len(model.physics)
    point = np.concatenate([0.2 * np.random.default_rng(3).standard_normal(count), own])
    found = system(decays[:2], model, point)
    assert found is not None
    for column in (0, 2, 8, 11, count - 4, *range(count, len(point))):
        ends = []
        for side in (1e-4, -1e-4):
            moved = point.copy()
            moved[column] += side
            end = system(decays[:2], model, moved)
            assert end is not None
            ends.append(end.cost)
        slope = (ends[0] - ends[1]) / 2e-4
        assert 2.0 * found.gradient[column] == pytest.approx(slope, rel=5e-3, abs=1e-5 * found.cost)


@pytest.mark.compiles
def test_a_mast_is_found_from_starts_that_are_off(swaying) -> None:
    decays, model = swaying
    start = {"f_mast_Hz": 9.5, "mass_kg": 0.8, "height_above_com_m": 0.4, "damping_ratio": 0.03}
    model, own = model.with_effect("flexible_mast", start, start)
    thin, tried = [thinned(d, 1.0, 2) for d in decays], []
    for factor in (0.6, 0.75, 1.0, 1.3):
        shift = [model.free[0].unknown.scaled(factor * start["f_mast_Hz"]), 0.0, 0.0, 0.0]
        tried.append(fit_linear(thin, model, np.concatenate([np.zeros(len(model.physics)), own + shift]), 10))
    best = min((fit for fit in tried if fit is not None), key=lambda fit: fit.cost)
    fit = fit_linear(decays, model, best.point)
    assert fit is not None
    found = model.split(fit.point)[1]["flexible_mast"]
    assert fit.chi2 < 1.2 * sum(d.trial.size for d in decays)
    assert found["f_mast_Hz"] == pytest.approx(MAST["f_mast_Hz"], rel=0.02)
    assert np.abs(fit.point[: len(model.physics)]).max() < 2.5


@pytest.mark.compiles
def test_a_mast_that_no_robot_carries_is_no_fit(swaying) -> None:
    decays, model = swaying
    heavy = {**MAST, "mass_kg": 100.0}
    model, own = model.with_effect("flexible_mast", heavy, heavy)
    assert fit_linear(decays, model, np.concatenate([np.zeros(len(model.physics)), own])) is None


@pytest.mark.compiles
def test_it_takes_free_responses_of_a_file_whose_effects_are_linear() -> None:
    campaign = released({}, seconds=0.5)
    pulled = Measurement(Entry("pull.csv", "pull"), campaign.measurements[0].recording)
    assert takes(campaign, KNOWN)
    assert not takes(Campaign(campaign.session, KNOWN, (pulled,)), KNOWN)
    hardens = replace(KNOWN, effects={"nonlinear_stiffness": {"k3_N_m3": Estimate(1e9, None, "N/m^3")}})
    assert not takes(campaign, hardens)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effects", "named"),
    [({}, []), ({"flexible_mast": MAST}, ["flexible_mast"]),
     ({"nonlinear_stiffness": {"k3_N_m3": 1.5e9}}, ["nonlinear_stiffness"])],
    ids=["nothing", "mast", "hardening"],
)  # fmt: skip
def test_what_is_missing_is_named(effects, named: list[str]) -> None:
    found = diagnose(released(effects, trials=2))
    assert [effect.id for effect in found.effects] == named
    assert found.heldout.after < 1.4 * found.heldout.noise_floor


def test_a_linear_effect_answers_alone() -> None:
    def row(ids: str, kinds: str, evidence: float) -> Row:
        return Row(tuple(ids.split()), tuple(kinds.split()), ids or "baseline", False, evidence, 5000.0, 5000.0)

    base, mast = row("", "", 0.0), row("flexible_mast", "extra_motion", 33.0)
    offset, belt = row("com_offset", "geometry", 12.0), row("motor_belt", "extra_motion", 19.0)
    pair = row("flexible_mast motor_belt", "extra_motion extra_motion", 32.0)
    assert alone(mast, [base, mast, pair, row("motor_belt", "extra_motion", 12.0)])
    assert not alone(mast, [base, mast, pair, belt])
    assert alone(offset, [base, offset, belt])
    assert not alone(offset, [base, offset, mast])


@pytest.mark.slow
def test_a_displaced_centre_of_mass_is_named_with_what_to_weigh() -> None:
    offset = {"offset_x_m": 0.02, "offset_y_m": -0.015}
    found = diagnose(released({"com_offset": offset}, trials=2))
    (effect,) = found.effects
    assert effect.id == "com_offset"
    for name, value in offset.items():
        assert float(effect.parameters[name].value) == pytest.approx(value, abs=1.5e-3)
    assert found.next_experiment == WEIGHED


@pytest.mark.compiles
@pytest.mark.parametrize(("stiffness", "tau"), [(1800.0, 0.017), (2000.0, 0.03), (3000.0, 0.1)])
def test_branches_hold_what_the_release_has_left_in_them(stiffness: float, tau: float) -> None:
    branch = {"K_m_N_m": stiffness, "tau_s": tau}
    decays, model = prepared(released({"viscoelastic_relaxation": branch}, seconds=1.0))
    model, own = model.with_effect("viscoelastic_relaxation", branch, branch)
    fit = fit_linear(decays, model, np.concatenate([np.zeros(len(model.physics)), own]))
    assert fit is not None
    assert cost_of(exact(decays, fit)) < 1.02 * fit.cost


OTHERS = {
    "motor_belt": {"K_b_N_m": 1.2e4, "D_b_N_s_m": 40.0, "rim_mass_kg": 0.8},
    "viscoelastic_relaxation": {"K_m_N_m": 2e3, "tau_s": 0.03},
    "sensor_misalignment": {"angle_x_rad": 0.02, "angle_y_rad": -0.01, "angle_z_rad": 0.03},
    "com_offset": {"offset_x_m": 0.01, "offset_y_m": -0.01},
    "quadratic_damping": {"d2_N_s2_m2": 20.0},
}


@pytest.mark.compiles
@pytest.mark.parametrize("effect", ["", "flexible_mast", *OTHERS])
def test_slopes_in_closed_form_are_those_of_small_simulations(effect: str) -> None:
    """Two independent ways: eigenvectors, and differences between runs of the time-stepping loop."""
    values = {"flexible_mast": MAST, **OTHERS}.get(effect, {})
    decays, model = prepared(released({effect: values} if effect else {}, seconds=1.0))
    own = np.zeros(0)
    if effect:
        model, own = model.with_effect(effect, values, values)
    point = np.concatenate([np.zeros(len(model.physics)), own])
    states = linear_states(decays, model, point)
    assert states is not None
    small = [0.1 * state for state in states]  # of large motions a tenth is geometry
    fit = evaluate([d.trial for d in decays], model, point, small)
    closed = stacked(closed_slopes(decays)(fit, True).slopes)
    differences = stacked(differentiate(fit).slopes)
    size = np.linalg.norm(differences, axis=0)
    seen = size > 1e-3 * size.max()
    assert seen.sum() > 20
    off = np.linalg.norm(closed - differences, axis=0)[seen] / size[seen]
    assert np.median(off) < 0.03
    assert off.max() < 0.15  # the sensor's bandwidth, which is simulated in steps of 1 ms


@pytest.mark.compiles
def test_a_slow_sensor_follows_from_what_it_had_read_before() -> None:
    slow = {"bandwidth_hz": 18.0}
    decays, model = prepared(released({"sensor_bandwidth": slow}, seconds=1.0))
    model, own = model.with_effect("sensor_bandwidth", slow, slow)
    point = np.concatenate([np.zeros(len(model.physics)), own])
    states = linear_states(decays, model, point)
    assert states is not None
    fit = evaluate([d.trial for d in decays], model, point, [0.1 * state for state in states])
    closed, differences = closed_slopes(decays)(fit, True).slopes, differentiate(fit).slopes
    for one, other in zip(closed, differences, strict=True):
        size = np.linalg.norm(other.own[:, :12], axis=0)
        off = np.linalg.norm(one.own[:, :12] - other.own[:, :12], axis=0) / size
        assert off[size > 0.01 * size.max()].max() < 0.05


def test_a_model_may_come_near_the_least_by_ten_more_steps_like_its_last() -> None:
    assert within_reach(120.0, 130.0, 30.0)  # 120 - 10 * 10 < 30 + 20
    assert not within_reach(160.0, 170.0, 30.0)
    assert within_reach(45.0, 45.0, 30.0)


@pytest.mark.slow
def test_relaxing_tires_are_simulated_from_what_closed_form_has_found() -> None:
    """The simulator's branches hold a share of the release, closed form's anything."""
    branch = {"K_m_N_m": 2e3, "tau_s": 0.03}
    found = diagnose(released({"viscoelastic_relaxation": branch}, trials=2))
    assert [effect.id for effect in found.effects] == ["viscoelastic_relaxation"]
    assert found.heldout.after < 1.3 * found.heldout.noise_floor
