"""Pulls of a robot off its centre are explained whichever law they slid by, and the fit that decided is handed on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose import sliding
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.diagnose.sliding import KEY, of_those_that_stand, unexplained, with_law_of_sliding
from ssmr_ident.experiments import Scenario
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials import Trial
from ssmr_ident.physics.robot import SLIDING_SPEED, robot_from_parameters
from ssmr_ident.session import Entry, Session
from ssmr_ident.session.parameters_file import read_parameters
from ssmr_ident.simulate import simulate

pytestmark = pytest.mark.slow

RATE, NOISE = 50.0, 0.3
PULLS = ((1.0, (1, 2, 3, 4)), (1.0, (1, 2)), (0.6, (1, 2, 3, 4)), (1.5, (3, 4)))
AXLES = ((1.0, (1, 2, 3, 4)), (1.0, (1, 4)), (0.6, (1, 2, 3, 4)), (1.5, (2, 3)))
"""About one gripping axle a robot turns, so that wheels slide along both axes: there the two laws differ."""


def pulled(cone: bool, plan: tuple[tuple[float, tuple[int, ...]], ...] = PULLS, noise: float = NOISE) -> Campaign:
    random = np.random.default_rng(6)
    known = read_parameters("p3at-extended")
    known = known.updated({"tire.mu_kinetic": known["tire.mu_static"]})
    points = np.asarray(known["contact_points_m"].value, dtype=float) + np.array([-0.009, 0.004, 0.0])
    true = known.updated({"contact_points_m": Estimate(points, None, "m")})
    if cone:
        true = true.updated({KEY: Estimate(0.3, None, "m/s")})
    robot = robot_from_parameters(true)
    made = []
    for number, (speed, wheels) in enumerate(plan):
        head = speed * 1e-3 / RATE * np.arange(round(7.0 / speed * RATE) + 1)
        scenario = Scenario(
            "pull", len(head) / RATE, head=np.append(head, 2.0 * head[-1] - head[-2]), head_step=1.0 / RATE,
            direction="lateral", height=0.05, wheels_gripping=wheels, wheel_rates=np.zeros((1, 2)),
        )  # fmt: skip
        force = simulate(robot, scenario, RATE)["force"] + noise * random.standard_normal(len(head))
        log = Recording(
            np.arange(len(head)) / RATE,
            (Channel("force", force, "N"), Channel("position", head, "m")),
            Provenance("made", "", "test"),
        )
        entry = Entry(
            f"pull-{number}.csv", "pull", direction="lateral", speed_mm_s=speed, height_m=0.05,
            wheels_gripping=wheels, cable="steel",
        )  # fmt: skip
        made.append(Measurement(entry, log))
    return Campaign(Session("pulled", Path(), "robot", "rigid6", tuple(m.entry for m in made)), known, tuple(made))


@pytest.mark.parametrize("cone", [False, True])
def test_pulls_of_either_law_are_explained_by_the_fit_that_decides(cone: bool) -> None:
    campaign = pulled(cone)
    setup, _ = with_law_of_sliding(campaign, campaign.parameters)
    assert setup.begun is not None
    fit, _ = setup.begun
    assert fit.model == setup.model
    assert np.max(fit.parts / [t.size for t in fit.trials]) < 1.5
    values, _ = fit.model.split(fit.point)
    assert values["contact_shift_x_m"] == pytest.approx(-0.009, abs=0.002)


@pytest.mark.parametrize(("cone", "plan"), [(False, PULLS), (True, AXLES)])
def test_a_pull_on_wheels_that_turn_has_no_say_where_neither_law_explains_it(
    cone: bool, plan: tuple[tuple[float, tuple[int, ...]], ...]
) -> None:
    campaign = pulled(cone, (plan[0], *plan), noise=0.05)
    # under neither law does a wheel fall to a third of its force
    strange = campaign.measurements[0]
    force = Channel("force", strange.recording["force"] / 3.0, "N")
    channels = tuple(force if c.name == "force" else c for c in strange.recording.channels)
    measured = (replace(strange, recording=replace(strange.recording, channels=channels)), *campaign.measurements[1:])
    campaign = replace(campaign, measurements=measured)
    known = campaign.parameters
    decided = known.updated({KEY: Estimate(SLIDING_SPEED, None, "m/s", fixed=True)})
    laws = [(set_up(replace(campaign, parameters=p), p), p) for p in (known, decided)]
    assert strange.name in [trial.name for trial in laws[0][0].fitted]
    fits = [best_baseline(setup.fitted, setup, p)[0] for setup, p in laws]
    assert of_those_that_stand(laws, {strange.name}, fits) == cone
    everything = {m.name for m in campaign.measurements}
    assert of_those_that_stand(laws, everything, fits) == 0  # none stands: the file's own law
    if cone:  # it would have turned the answer round
        assert of_those_that_stand(laws, set(), fits) == 0


def test_pulls_that_stand_are_fitted_from_where_all_have_ended_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    """By themselves they may end in a hollow that the fit of all is out of."""
    campaign = pulled(False, noise=0.05)
    known = campaign.parameters
    decided = known.updated({KEY: Estimate(SLIDING_SPEED, None, "m/s", fixed=True)})
    laws = [(set_up(replace(campaign, parameters=p), p), p) for p in (known, decided)]
    whole = [best_baseline(setup.fitted, setup, p)[0] for setup, p in laws]

    def hollow(trials: Sequence[Trial], setup: Setup, p: ParameterSet) -> tuple[JointFit, tuple[float, ...]]:
        fit = whole[0] if setup is laws[0][0] else whole[1]
        point = fit.point.copy()
        if fit is whole[0]:
            point[[u.name for u in fit.model.physics].index("contact_shift_x_m")] -= 4.0
        begun = evaluate(trials, fit.model, point, fit.nuisances[: len(trials)])
        return differentiate(begun), ()

    monkeypatch.setattr(sliding, "best_baseline", hollow)
    monkeypatch.setattr(sliding, "crossed", list)
    last = whole[0].trials[-1].name
    assert of_those_that_stand(laws, {last}, whole) == 0
    monkeypatch.setattr(sliding, "_better_of", lambda fit, _: fit)
    assert of_those_that_stand(laws, {last}, whole) == 1


def test_a_law_counts_as_unexplained_by_turning_wheels_alone() -> None:
    campaign = pulled(False)
    setup, _ = with_law_of_sliding(campaign, campaign.parameters)
    assert setup.begun is not None
    fit, _ = setup.begun
    first, second = (trial.name for trial in fit.trials[:2])
    worse = replace(fit, residuals=(4.0 * fit.residuals[0], *fit.residuals[1:]))
    assert unexplained(worse, {first})
    assert not unexplained(worse, {second})
    assert not unexplained(fit, {first, second})
