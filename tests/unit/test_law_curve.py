"""The curve of a law is spring and law, as far as the motion went, and its band is that of the fit."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import Run, campaign

from ssmr_ident.doctor.law_curve import law_curve
from ssmr_ident.doctor.laws import FORMS, proposals
from ssmr_ident.doctor.named import begun
from ssmr_ident.estimate.baseline import baseline_fit
from ssmr_ident.estimate.motion import motion
from ssmr_ident.estimate.problem import problem_of


@pytest.mark.slow
def test_a_cubic_spring_is_drawn_as_far_as_it_went_with_its_band() -> None:
    made = campaign({"nonlinear_stiffness": {"k3_N_m3": 2e8}}, [Run(0.004), Run(0.003)], seed=4, duration=2.0)
    problem = problem_of(made.measurements[:2], made.parameters)
    base = baseline_fit(problem)
    (offer,) = proposals(problem, base, motion(problem, base), forms=[f for f in FORMS if f.name == "cubic"])
    fit = begun(problem, offer, base)
    (member,) = fit.node.members
    found = law_curve(problem, fit, member)
    assert found is not None
    s, force, std = (np.array(found[key]) for key in ("points", "force", "std"))
    assert found["variable"] == "displacement [m]"
    assert s[-1] == pytest.approx(0.004, rel=0.05)
    assert force == pytest.approx(fit.value("stiffness_N_m") * s + fit.value("k3_N_m3") * s**3, rel=1e-9, abs=1e-12)
    assert np.all(std[s != 0.0] > 0.0)
    assert np.abs(force - (20000.0 * s + 2e8 * s**3)).max() < 4.0 * std.max() + 0.01 * np.abs(force).max()
