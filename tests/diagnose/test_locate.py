"""A residual put at a known place in time, frequency and state is found there; noise is not located."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import NOISE, ROUGH, Run, campaign, fitted, prepared

from ssmr_ident.diagnose.locate import located
from ssmr_ident.diagnose.motion import filtered, motion_of
from ssmr_ident.diagnose.ordering import ordering
from ssmr_ident.diagnose.quantity import prefixed
from ssmr_ident.diagnose.residual_force import highest, unexplained_force
from ssmr_ident.diagnose.surface import surfaces
from ssmr_ident.identify.fitting.joint import JointFit, evaluate

RELEASED = [Run(0.004), Run(0.002)]
SHAKEN = [Run(force=30.0), Run(force=15.0)]


def test_a_burst_is_found_in_its_recording_time_and_band() -> None:
    setup = prepared(campaign({}, RELEASED, seed=2))
    quiet = fitted(setup)
    assert located(quiet, ROUGH) == ()
    trial = quiet.trials[1]
    inside = (trial.times > 1.0) & (trial.times < 1.5)
    burst = 4.0 * NOISE * np.sin(2.0 * np.pi * 40.0 * trial.times) * inside
    spoilt = replace(trial, target=trial.target + burst[:, None])
    fit = evaluate([quiet.trials[0], spoilt], quiet.model, quiet.point, quiet.nuisances)
    (place, *others) = located(fit, ROUGH)
    assert (place.recording, place.channel) == ("run-1.csv", "position")
    assert place.time_s[0] == pytest.approx(1.0, abs=0.15)
    assert place.time_s[1] == pytest.approx(1.5, abs=0.15)
    assert place.band_hz[0] < 40.0 < place.band_hz[1] < 50.0
    assert place.share > 0.7
    assert not others
    assert "run-1.csv" in place.sentence
    assert f"{100 * place.share:.0f} %" in place.sentence


@pytest.mark.parametrize(
    ("effects", "variable"),
    [({"nonlinear_stiffness": {"k3_N_m3": 3e7}}, "displacement"), ({"dry_friction": {"F_c_N": 2.0}}, "velocity")],
)
def test_the_force_left_over_follows_the_variable_of_its_law(effects: dict, variable: str) -> None:
    fit = fitted(prepared(campaign(effects, SHAKEN, seed=3)))
    places = located(fit, ROUGH)
    assert any(f"follows the {variable}" in place.sentence for place in places)
    assert sum(place.share for place in places) <= 1.0 + 1e-9


def test_the_unexplained_force_is_the_law_less_what_the_baseline_took_over() -> None:
    fit, after = _pair({"nonlinear_stiffness": {"k3_N_m3": 3e7}})
    values, _ = fit.model.split(fit.point)
    for index, trial in enumerate(fit.trials):
        motion = motion_of(trial, trial.target[:, 0], 0)
        x, v = motion.displacement, motion.velocity
        taken = (values["stiffness_N_m"] - 20000.0) * x + (values["damping_N_s_m"] - 50.0) * v
        force = unexplained_force(fit, index, 0, ROUGH)
        band = highest(trial.colour(fit.simulated[index])[:, 0], trial, 0, 8.0)
        expected = filtered(3e7 * x**3 - taken, trial.step, np.ones_like, 0.0, band)
        inner = slice(60, -60)
        assert np.corrcoef(force[inner], expected[inner])[0, 1] > 0.95
        assert np.std(force[inner]) == pytest.approx(np.std(expected[inner]), rel=0.1)
    (surface,) = surfaces(fit, after, ROUGH)
    assert surface.before.std() > 4.0 * surface.after.std()
    assert surface.units == ("m", "m/s", "N")
    assert np.corrcoef(surface.displacement**3, surface.before)[0, 1] > 0.5  # as far as no spring took it over


@pytest.mark.slow
def test_no_variable_is_named_where_the_force_is_noise() -> None:
    rng = np.random.default_rng(4)
    named = 0
    for seed in range(60):
        time = np.arange(400) / 250.0
        coloured = np.convolve(rng.standard_normal(430), np.ones(31) / 31.0, "valid")
        phase = rng.uniform(0.0, 2.0 * np.pi)
        variables = {
            "displacement": (np.sin(40.0 * time + phase) * np.exp(-time), "m"),
            "velocity": (np.cos(40.0 * time + phase) * np.exp(-time), "m/s"),
            "time": (time, "s"),
        }
        named += ordering(coloured, variables, seed).p_value < 0.01
    assert named <= 4  # two looks at 1 % each give 1.2


def test_quantities_are_said_in_thousandths() -> None:
    assert prefixed(3.2e-5, "m") == "32 µm"
    assert prefixed(0.0031, "m/s") == "3.1 mm/s"
    assert prefixed(1234.0, "N/m") == "1200 N/m"


def _pair(effects: dict) -> tuple[JointFit, JointFit]:
    setup = prepared(campaign(effects, SHAKEN, seed=3))
    return fitted(setup), fitted(setup, effects)
