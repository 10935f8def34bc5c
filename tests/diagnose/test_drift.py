"""Parameters drift as harmonic balance says: friction as 1/A, hardening as A², play above a threshold, nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.diagnose.drift import drifts
from ssmr_ident.diagnose.evidence import Drift
from ssmr_ident.diagnose.reading import reading

RELEASED = [Run(0.004), Run(0.002), Run(0.001)]
SHAKEN = [Run(force=20.0), Run(force=40.0)]


@pytest.mark.parametrize(
    ("effects", "runs", "parameter", "word"),
    [
        ({"dry_friction": {"F_c_N": 0.5}}, RELEASED, "damping_N_s_m", "1/amplitude"),
        ({"dry_friction": {"F_c_N": 2.0}}, SHAKEN, "damping_N_s_m", "1/amplitude"),
        ({"nonlinear_stiffness": {"k3_N_m3": 6e8}}, RELEASED, "stiffness_N_m", "hardening"),
        ({"nonlinear_stiffness": {"k3_N_m3": 1e7}}, SHAKEN, "stiffness_N_m", "hardening"),
        ({"quadratic_damping": {"d2_N_s2_m2": 400.0}}, RELEASED, "damping_N_s_m", "quadratic"),
        ({"free_play": {"gap_m": 1e-4}}, SHAKEN, "stiffness_N_m", "play"),
    ],
)
def test_a_drift_is_read_as_its_law(effects: dict, runs: list[Run], parameter: str, word: str) -> None:
    found = drifts(fitted(prepared(campaign(effects, runs, seed=1))))
    read = {(drift.parameter, drift.along): drift for drift in found if drift.reading}
    assert (parameter, "amplitude") in read
    assert word in read[parameter, "amplitude"].reading


def test_dry_friction_drifts_by_the_size_that_harmonic_balance_gives() -> None:
    # an equivalent damper of 4 F/(pi ω A) beside the rig's own
    fit = fitted(prepared(campaign({"dry_friction": {"F_c_N": 2.0}}, SHAKEN, seed=1)))
    drift = next(d for d in drifts(fit) if (d.parameter, d.along) == ("damping_N_s_m", "amplitude"))
    whole = fit.model.split(fit.point)[0]["damping_N_s_m"]
    speed = 50.0 * drift.position  # ω A at 8 Hz
    expected = (50.0 + 4.0 * 2.0 / (np.pi * speed)) / whole
    middle = slice(3, None)  # at the smallest motions a straight line from the whole fit's damping falls short
    assert np.all(np.abs(drift.value - expected)[middle] < 0.15)


@pytest.mark.slow
def test_nothing_is_read_where_nothing_drifts() -> None:
    read: list[Drift] = []
    for seed in range(8):
        fit = fitted(prepared(campaign({}, RELEASED if seed % 2 else SHAKEN, seed=100 + seed)))
        found = drifts(fit)
        assert found
        assert all(np.all(np.isfinite(d.value)) and np.all(d.std > 0.0) for d in found)
        read += [drift for drift in found if drift.reading]
    assert len(read) <= 1  # 5 % each in 8 sessions give 0.4


def test_a_side_that_differs_is_an_asymmetry() -> None:
    drift = Drift("stiffness_N_m", "side", "1", np.array([-1.0, 1.0]), np.array([0.9, 1.1]), np.full(2, 0.01), 0.001)
    assert reading(drift, 8) == "stiffness differs by 20 % between the two sides: an asymmetry"
    assert reading(drift, 80) == ""
