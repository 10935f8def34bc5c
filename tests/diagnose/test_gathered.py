"""One place of the centre of mass, however it is split between contacts, sensor and offset."""

from __future__ import annotations

import numpy as np
import pytest
from made_pulls import made_pulls

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.explain import in_its_place
from ssmr_ident.diagnose.exported import exported
from ssmr_ident.diagnose.gathered import OFFSET, gathered
from ssmr_ident.diagnose.race import far_off, started
from ssmr_ident.diagnose.scan import Suspect
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate

PULLS = [("lateral", 2.0, 0.008), ("longitudinal", 2.0, 0.008)]
SIZES = {"offset_x_m": 0.01, "offset_y_m": 0.01}


@pytest.fixture(scope="module")
def pulled() -> tuple[Setup, ParameterSet]:
    return made_pulls(PULLS, {}, 3)


def split(setup: Setup, shift: float, offset: float) -> JointFit:
    """Contacts 2 deviations from the file, and an offset beside them."""
    at = {"offset_x_m": offset, "offset_y_m": 0.004}
    model, begin = setup.model.with_effect("com_offset", at, SIZES)
    point = np.concatenate([np.zeros(len(setup.model.physics)), begin])
    names = [u.name for u in model.physics]
    point[names.index("contact_shift_x_m")] = shift
    values, effects = model.split(point)
    trials = (*setup.fitted, *setup.kept)
    return evaluate(trials, model, point, [t.begin(values, effects) for t in trials])


def test_it_is_the_same_robot_at_less_cost(pulled: tuple[Setup, ParameterSet]) -> None:
    setup, _ = pulled
    fit = split(setup, -2.0, 0.01)
    found = gathered(fit)
    for before, after in zip(fit.simulated, found.simulated, strict=True):
        assert after == pytest.approx(before, abs=1e-9)
    values, effects = found.model.split(found.point)
    moved = fit.model.split(fit.point)[0]["contact_shift_x_m"]
    assert moved != 0.0
    assert values["contact_shift_x_m"] == 0.0
    assert effects["com_offset"]["offset_x_m"] == pytest.approx(0.01 - moved)
    # two deviations of the contacts against a third of one of an offset that is loosely held
    assert found.cost(fit.counted) < fit.cost(fit.counted) - 3.0
    assert gathered(found) is found


def test_it_is_known_no_better_than_the_contacts(pulled: tuple[Setup, ParameterSet]) -> None:
    setup, known = pulled
    fit = differentiate(split(setup, 0.0, 0.01))
    std = exported(fit, known).effects["com_offset"]["offset_x_m"].std
    assert std is not None
    assert std >= known["contact_points_m"].std / np.sqrt(2.0)


@pytest.fixture(scope="module")
def bent() -> JointFit:
    """A centre of mass 36 mm off, which a baseline follows with its contacts at seven deviations."""
    setup, _ = made_pulls(PULLS[:1], {"com_offset": {"offset_x_m": 0.0, "offset_y_m": -0.036}}, 3)
    names = [u.name for u in setup.model.physics]
    point = np.zeros(len(names))
    k = names.index("contact_shift_y_m")
    point[k] = setup.model.physics[k].scaled(0.036)
    values, effects = setup.model.split(point)
    trials = (*setup.fitted, *setup.kept)
    return evaluate(trials, setup.model, point, [t.begin(values, effects) for t in trials])


@pytest.mark.parametrize("slope", [5e-4, -5e-4])
def test_an_offset_begun_beside_contacts_that_are_bent_takes_their_place(bent: JointFit, slope: float) -> None:
    offset = Suspect(OFFSET, {"offset_x_m": -slope, "offset_y_m": slope}, {}, SIZES, 0.0)
    for found in (started(bent, offset, plain=True), in_its_place(bent, offset, far_off(bent))):
        held, effects = found.model.split(found.point)
        assert effects[OFFSET]["offset_y_m"] == pytest.approx(-0.036, abs=0.01)
        assert abs(held["contact_shift_y_m"]) < 0.015
        assert found.penalty < 0.3 * bent.penalty


def test_in_its_place_it_is_where_the_contacts_had_moved_to(bent: JointFit) -> None:
    """However wrong the way that a rough slope points: along it no size is any good."""
    offset = Suspect(OFFSET, {"offset_x_m": -5e-4, "offset_y_m": 5e-4}, {}, SIZES, 0.0)
    found = in_its_place(bent, offset, far_off(bent))
    assert found.rss == pytest.approx(bent.rss, rel=0.05)
    assert found.cost(bent.counted) < bent.cost(bent.counted) - 20.0
