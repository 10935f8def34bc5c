"""Words of the fit: findings over speeds, the printed report."""

from __future__ import annotations

import lmfit
import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.identify.decays.fit import fit_decay
from ssmr_ident.identify.decays.result import whitened_residual
from ssmr_ident.identify.lmfit_report import Variable, variables_report
from ssmr_ident.report.text_fit import fit_report
from ssmr_ident.workflows.fit.speeds import AtSpeed, rate_findings, slip_findings


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


def test_lmfit_agrees_with_the_search_and_prints_units() -> None:
    """Polishing by lmfit on the whitened residual moves nothing; its table shows the covariance of the search."""
    times = np.arange(2048) * 1e-3
    noise = 0.01 * np.random.default_rng(4).normal(size=2048)
    fit = fit_decay(times, 0.3 + np.exp(-2.0 * times) * np.sin(50 * times + 0.3) + noise, unit="m/s^2")
    result = fit.minimize()
    mode = fit.modes[0]
    assert abs(result.params["omega_n_1"].value - mode.omega_n) < 0.01 * mode.omega_n_std
    assert abs(result.params["xi_1"].value - mode.xi) < 0.01 * mode.xi_std
    assert result.params["xi_1"].stderr == pytest.approx(mode.xi_std)
    assert result.params["xi_1"].correl["omega_n_1"] == pytest.approx(mode.correlation)
    text = fit.report()
    for part in ("[[Fit Statistics]]", "omega_n_1:", "rad/s", "+/-", "m/s^2", "[[Correlations]]"):
        assert part in text


def test_lmfit_covariance_is_that_of_the_search() -> None:
    """lmfit's own standard deviations, from its own derivatives, for a white residual."""
    times = np.arange(2048) * 1e-3
    noise = 0.01 * np.random.default_rng(5).normal(size=2048)
    fit = fit_decay(times, np.exp(-2.0 * times) * np.sin(50 * times + 0.3) + noise)
    parameters = lmfit.Parameters()
    parameters.add("omega_n", value=fit.modes[0].omega_n)
    parameters.add("xi", value=fit.modes[0].xi)

    def residual(now: lmfit.Parameters) -> np.ndarray:
        return whitened_residual(fit.blocks, np.array([now["omega_n"].value]), np.array([now["xi"].value]))

    own = lmfit.minimize(residual, parameters)
    assert own.params["omega_n"].stderr == pytest.approx(fit.modes[0].omega_n_std, rel=0.02)
    assert own.params["xi"].stderr == pytest.approx(fit.modes[0].xi_std, rel=0.02)


def test_names_that_python_does_not_take_come_back_whole() -> None:
    rows = [Variable("tire.mu on tile", 0.7, 0.1, "1", 0.8, 0.2, "data"), Variable("mass_kg", 30.0, 1.0, "kg")]
    text = "\n".join(variables_report(rows, {("tire.mu on tile", "mass_kg"): -0.9}))
    assert "tire.mu on tile: 0.70000000 +/- 0.10000000 (14.29%)" in text
    assert "C(tire.mu on tile, mass_kg) = -0.9000" in text
    assert "(init = 0.8 ± 0.2)  [data]" in text
