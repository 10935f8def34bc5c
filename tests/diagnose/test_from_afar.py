"""Pulls are begun again from robots drawn out of what is known: a descent ends in the hollow where it began."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_pulls import made_pulls

from ssmr_ident.diagnose.baseline import from_afar
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.start import begin
from ssmr_ident.identify.descent import descend
from ssmr_ident.identify.joint import JointFit, evaluate

PULLS = (("lateral", 1.0, 6e-3), ("lateral", 0.5, 6e-3))


@pytest.fixture(scope="module")
def stuck() -> tuple[Setup, JointFit]:
    """A descent from a robot whose centre of mass lies three deviations off to a corner."""
    setup, known = made_pulls(PULLS, {}, 7)
    fit = begin(setup.fitted, setup, known)
    names = [unknown.name for unknown in fit.model.physics]
    point = fit.point.copy()
    point[[names.index("contact_shift_x_m"), names.index("contact_shift_y_m")]] = 3.0, -3.0
    return setup, descend(evaluate(fit.trials, fit.model, point, fit.nuisances), 2, plain=True)


def test_a_draw_ends_lower_than_the_hollow_and_is_the_same_twice(stuck: tuple[Setup, JointFit]) -> None:
    _, fit = stuck
    first, again = from_afar(fit), from_afar(fit)
    assert len(first) == 1
    assert first[0].cost(fit.counted) < fit.cost(fit.counted)
    np.testing.assert_array_equal(first[0].point, again[0].point)


def test_recordings_that_take_their_time_each_are_left_as_they_are(stuck: tuple[Setup, JointFit]) -> None:
    _, fit = stuck
    alone = replace(fit, trials=tuple(replace(trial, abreast=False) for trial in fit.trials))
    assert from_afar(alone) == []
