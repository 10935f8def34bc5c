"""Whole sessions of swivels, simulated, so that their truth is known."""

from __future__ import annotations

import pytest
from simulated_swivels import campaign, run

from ssmr_ident.compare import compare
from ssmr_ident.doctor.swivels import diagnose_swivels

JOINTS = {"ground_joints": {"pitch_m": 0.03, "depth_m": 6e-4, "width_m": 6e-3}}


def test_joints_are_named_and_their_distance_found():
    found = diagnose_swivels(
        campaign(
            run(40, "calibration", {}, 1), run(40, "target", JOINTS, 2), run(28, "heldout", JOINTS, 3),
        )
    )  # fmt: skip
    assert found.verdict == "missing_physics"
    assert "ground_joints" in (found.effects[0].id, *found.effects[0].indistinguishable_from)
    assert found.heldout.recordings == ("heldout-28-3.csv",)
    assert found.heldout.after < 2.0 / 3.0 * found.heldout.before
    assert found.located[0].recording == "target-40-2.csv"
    assert found.evidence.speeds[0].recorded.shape == (2, 50)
    yaml = found.as_dict()
    assert set(yaml["fit"]) == {"metric", "training", "heldout"}
    again = compare(campaign(run(28, "heldout", JOINTS, 3)), found.after)
    assert again.overall["log_psd_db"] == pytest.approx(found.heldout.after, abs=1.5)
