"""Tires go five times as far lengthwise: what hardens there alone is found beside pulls that show nothing of it."""

from __future__ import annotations

import numpy as np
import pytest
from made_pulls import made_pulls

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.explore import search
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.sizes import sizes_of

K3 = 1.2e6
"""N/m^3: a third of the tire's stiffness at 30 mm, nothing at the 4 mm of a lateral pull."""

PULLS = (("lateral", 1.0, 6e-3), ("lateral", 0.5, 6e-3), ("longitudinal", 2.0, 30e-3), ("longitudinal", 3.0, 30e-3))


@pytest.fixture(scope="module")
def pulled() -> tuple[Setup, ParameterSet]:
    return made_pulls(PULLS, {"nonlinear_stiffness": {"k3_N_m3": K3}}, 3)


def test_hardening_is_found_in_the_direction_that_goes_far(pulled: tuple[Setup, ParameterSet]) -> None:
    setup, known = pulled
    base, lengths = best_baseline(setup.fitted, setup, known)
    load = max(float(np.ptp(t.target)) for t in base.trials)
    sizes = sizes_of(base)
    values, _ = base.model.split(base.point)
    assert sizes["reach"] == pytest.approx(load / (4.0 * values["tire.stiffness_x_N_m"]), rel=0.1)
    assert sizes["deflection"] < 0.3 * sizes["reach"]
    left = {t.name: p / t.size for t, p in zip(base.trials, base.parts, strict=True)}
    assert max(left.values()) > 20.0
    first = search(base, "rigid6", lengths).tried[0]
    assert first.model.ids == ("nonlinear_stiffness",)
    assert first.model.split(first.point)[1]["nonlinear_stiffness"]["k3_N_m3"] == pytest.approx(K3, rel=0.1)
    assert np.max(first.parts / [t.size for t in first.trials]) < 4.0
