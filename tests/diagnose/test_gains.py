"""Axes of an accelerometer read a few percent more or less: that is what their sheet says, and no missing physics."""

from __future__ import annotations

import numpy as np
import pytest
from bank import draw
from bank.robots import draw_robot

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.identify.body.builder import GAINS
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

SEED = 187486
"""Gains of 1.026, 0.966 and 1.014. A first descent ends with the centre of mass seven deviations off."""


@pytest.fixture(scope="module")
def drawn() -> Campaign:
    return draw("decays", "none", SEED, short=True).campaign


def test_nothing_is_missing_and_the_gains_are_told(drawn: Campaign) -> None:
    found = diagnose(drawn)
    assert found.verdict == "nothing_missing"
    assert not found.conflicts or {c.parameter for c in found.conflicts} == {"inertia_kg_m2.zz"}
    true = draw_robot(np.random.default_rng([SEED, 1]))[2]
    for name, gain in zip(GAINS, true, strict=True):
        assert found.before.number(name) == pytest.approx(gain, abs=3.0 * (found.before[name].std or 0.0))
    # what is written down of the fit is the fit: another reading of it starts where this one ended
    again = set_up(drawn, found.before)
    left = follow(again.kept, again.model, np.zeros(len(again.model.physics)))
    assert left.rss / left.size < 1.2 * found.heldout.before**2 / found.heldout.noise_floor**2


def test_a_file_that_fixes_them_or_leaves_the_sheet_out_keeps_them(drawn: Campaign) -> None:
    sheet = drawn.parameters["accelerometer.volts_per_m_s2"]
    exact = drawn.parameters.updated({"accelerometer.volts_per_m_s2": Estimate(sheet.value, None, sheet.unit)})
    fixed = drawn.parameters.updated({name: Estimate(1.0, None, "1", fixed=True) for name in GAINS})
    for known in (exact, fixed):
        assert not {u.name for u in set_up(drawn, known).known} & set(GAINS)
