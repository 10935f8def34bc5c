"""A robot whose baseline turns about its axes alone: what it lacks is that it moves along them."""

from __future__ import annotations

import pytest
from bank import draw

from ssmr_ident.workflows.diagnose import diagnose


@pytest.mark.slow
def test_that_a_robot_moves_along_its_axes_is_named() -> None:
    found = diagnose(draw("decoupled", "one", 910001, short=True).campaign)
    assert [(e.id, e.kind, e.element) for e in found.effects] == [("translation_coupling", "geometry", "body")]
    assert found.heldout.after < 0.5 * found.heldout.before
