"""Pulls of a robot off its centre are explained whichever law they slid by."""

from __future__ import annotations

import numpy as np
import pytest
from pulls_off_centre import pulled

from ssmr_ident.doctor.decide import decide
from ssmr_ident.doctor.robots.answer import table
from ssmr_ident.doctor.robots.run import SLIDES, under_laws_of_sliding
from ssmr_ident.doctor.robots.search import searched

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("cone", [False, True])
def test_pulls_are_explained_by_the_law_that_they_slid_by(cone: bool) -> None:
    campaign = pulled(cone)
    laws = under_laws_of_sliding(campaign, campaign.parameters)
    assert [SLIDES in known for _, known in laws] == [False, True]
    found = searched([setup for setup, _ in laws])
    fit = found.search.baseline.fit
    assert fit is not None
    assert found.setup.known is laws[cone][0].known
    assert decide([row for row, _ in table(found.search)]).verdict == "nothing_missing"
    assert np.max(fit.parts / [t.size for t in fit.trials]) < 1.5
    values, _ = fit.model.split(fit.point)
    assert values["contact_shift_x_m"] == pytest.approx(-0.009, abs=0.002)


def test_a_file_that_states_the_law_has_decided() -> None:
    campaign = pulled(cone=True)
    stated = under_laws_of_sliding(campaign, campaign.parameters)[1][1]
    assert len(under_laws_of_sliding(campaign, stated)) == 1
