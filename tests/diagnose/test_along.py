"""Laws begun along the measured path of a rig, against closed forms and another integrator."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_rigs import ROUGH, Run, campaign, fitted, prepared

from ssmr_ident.diagnose.along import begun_along, is_law, without_laws
from ssmr_ident.diagnose.path import LONGEST, Path, force_along, loudest, path_of
from ssmr_ident.diagnose.residual_force import oscillator
from ssmr_ident.diagnose.scan import Suspect, candidates, scan
from ssmr_ident.identify.fitting.joint import JointFit

SHAKEN = [Run(force=30.0), Run(force=12.0), Run(force=60.0)]


@pytest.mark.slow
def test_the_force_along_a_path_is_that_of_the_laws_formula() -> None:
    time = np.arange(4000) * 1e-3
    x, v = 1e-3 * np.sin(20.0 * time), 2e-2 * np.cos(20.0 * time)
    cubic = {"nonlinear_stiffness": {"k3_N_m3": 3e9}, "quadratic_damping": {"d2_N_s2_m2": 40.0}}
    assert force_along(x, v, 1e-3, 1e4, cubic) == pytest.approx(3e9 * x**3 + 40.0 * v * np.abs(v), rel=1e-12, abs=1e-12)

    # dz/dt = v - z/tau of a steady sine, Fourier: z = A wt/(1 + (wt)^2) (wt sin + cos) with wt = omega tau
    relaxed = force_along(x, v, 1e-3, 1e4, {"viscoelastic_relaxation": {"K_m_N_m": 500.0, "tau_s": 0.05}})
    steady = 500.0 * 1e-3 * 1.0 / 2.0 * (np.sin(20.0 * time) + np.cos(20.0 * time))
    assert relaxed[2000:] == pytest.approx(steady[2000:], abs=0.01 * 0.25)

    loop = {"alpha": 0.7, "yield_m": 4e-4}
    path = force_along(x, v, 1e-3, 1e4, {"hysteresis": loop})

    def wen(t: float, z: np.ndarray) -> np.ndarray:
        speed = 2e-2 * np.cos(20.0 * t)
        return speed - np.abs(z / 4e-4) ** 2 * 0.5 * (speed + np.abs(speed) * np.sign(z))

    solved = solve_ivp(wen, (0.0, time[-1]), [0.0], t_eval=time, max_step=5e-4, rtol=1e-8, atol=1e-12)
    assert path == pytest.approx(0.3 * 1e4 * (solved.y[0] - x), abs=0.01)  # of 3 N


def test_what_is_unexplained_along_a_path_is_the_hidden_force_and_what_the_rig_took_of_it() -> None:
    fit = fitted(prepared(campaign({"nonlinear_stiffness": {"k3_N_m3": 3e7}}, SHAKEN, seed=3)))
    values, _ = fit.model.split(fit.point)
    path = path_of(fit, 2, oscillator(fit, 2, 0, ROUGH))
    hidden = force_along(path.displacement, path.velocity, path.step, 0.0, {"nonlinear_stiffness": {"k3_N_m3": 3e7}})
    rest = path.unexplained - path.band(hidden)
    taken = np.linalg.lstsq(path.linear[60:-60], rest[60:-60], rcond=None)[0]
    assert np.std(rest[60:-60] - path.linear[60:-60] @ taken) < 0.15 * np.std(path.band(hidden)[60:-60])
    # the rig has 8 kg, 50 N s/m and 20 kN/m, whatever the fit has made of it
    assert values["stiffness_N_m"] + taken[2] == pytest.approx(20000.0, rel=0.02)


def test_of_a_long_recording_the_part_is_taken_in_which_most_is_unexplained() -> None:
    force = np.zeros(3 * LONGEST)
    force[LONGEST + 100 : 2 * LONGEST] = np.sin(np.arange(LONGEST - 100))
    part = loudest(force)
    assert part.stop - part.start == LONGEST
    assert LONGEST <= part.start <= LONGEST + 100
    assert loudest(force[:500]) == slice(0, 500)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "true", "tolerance"),
    [
        ("free_play", {"gap_m": 6e-4, "rounding": 0.1}, {"gap_m": 0.15}),
        ("nonlinear_stiffness", {"k3_N_m3": 1.5e9}, {"k3_N_m3": 0.15}),
        ("hysteresis", {"alpha": 0.75, "yield_m": 3e-4}, {"alpha": 0.06, "yield_m": 0.3}),
        ("viscoelastic_relaxation", {"K_m_N_m": 4000.0, "tau_s": 0.02}, {"K_m_N_m": 0.25}),
    ],
)
def test_a_law_is_begun_near_what_is_hidden(effect: str, true: dict, tolerance: dict) -> None:
    fit = fitted(prepared(campaign({effect: true}, SHAKEN, seed=5)))
    begun = _begun(fit)
    first = min(begun, key=lambda f: f.cost(begun[0].counted))
    assert first.model.ids == (effect,)
    found = first.model.split(first.point)[1][effect]
    for name, share in tolerance.items():
        assert found[name] == pytest.approx(true[name], rel=share)
    # before any step of a refit it is far ahead of the baseline
    assert np.log(first.parts).sum() < np.log(fit.parts).sum() - 3.0


@pytest.mark.slow
def test_each_formula_is_begun_once_and_what_is_no_law_is_left_to_others() -> None:
    fit = fitted(prepared(campaign({"free_play": {"gap_m": 6e-4, "rounding": 0.1}}, SHAKEN, seed=6)))
    groups = scan(fit, candidates(fit, "sdof"))
    begun = _begun(fit)
    forms = [(f.model.ids, tuple(c.parameter.name for c in f.model.free)) for f in begun]
    assert len(set(forms)) == len(forms) >= 8
    rest = [suspect for group in without_laws(groups) for suspect in group]
    assert {s.effect for s in rest} >= {"unlisted"}
    assert not any(is_law(s) for s in rest)
    assert all(is_law(s) for group in groups for s in group if s not in rest)


@pytest.mark.slow
def test_a_law_whose_force_is_no_number_is_not_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    fit = fitted(prepared(campaign({"free_play": {"gap_m": 6e-4, "rounding": 0.1}}, SHAKEN, seed=6)))
    monkeypatch.setattr(
        Path, "force", lambda path, _, effects: path.unexplained * (np.nan if "free_play" in effects else 1.0)
    )
    begun = _begun(fit)
    assert begun
    assert all("free_play" not in f.model.ids for f in begun)


def _begun(fit: JointFit) -> list[JointFit]:
    suspects: list[Suspect] = [s for group in scan(fit, candidates(fit, "sdof")) for s in group]
    return begun_along(fit, suspects)
