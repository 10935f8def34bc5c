"""``ident fit`` of rigs whose motion is made by scipy's integrator or in closed form: known parameters come back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.doctor.run import diagnose
from ssmr_ident.experiments.campaign import Campaign, Measurement, load
from ssmr_ident.session import Entry, Session, write_parameters
from ssmr_ident.workflows.fit.result import SessionFit
from ssmr_ident.workflows.fit.run import fit_campaign

Array = np.ndarray

MASS, DAMPING, STIFFNESS, RATE = 2.0, 5.0, 3000.0, 200.0
"""6.2 Hz, damping ratio 3.2 %."""

UNITS = {"force": "N", "position": "m", "acceleration": "m/s^2"}


def known(mass_std: float | None = 0.02, stiffness: float = 4000.0, spring: bool = True) -> ParameterSet:
    """A file whose spring and damper are far off."""
    return ParameterSet(
        "rig",
        {
            "mass_kg": Estimate(MASS if spring else 80.0, mass_std, "kg", "weighed"),
            "damping_N_s_m": Estimate(12.0, None, "N s/m"),
            "stiffness_N_m": Estimate(stiffness if spring else 0.0, None, "N/m", fixed=not spring),
        },
        file="rig.yaml",
    )


def campaign(
    experiment: str, logs: list[Mapping[str, Array]], parameters: ParameterSet, rate: float = RATE, kept: int = 0
) -> Campaign:
    """Recordings by quantity; the last ``kept`` are held out."""
    measurements = []
    for number, log in enumerate(logs):
        name = f"run-{number}.csv"
        count = len(next(iter(log.values())))
        channels = tuple(Channel(quantity, samples, UNITS[quantity]) for quantity, samples in log.items())
        role = "heldout" if number >= len(logs) - kept else "target"
        recording = Recording(np.arange(count) / rate, channels, Provenance(name, "", "test"))
        measurements.append(Measurement(Entry(name, experiment, role=role), recording))
    session = Session("rig", Path(), "rig.yaml", "sdof", tuple(m.entry for m in measurements))
    return Campaign(session, parameters, tuple(measurements))


def let_go(x0: float, seconds: float, cubic: float = 0.0) -> tuple[Array, Array]:
    """Position and acceleration of a mass on a spring that hardens or softens."""

    def rate(_: float, state: Array) -> list[float]:
        return [state[1], -(DAMPING * state[1] + STIFFNESS * state[0] + cubic * state[0] ** 3) / MASS]

    times = np.arange(round(seconds * RATE)) / RATE
    x, v = solve_ivp(rate, (0.0, seconds), [x0, 0.0], t_eval=times, rtol=1e-9, atol=1e-12).y
    return x, -(DAMPING * v + STIFFNESS * x + cubic * x**3) / MASS


def shaken(seed: int) -> dict[str, Array]:
    """Position under a force of twelve tones, in closed form, from the begin of its steady state."""
    rng = np.random.default_rng(seed)
    turns = 2.0 * np.pi * rng.uniform(1.0, 14.0, 12)
    phases = rng.uniform(0.0, 2.0 * np.pi, 12)
    times = np.arange(2000)[:, None] / RATE
    waves = 3.0 * np.exp(1j * (turns * times + phases))
    x = (waves / (STIFFNESS - MASS * turns**2 + 1j * DAMPING * turns)).sum(axis=1).real
    return {"force": waves.sum(axis=1).real, "position": x + 0.01 * x.std() * rng.standard_normal(len(x))}


def near(fit: SessionFit, truth: Mapping[str, float], share: float = 0.0) -> None:
    for key, value in truth.items():
        std = fit.parameters[key].std
        assert std is not None
        assert abs(fit.parameters.number(key) - value) < 3.5 * std + share * value


def test_a_shaken_rig_comes_back_with_its_mass() -> None:
    fit = fit_campaign(campaign("forced", [shaken(1), shaken(2)], known(mass_std=None)))
    near(fit, {"mass_kg": MASS, "damping_N_s_m": DAMPING, "stiffness_N_m": STIFFNESS})
    # a gain that is off by 2 % in either recording looks like another mass
    assert fit.parameters["mass_kg"].std == pytest.approx(0.02 * MASS / np.sqrt(2.0), rel=0.1)
    assert fit.results["run-0.csv"]["xi"] == pytest.approx(DAMPING / (2.0 * np.sqrt(STIFFNESS * MASS)), rel=0.02)


def test_a_decay_tells_ratios_and_no_more() -> None:
    rng = np.random.default_rng(3)
    x, _ = let_go(5e-3, 6.0)
    noisy = x + 2e-5 * rng.standard_normal(len(x))
    fit = fit_campaign(campaign("free_response", [{"position": noisy}], known()))
    near(fit, {"damping_N_s_m": DAMPING, "stiffness_N_m": STIFFNESS})
    assert fit.parameters["mass_kg"] == replace(known()["mass_kg"], source="prior: weighed")
    # a hundredth of the mass is a hundredth of both
    assert fit.parameters["stiffness_N_m"].std == pytest.approx(0.01 * STIFFNESS, rel=0.05)
    assert any("only as ratios to mass_kg" in text for text in fit.findings)
    assert any("the file's mass and stiffness mean" in text for text in fit_campaign(
        campaign("free_response", [{"position": noisy}], known(stiffness=9000.0))).findings)  # fmt: skip


def test_only_the_motions_that_channels_name_are_compared(tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    x, _ = let_go(5e-3, 3.0)
    rows = zip(np.arange(len(x)) / RATE, x, rng.standard_normal(len(x)), strict=True)
    text = "\n".join(f"{t:.4f},{y:.7f},{a:.4f}" for t, y, a in rows)
    (tmp_path / "log.csv").write_text(f"time [s],position [m],acceleration [m/s^2]\n{text}\n")
    write_parameters(tmp_path / "rig.yaml", known())
    (tmp_path / "session.yaml").write_text(
        "schema: ssmr-ident/session/1\nname: one\nrobot: rig.yaml\nbaseline: sdof\nrecordings:\n"
        "  - {file: log.csv, experiment: free_response, channels: {position: position}}\n"
    )
    (log,) = load(tmp_path).measurements
    assert log.recording.names == ("position",)


def test_clipped_samples_are_not_compared() -> None:
    rng = np.random.default_rng(4)
    _, a = let_go(5e-3, 6.0)
    logged = np.clip(a + 0.02 * rng.standard_normal(len(a)), -3.0, 3.0)
    fit = fit_campaign(campaign("free_response", [{"acceleration": logged}], known()))
    assert any("clipped samples of acceleration are not compared" in text for text in fit.findings)
    xi = fit.results["run-0.csv"]
    assert abs(xi["xi"] - DAMPING / (2.0 * np.sqrt(STIFFNESS * MASS))) < 3.5 * xi["xi_std"]


def test_a_spring_that_softens_has_the_stiffness_of_a_small_motion() -> None:
    rng = np.random.default_rng(5)
    logs = [{"position": x + 1e-5 * rng.standard_normal(len(x))} for x, _ in (let_go(5e-3, 8.0, -4e7),)]
    fit = fit_campaign(campaign("free_response", logs, known()))
    assert fit.parameters.number("stiffness_N_m") == pytest.approx(STIFFNESS, rel=0.01)
    assert fit.parameters.number("damping_N_s_m") == pytest.approx(DAMPING, rel=0.05)
    rows = fit.results["run-0.csv"]["over_amplitude"]
    assert rows[0]["omega_n_rad_s"] < 0.97 * rows[-1]["omega_n_rad_s"]
    assert any("softening" in text for text in fit.findings)
    assert json.loads(json.dumps(fit.as_dict()))["recordings"][0]["over_amplitude"] == rows


@pytest.mark.slow
def test_a_drive_without_a_spring_has_its_friction() -> None:
    """Position is prescribed and the force computed from it, so the truth is exact."""
    rng = np.random.default_rng(13)
    times = np.arange(6000) / 500.0
    turns, sizes = np.array([0.9, 5.1]), np.array([0.1, 0.02])
    angle = turns * times[:, None] + np.array([0.0, 1.0])
    x, v, a = ((sizes * turns**n * np.sin(angle + 0.5 * np.pi * n)).sum(axis=1) for n in range(3))
    force = 95.0 * a + 204.0 * v + 20.0 * np.sign(v) - 3.0 + 0.2 * rng.standard_normal(len(v))
    log = {"force": force, "position": x + 1e-6 * rng.standard_normal(len(x))}
    made = campaign("forced", [log], known(mass_std=None, spring=False), rate=500.0)
    fit = fit_campaign(made)
    near(fit, {"mass_kg": 95.0, "damping_N_s_m": 204.0}, share=0.01)
    assert float(fit.parameters.effects["dry_friction"]["F_c_N"].value) == pytest.approx(20.0, rel=0.05)
    assert fit.results["run-0.csv"]["drive_zero"] == pytest.approx(3.0, abs=0.3)
    assert any("only together" in text for text in fit.findings)
    plain = fit_campaign(made, coulomb=False)
    assert "dry_friction" not in plain.parameters.effects
    assert plain.parameters.number("damping_N_s_m") > 1.3 * 204.0  # what the friction had been hidden in


@pytest.mark.slow
def test_a_diagnosis_begins_with_what_a_fit_says() -> None:
    made = campaign("forced", [shaken(seed) for seed in (1, 2, 3)], known(), kept=1)
    fit, before = fit_campaign(made), diagnose(made).before
    for key in ("mass_kg", "damping_N_s_m", "stiffness_N_m"):
        std = fit.parameters[key].std
        assert std is not None
        assert fit.parameters.number(key) == pytest.approx(before.number(key), abs=0.05 * std)
        assert std == pytest.approx(before[key].std, rel=0.1)
