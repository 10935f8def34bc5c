"""What is good enough to be named."""

from __future__ import annotations

import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.accept import within_sheet
from ssmr_ident.identify.coordinates import Model
from ssmr_ident.identify.joint import JointFit


@pytest.mark.parametrize(
    ("std", "found", "within"),
    [(10.0, 60.0, True), (10.0, 50.0, False), (None, 75.0, True), (None, 70.0, False)],
)
def test_a_sensor_is_slow_beyond_what_its_sheet_leaves_open(std: float | None, found: float, within: bool) -> None:
    model, begin = Model(()).with_effect("sensor_bandwidth", {"bandwidth_hz": found}, {})
    known = ParameterSet("robot", {"accelerometer.bandwidth_hz": Estimate(80.0, std, "Hz")})
    assert within_sheet(JointFit((), model, begin, (), (), ()), known) is within
    assert not within_sheet(JointFit((), Model(()), begin[:0], (), (), ()), known)
