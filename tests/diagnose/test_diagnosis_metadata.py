"""Names, order and metadata decide nothing: the same recordings shuffled and renamed get the same answer, to the last
digit."""

from __future__ import annotations

from dataclasses import replace

import pytest
from bank import draw
from disguised_sessions import disguised, same

from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow


def test_a_null_stays_a_null_under_names_that_lie() -> None:
    campaign = draw("forced", "none", 32, short=True).campaign
    hidden, names = disguised(campaign, 2)
    same(diagnose(campaign), diagnose(hidden), names)


def test_recordings_kept_back_by_the_tool_do_not_depend_on_their_order() -> None:
    campaign = draw("rig_decay", "one", 33, "dry_friction", 0.9, short=True).campaign
    targets = tuple(m for m in campaign.measurements if m.entry.role == "target")
    session = replace(campaign.session, entries=tuple(m.entry for m in targets))
    campaign = replace(campaign, session=session, measurements=targets)
    hidden, names = disguised(campaign, 3)
    same(diagnose(campaign), diagnose(hidden), names)
