"""When a pulled robot lets go."""

from __future__ import annotations

import numpy as np

from ssmr_ident.identify.trials.moments import lets_go


def test_a_robot_lets_go_where_its_force_comes_to_the_top() -> None:
    force = 40.0 * np.minimum(np.arange(200) / 120.0, 1.0)[:, None]
    assert 110 <= lets_go(force) <= 120
