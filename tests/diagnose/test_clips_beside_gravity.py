"""An accelerometer clips where it reads most: on the axis that carries gravity, beside what it reads at rest."""

from __future__ import annotations

import numpy as np
import pytest
from bank import draw
from bank.truth import BankSession

from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.diagnose.sizes import sizes_of
from ssmr_ident.doctor.robots.calibrated import baseline_of
from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

SEED, LIMIT = 500006, 10.315


@pytest.fixture(scope="module")
def drawn() -> BankSession:
    return draw("decays", "one", SEED, effect="sensor_saturation", size=0.8125, short=True)


def test_probes_clip_the_motion_and_leave_gravity(drawn: BankSession) -> None:
    known = drawn.campaign.parameters
    setup = set_up(drawn.campaign, known)
    sizes = sizes_of(baseline_of(setup.fitted, setup.model))
    assert sizes["weight"] == pytest.approx(9.81, rel=0.05)
    ranges = [
        p.value(sizes)
        for probe in CATALOGUE["sensor_saturation"].probes
        for p in probe.values()
        if not isinstance(p, float) and p.above
    ]
    assert len(ranges) == 2
    assert all(9.81 < value < 10.6 for value in ranges)


def test_a_sensor_that_clips_beside_gravity_is_named(drawn: BankSession) -> None:
    assert drawn.truth.effects["sensor_saturation"]["range_m_s2"] == pytest.approx(LIMIT, abs=1e-3)
    found = diagnose(drawn.campaign, seed=SEED)
    assert [effect.id for effect in found.effects] == ["sensor_saturation"]
    assert found.effects[0].parameters["range_m_s2"].value == pytest.approx(LIMIT, abs=0.05)
    assert found.heldout.after < found.heldout.before


def test_pulls_have_no_gravity_to_read() -> None:
    pulled = draw("block", "none", 3)
    setup = set_up(pulled.campaign, pulled.campaign.parameters)
    sizes = sizes_of(baseline_of(setup.fitted, setup.model))
    assert np.isnan(sizes["weight"])
    assert np.isnan(sizes["beyond_weight"])


def test_an_axis_that_carries_gravity_has_another_range_than_level_ones() -> None:
    """A range below what an axis reads at rest would leave one number of it."""
    time = np.linspace(0.0, 1.0, 500)
    swing = 2.0 * np.exp(-time) * np.sin(40.0 * time)
    clip = CATALOGUE["sensor_saturation"].acts[Site.OUTPUT]
    assert clip is not None
    limits = dict.fromkeys(("range_N", "range_m", "range_m_s", "range_rad", "range_rad_s"), np.inf)
    clipped = clip(time, {"ax": swing, "az": 9.81 + swing}, range_m_s2=1.3, **limits)
    assert np.abs(clipped["ax"]).max() == 1.3
    assert np.array_equal(clipped["az"], 9.81 + swing)
    beside = clip(time, {"ax": swing, "az": 9.81 + swing}, range_m_s2=10.3, **limits)
    assert beside["az"].max() == 10.3
    assert np.array_equal(beside["ax"], swing)
