"""What is good enough to be named."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.accept import within_file
from ssmr_ident.identify.coordinates import Model
from ssmr_ident.identify.joint import JointFit
from ssmr_ident.identify.objective import Unknown


@pytest.mark.parametrize(
    ("std", "found", "within"),
    [(10.0, 60.0, True), (10.0, 50.0, False), (None, 75.0, True), (None, 70.0, False)],
)
def test_a_sensor_is_slow_beyond_what_its_sheet_leaves_open(std: float | None, found: float, within: bool) -> None:
    model, begin = Model(()).with_effect("sensor_bandwidth", {"bandwidth_hz": found}, {})
    known = ParameterSet("robot", {"accelerometer.bandwidth_hz": Estimate(80.0, std, "Hz")})
    assert within_file(JointFit((), model, begin, (), (), ()), known) is within
    assert not within_file(JointFit((), Model(()), begin[:0], (), (), ()), known)


@pytest.mark.parametrize(("offset", "within"), [(0.008, True), (0.012, False)])
def test_a_centre_of_mass_is_off_beyond_what_the_file_leaves_open(offset: float, within: bool) -> None:
    shift = Unknown("contact_shift_y_m", "m", 0.0, 0.003, positive=False)
    at = {"offset_x_m": 0.0, "offset_y_m": offset}
    model, begin = Model((shift,)).with_effect("com_offset", at, {"offset_x_m": 0.01, "offset_y_m": 0.01})
    fit = JointFit((), model, np.concatenate([[0.0], begin]), (), (), ())
    assert within_file(fit, ParameterSet("robot", {})) is within
