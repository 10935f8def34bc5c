"""Where contacts let go, an effect is begun at several sizes: its straight line passes over corners."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.diagnose.explore import STRIDES, strides
from ssmr_ident.diagnose.scan import Suspect


def suspect(effect: str, at: dict[str, float], sizes: dict[str, float] | None = None) -> Suspect:
    return Suspect(effect, at, {}, sizes or {}, 10.0, np.zeros(0))


def test_what_grows_from_nothing_is_begun_larger_and_its_shape_is_kept() -> None:
    found = strides([suspect("free_play", {"gap_m": 1e-5, "rounding": 0.2})])
    assert [s.at["gap_m"] for s in found] == pytest.approx([1e-5 * stride for stride in (1.0, *STRIDES)])
    assert {s.at["rounding"] for s in found} == {0.2}


def test_a_stiffness_that_is_off_at_infinity_is_begun_softer_and_a_sign_is_left_alone() -> None:
    cable, cubic = (
        strides([suspect("cable_compliance", {"K_cable_N_m": 1e6})]),
        strides([suspect("nonlinear_stiffness", {"k3_N_m3": 1e7}, {"k3_N_m3": 1e7})]),
    )
    assert [s.at["K_cable_N_m"] for s in cable] == pytest.approx([1e6 / stride for stride in (1.0, *STRIDES)])
    assert [s.at["k3_N_m3"] for s in cubic] == [1e7]


def test_no_size_leaves_what_an_effect_can_have() -> None:
    found = strides([suspect("free_play", {"gap_m": 0.01})])
    assert [s.at["gap_m"] for s in found] == [0.01, 0.02, 0.02]
