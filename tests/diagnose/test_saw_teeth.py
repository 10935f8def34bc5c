"""Few teeth, compared in time: a constant friction goes through their middle, and no single probe leads away."""

from __future__ import annotations

import numpy as np
import pytest
from made_pulls import made_pulls

from ssmr_ident.diagnose.baseline import fit_baseline
from ssmr_ident.diagnose.race import combined, ranked
from ssmr_ident.diagnose.scan import Suspect

pytestmark = pytest.mark.slow

TRUE = {"kinetic_share": 0.72, "stribeck_velocity_m_s": 3e-3}
PULLS = (("longitudinal", 1.5, 21e-3), ("lateral", 1.0, 7e-3))


def test_all_combinations_show_the_falling_friction_and_the_limit_that_was_hidden() -> None:
    setup, known = made_pulls(PULLS, {"stribeck": TRUE}, 4)
    told = {trial.name: trial.sees("tire.damping_y_N_s_m") for trial in setup.fitted}
    assert told == {trial.name: trial.facts["teeth"] == 0.0 for trial in setup.fitted}
    assert not all(told.values())
    base = fit_baseline(setup.fitted, setup, known)
    probe = Suspect("stribeck", {"kinetic_share": 0.8, "stribeck_velocity_m_s": 0.01}, {}, {}, 0.0)
    found = combined(base, probe)
    hidden = known.number("tire.mu_static") / base.model.split(base.point)[0]["tire.mu_static"]
    assert hidden > 1.03
    best = ranked(found)[0]
    values, effects = best.model.split(best.point)
    assert effects["stribeck"]["kinetic_share"] in (0.7, 0.8)
    assert values["tire.mu_static"] > base.model.split(base.point)[0]["tire.mu_static"]
    assert np.log(best.parts / base.parts).mean() < -0.5
    assert combined(base, Suspect("motor_belt", {}, {}, {}, 0.0)) == []
