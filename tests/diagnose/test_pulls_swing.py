"""A robot that slides swings on its tires: a pull depends on what damps that and on what it turns."""

from __future__ import annotations

import numpy as np
import pytest
from made_pulls import made_pulls

from ssmr_ident.doctor.decide import decide
from ssmr_ident.doctor.robots.answer import table
from ssmr_ident.doctor.robots.search import searched

pytestmark = pytest.mark.slow

PULLS = (("lateral", 1.0, 6e-3), ("lateral", 2.0, 7e-3), ("longitudinal", 2.0, 30e-3), ("longitudinal", 3.0, 30e-3))


def test_a_robot_that_its_file_has_too_much_damping_of_lacks_nothing() -> None:
    """Of swings that are out of step no effect is made; which damping they have is hardly told."""
    file = made_pulls(PULLS, {}, 3)[1]
    names = ("tire.damping_x_N_s_m", "tire.damping_y_N_s_m")
    real = {name: file[name].value - 1.2 * file[name].std for name in names}
    setup, _ = made_pulls(PULLS, {}, 3, real=real)
    search = searched([setup]).search
    fit = search.baseline.fit
    assert fit is not None
    assert decide([row for row, _ in table(search)]).verdict == "nothing_missing"
    assert np.max(fit.parts / [t.size for t in fit.trials]) < 1.5


def test_a_pull_takes_a_tire_for_passive_whatever_decays_ask_for() -> None:
    trial = made_pulls(PULLS[2:3], {}, 3)[0].fitted[0].as_it_is()
    own = np.zeros(1)
    none, less = ({"tire.damping_x_N_s_m": value} for value in (0.0, -40.0))
    assert np.array_equal(trial.run(none, {}, own), trial.run(less, {}, own))
    assert np.all(np.isfinite(trial.course.run(less, {}, own)))
    assert np.max(np.abs(trial.run(none, {}, own) - trial.run({}, {}, own))) > 0.5
