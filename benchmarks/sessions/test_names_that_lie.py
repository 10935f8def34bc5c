"""Names, order and metadata decide nothing: recordings shuffled and renamed get the same answer, to the last digit."""

from __future__ import annotations

import pytest
from bank import draw
from disguised_sessions import disguised, same

from ssmr_ident.workflows.diagnose import diagnose


@pytest.mark.parametrize(("family", "effect"), [("forced", "nonlinear_stiffness"), ("rig_decay", "dry_friction")])
def test_shuffled_and_renamed_recordings_get_the_same_answer(family: str, effect: str) -> None:
    campaign = draw(family, "one", 31, effect, 0.8, short=True).campaign
    plain = diagnose(campaign)
    assert effect in [e.id for e in plain.effects], plain
    hidden, names = disguised(campaign, 1)
    same(plain, diagnose(hidden), names)
