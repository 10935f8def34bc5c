"""What a pull's trial reads from its log before anything is fitted."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.trials.pull import falls, find_slack, holds, pull_trial, tightening
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import Entry, read_parameters
from ssmr_ident.simulate import simulate

STEP, SPEED, STIFFNESS = 0.01, 1e-3, 2e4


def ramp_and_hold(moving: float, standing: float) -> np.ndarray:
    return SPEED * np.minimum(STEP * np.arange(round((moving + standing) / STEP)), moving)


def relaxing(travel: np.ndarray, tau: float = 1.0) -> np.ndarray:
    """Spring, and as stiff a Maxwell branch beside it."""
    branch, force = 0.0, np.zeros(len(travel))
    for n, move in enumerate(np.diff(travel), start=1):
        branch += move - branch * STEP / tau
        force[n] = STIFFNESS * (travel[n] + branch)
    return force


@pytest.mark.parametrize("standing", [0.0, 4.0])
def test_a_slack_is_found_whether_or_not_the_head_stands_still_at_the_end(standing: float) -> None:
    travel = ramp_and_hold(3.0, standing)
    slack = 0.4e-3
    measured = relaxing(np.maximum(travel - slack, 0.0))
    measured += 0.3 * np.random.default_rng(3).standard_normal(len(measured))
    assert find_slack(measured, travel, relaxing(travel)) == pytest.approx(slack, abs=1e-5)


def test_a_wheel_that_lets_go_is_told_from_one_that_holds() -> None:
    noise = 0.5 * np.random.default_rng(4).standard_normal(700)
    travel = ramp_and_hold(3.0, 4.0)
    creeping = relaxing(travel)
    assert holds(creeping + noise, travel)
    assert not holds(np.minimum(creeping, 0.6 * creeping.max()) + noise, travel)
    # teeth rise as steeply as the first ramp, but get nowhere
    head = ramp_and_hold(7.0, 0.0)
    teeth = np.where(STIFFNESS * head < 40.0, STIFFNESS * head, 30.0 + np.mod(STIFFNESS * head, 10.0))
    assert not holds(teeth + noise, head)


def test_a_head_that_never_moves_holds_nothing() -> None:
    assert not holds(np.zeros(50), np.zeros(50))
    assert tightening(np.zeros(50), block=5) == 0


def test_where_the_cable_tightens_is_read_from_the_log_alone() -> None:
    random = np.random.default_rng(5)
    travel = ramp_and_hold(8.0, 0.0)
    for slack, block in ((0.0, 5), (0.3e-3, 5), (0.9e-3, 20)):
        force = 12.0 + np.minimum(STIFFNESS * np.maximum(travel - slack, 0.0), 100.0)
        found = STEP * tightening(force + 0.5 * random.standard_normal(len(force)), block=block)
        assert found == pytest.approx(slack / SPEED, abs=0.04)


@pytest.mark.parametrize("sliding_speed", [0.0, 0.3])
@pytest.mark.parametrize(("direction", "turning"), [("lateral", 0.0), ("longitudinal", 0.0), ("lateral", 0.1)])
def test_a_pull_of_one_friction_coefficient_moves_smoothly_with_what_it_hardly_depends_on(
    direction: str, turning: float, sliding_speed: float
) -> None:
    """Chatter, and wheels that let go at one moment by symmetry alone, once made jumps of half a newton of this."""
    known = read_parameters("p3at-extended")
    law = Estimate(sliding_speed, None, "m/s")
    known = known.updated({"tire.mu_kinetic": known["tire.mu_static"], "tire.sliding_speed_m_s": law})
    time = np.arange(900) / 100.0
    log = Recording(time, (Channel("force", 8.0 * time, "N"),), Provenance("made", "", "test"))
    speed = 1.0 if direction == "lateral" else 2.0
    entry = Entry("pull.csv", "pull", direction=direction, speed_mm_s=speed, wheel_rate_rad_s=turning or None)
    trial = pull_trial(Measurement(entry, log), known)
    plain = trial.run({}, {}, np.array([0.02]))
    assert turning or plain.max() > 180.0  # all wheels slide
    for name, value in (("tire.damping_x_N_s_m", 50.1), ("inertia_kg_m2.zz", 0.925), ("contact_shift_y_m", 1e-6)):
        moved = trial.run({name: value}, {}, np.array([0.02]))
        assert 0.0 <= np.std(moved - plain) < 0.01, name


def test_tires_that_a_fit_has_made_drive_hold_still_at_every_step() -> None:
    """Of a damping below nought, as a fit may leave it, a robot that slides would run away in a full simulation."""
    known = read_parameters("p3at-extended")
    known = known.updated({"tire.damping_x_N_s_m": Estimate(-40.0, None, "N s/m")})
    time = np.arange(900) / 100.0
    log = Recording(time, (Channel("force", 8.0 * time, "N"),), Provenance("made", "", "test"))
    trial = pull_trial(Measurement(Entry("pull.csv", "pull", direction="longitudinal", speed_mm_s=2.0), log), known)
    whole = trial.course.run({}, {}, np.array([0.02]))
    assert np.isfinite(whole).all()
    quick = np.interp(trial.times, trial.course.times, whole[:, 0])
    assert np.std(trial.run({}, {}, np.array([0.02]))[:, 0] - quick) < 0.5


def test_a_slack_is_found_while_wheels_spin() -> None:
    """They have turned by the time the cable tightens: the force over the travel that is left is another."""
    known = read_parameters("p3at-extended")
    slip = {"slip_coupling": {"weight": 0.3, "lambda_max": 0.15}}
    slack, travel = 0.3e-3, ramp_and_hold(6.0, 0.0)
    head = np.append(np.maximum(travel - slack, 0.0), travel[-1] + SPEED * STEP - slack)
    scenario = Scenario(
        "pull", len(travel) * STEP, head=head, head_step=STEP, direction="lateral", height=0.05,
        wheels_gripping=(1, 2, 3, 4), wheel_rates=np.full((1, 2), 0.1), held=True,
    )  # fmt: skip
    force = simulate(robot_from_parameters(known), scenario, 1.0 / STEP, effects=slip)["force"]
    force = force + 0.5 * np.random.default_rng(6).standard_normal(len(force))
    log = Recording(
        STEP * np.arange(len(force)),
        (Channel("force", force, "N"), Channel("position", travel, "m")),
        Provenance("made", "", "test"),
    )
    entry = Entry("pull.csv", "pull", direction="lateral", speed_mm_s=1.0, height_m=0.05, wheel_rate_rad_s=0.1)
    trial = pull_trial(Measurement(entry, log), known)
    found = trial.begin({}, slip) * trial.scales
    assert found[0] == pytest.approx(slack, abs=2.5e-5)
    left = trial.white_target - trial.whitened(trial.run({}, slip, found / trial.scales))
    assert float(left @ left) < 50.0 * trial.size


def test_a_contact_that_lets_go_once_near_the_end_does_not_hold() -> None:
    noise = 0.2 * np.random.default_rng(8).standard_normal(800)
    head = ramp_and_hold(8.0, 0.0)
    once = STIFFNESS * np.where(head < 5.5e-3, head, head - 2.5e-3)
    assert holds(STIFFNESS * head + noise, head)
    assert falls(once + noise, head)
    assert not holds(once + noise, head)
