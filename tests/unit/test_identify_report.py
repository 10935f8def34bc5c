"""Words of the fit: findings over speeds, the printed report."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.pipeline.fit_speeds import AtSpeed, rate_findings, slip_findings
from ssmr_ident.report.text_fit import fit_report


def test_relaxing_tire_is_named() -> None:
    slow, fast = AtSpeed("a", 3e-4, 23900.0, 60.0), AtSpeed("b", 1e-3, 26300.0, 60.0)
    (text,) = rate_findings([fast, slow], "dragged sideways")
    assert "viscoelastic" in text
    assert "23.9 N/mm at 0.3 mm/s" in text
    assert rate_findings([slow, AtSpeed("c", 1e-3, 23950.0, 60.0)], "dragged sideways") == []
    assert rate_findings([slow], "dragged sideways") == []


def test_friction_over_slip_speed() -> None:
    rng = np.random.default_rng(0)
    speeds = np.linspace(0.005, 0.09, 9)
    values = 0.1 + 0.75 * np.maximum(0, 1 - speeds / 0.04) + 0.005 * rng.normal(size=9)
    levels = [AtSpeed(str(k), s, v, 0.005) for k, (s, v) in enumerate(zip(speeds, values, strict=True))]
    (text,) = slip_findings(levels)
    assert "flat 0.1" in text or "flat 0.09" in text
    (short,) = slip_findings(levels[:3])
    assert "five speeds" in short
    assert slip_findings([]) == []


def test_report_shows_value_std_unit_prior_and_source() -> None:
    before = ParameterSet(
        "robot",
        {
            "mass_kg": Estimate(32.0, 5.0, "kg", "scale"),
            "tire.mu_static": Estimate(0.8, None, "1"),
            "points": Estimate(np.zeros(3), None, "m"),
        },
    )
    after = before.updated({"mass_kg": Estimate(30.0, 0.2, "kg", "fit of the recordings")})
    text = fit_report(
        "s", ["2 recordings"], {"a.csv": ["roll", "more"]}, ["t 1"], before, after,
        ["mass_kg", "tire.mu_static", "points"], [("mass_kg", "tire.mu_static", 0.97)], [],
    )  # fmt: skip
    for part in (
        "30.0000000 +/- 0.20000000 (0.67%)",
        " kg ",
        "(init = 32 ± 5)",
        "[fit of the recordings]",
        "C(mass_kg, tire.mu_static) = +0.9700",
        "a.csv: roll",
    ):
        assert part in text
    assert "agree" in text
