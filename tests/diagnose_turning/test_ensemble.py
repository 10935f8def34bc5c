"""An ensemble finds what a drawn session was made with, from a start that slopes do not lead away from."""

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.turning import ensemble
from ssmr_ident.diagnose.turning.anchor import Anchor, priors_of, scale_of
from ssmr_ident.diagnose.turning.bench import COARSE, Bench
from ssmr_ident.diagnose.turning.candidates import candidates
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.ensemble import settled
from ssmr_ident.diagnose.turning.likelihood import Score
from ssmr_ident.diagnose.turning.search import SPREAD_FACTOR, Explained, explained
from ssmr_ident.diagnose.turning.spectra import look
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.session import read_parameters

TRUE = {"height_m": 2.5e-4, "length_m": 0.015}


def _target(bench: Bench, anchor_values: dict) -> Condition:
    rates = np.atleast_2d([-1.5, 1.5])
    white = np.random.default_rng(0).standard_normal((4000, 3))
    blank = look(white, 500.0)
    turning = EXPERIMENTS["swivel"]
    one = Condition("target", turning, ("a",), (blank,), blank, ("ax", "ay", "az"), np.full(3, 1e-8), np.zeros(3),
                    rates, 1.0, 1.0, 6.0, 0.6, None, 1.0, 0.0)  # fmt: skip
    run = bench.run(one, anchor_values, {"ground_roughness": TRUE}, (77,))
    assert run is not None
    seen = replace(run.look, level_variance=np.full(9, 0.01))
    return replace(one, looks=(seen,), mean=seen)


@pytest.mark.slow
def test_settled_finds_a_floor_from_a_wrong_start() -> None:
    parameters = read_parameters("p3at-extended").updated({"tire.sliding_speed_m_s": Estimate(0.3, 0.03, "m/s")})
    bench = Bench(parameters)
    priors = priors_of(parameters)
    plain = Anchor(bench, np.ones(3), priors, np.zeros(len(priors)), (), Score(0.0, 0.0, 0.0), (1,), step=COARSE)
    target = _target(bench, plain.values)
    anchor = replace(plain, scale=scale_of((target,)))
    floor = next(c for c in candidates((0.1,), (10.0,), 3e-5) if c.id == "ground_roughness")
    start = explained(anchor, floor, {"height_m": 3.5e-4, "length_m": 0.012}, (target,))
    assert start is not None
    rounds: list[int] = []
    found = settled(start, (target,), 0, (1, 2), lambda: rounds.append(1))
    again = settled(start, (target,), 0, (1, 2), lambda: None)
    assert found.values == again.values
    assert np.array_equal(found.anchor.z, again.anchor.z)
    several = explained(replace(anchor, seeds=(1, 2)), floor, start.values, (target,))
    assert several is not None
    assert found.evidence > several.evidence
    assert abs(np.log(found.values["height_m"] / TRUE["height_m"])) < 0.25
    assert found.anchor.seeds == start.anchor.seeds
    assert len(rounds) > 1


def test_a_distance_is_known_no_better_than_what_fits_alike(monkeypatch) -> None:
    """Two combs that end alike lie half a logarithm apart: as far does the printed deviation reach."""
    joints = next(c for c in candidates((0.03,), (10.0,), 3e-5) if c.id == "ground_joints")
    values = {"depth_m": 3e-4, "pitch_m": 0.03, "width_m": 6e-3}
    other = {**values, "pitch_m": 0.03 * float(np.exp(0.5))}
    plain = Anchor(Bench(read_parameters("p3at-extended")), np.ones(3), (), np.zeros(0), (), Score(0.0, 0.0, 0.0))
    start = Explained(joints, values, plain, Score(0.0, 1.0, 1.0), 0.0, 10.0, np.full(3, 0.01))
    behind = replace(start, values=other, evidence=5.0)
    monkeypatch.setattr(ensemble, "other_pitches", lambda best, targets: [other])
    monkeypatch.setattr(ensemble, "explained", lambda *_: behind)
    monkeypatch.setattr(ensemble, "settled", lambda one, *_: one)
    found = ensemble.settled_at_distances(start, (), 0, (1,), lambda: None)
    assert found.values == values
    assert found.spread is not None
    np.testing.assert_allclose(SPREAD_FACTOR * found.spread, [0.03, 0.5, 0.03])


@pytest.mark.parametrize(("calibrated", "centre", "spread"), [(False, 0.0, 1.0), (True, 1.0, 0.5)])
def test_an_effect_is_searched_from_what_is_known_where_no_calibration_holds_the_baseline(
    calibrated: bool, centre: float, spread: float
) -> None:
    """The baseline had bent by two deviations: half of that is kept where calibration says so, else nothing."""
    parameters = read_parameters("p3at-extended")
    target = _target(Bench(parameters), {})
    priors = priors_of(parameters)
    anchor = Anchor(
        Bench(parameters), np.ones(3), priors, np.full(len(priors), 2.0), (target,) if calibrated else (),
        Score(0.0, 0.0, 0.0), (1,),
    )  # fmt: skip
    floor = next(c for c in candidates((0.1,), (10.0,), 3e-5) if c.id == "ground_roughness")
    start = Explained(floor, dict(floor.starts[0]), anchor, Score(0.0, 5.0, 5.0), 0.0, 0.0)
    members = ensemble.Ensemble(start, (target,), 0, (1,), everywhere=True).members[:, : len(priors)]
    assert abs(float(members.mean()) - centre) < 4.0 * spread / np.sqrt(members.size)
    assert abs(float(members.std()) / spread - 1.0) < 4.0 / np.sqrt(2.0 * members.size)
