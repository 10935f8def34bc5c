"""Under which law of contact a baseline is fitted: the file's, else the one that made the recordings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.doctor.swivels.anchor import FITTED, priors_of, scale_of
from ssmr_ident.doctor.swivels.baseline import fitted_baseline
from ssmr_ident.doctor.swivels.bench import Bench
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.grip import grip_profile
from ssmr_ident.doctor.swivels.spectra import look
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.session import read_parameters


def under(law: str) -> ParameterSet:
    return replace(read_parameters("p3at-extended"), choices={"tire.contact": law})


def recorded(parameters: ParameterSet) -> Condition:
    """A steady turn at 40 deg/s of a robot as the file has it, on a floor of its own."""
    blank = look(np.random.default_rng(0).standard_normal((3000, 3)), 500.0)
    rates = np.atleast_2d([-1.13, 1.13])
    one = Condition("target", EXPERIMENTS["swivel"], ("a",), (blank,), blank, ("ax", "ay", "az"), np.full(3, 1e-8),
                    np.zeros(3), rates, 1.0, 1.0, 6.0, 0.7, None, 1.0, 0.0)  # fmt: skip
    run = Bench(parameters).run(one, {}, {}, (77,))
    assert run is not None
    seen = replace(run.look, level_variance=np.full(9, 0.01))
    return replace(one, looks=(seen,), mean=seen)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["relay", "cone"])
def test_a_silent_file_takes_the_law_of_the_recordings(law: str) -> None:
    target = recorded(under(law))
    scale, known = scale_of((target,)), read_parameters("p3at-extended")
    found = fitted_baseline(known, (target,), scale, (1,), 0, lambda: None)
    assert found.ensemble.now.anchor.bench.parameters.choices["tire.contact"] == law
    assert f"{law} is taken" in found.notes[0]
    _, began = found.places
    assert began[1] is not None
    assert began[1].shape[1] == len(began[0].priors)


@pytest.mark.slow
def test_a_file_that_holds_everything_fixed_leaves_nothing_to_give_way() -> None:
    cone = under("cone")
    held = cone.updated({path: replace(cone[path], fixed=True) for path in FITTED if path in cone})
    held = held.updated({
        "tire.sliding_speed_m_s": Estimate(0.3, None, "m/s", fixed=True),
        "floor.height_m": Estimate(3e-5, None, "m", fixed=True),
    })  # fmt: skip
    target = recorded(held)
    found = fitted_baseline(held, (target,), scale_of((target,)), (1,), 0, lambda: None)
    assert found.ensemble.now.anchor.priors == ()
    assert found.ensemble.slopes is None
    profile = grip_profile(found.ensemble.now, None, (target,), lambda: None)
    # the truth is 0.1: what an unmoved baseline leaves at 1 is far more than at what made the recording
    assert profile.best <= 0.4
    assert profile.log_likelihood[-1] < profile.log_likelihood[0] - 10.0


def test_a_file_that_names_its_law_is_not_asked() -> None:
    relay = under("relay")
    assert "tire.sliding_speed_m_s" not in {prior.path for prior in priors_of(relay)}
    assert "tire.sliding_speed_m_s" in {prior.path for prior in priors_of(under("cone"))}
