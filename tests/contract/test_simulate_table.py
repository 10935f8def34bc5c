"""Every baseline in every experiment: what is simulated and written is read back and compared to nought, or refused."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments import EXPERIMENTS, Conditions
from ssmr_ident.session.entry import BASELINES
from ssmr_ident.workflows.compare import compare_session
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.simulate.run import simulate_to_file
from ssmr_ident.workflows.simulate.table import TABLE

RIG = "mass_kg: {value: 2.0}\nstiffness_N_m: {value: 20000}\ndamping_N_s_m: {value: 12}\n"
ROTOR = "inertia_kg_m2: {value: 0.02}\nstiffness_N_m_rad: {value: 200}\ndamping_N_m_s_rad: {value: 0.06}\n"
BLOCK = (
    "mass_kg: {value: 5}\nmu_static: {value: 0.5}\nmu_kinetic: {value: 0.35}\ncable: {stiffness_N_m: {value: 2500}}\n"
)
NETWORK = (
    "bodies: {table: {mass_kg: {value: 2.0}}, tip: {mass_kg: {value: 0.4}}}\n"
    "springs:\n"
    "  foot: {between: [ground, table], stiffness_N_m: {value: 90000}, damping_N_s_m: {value: 12}}\n"
    "  blade: {between: [table, tip], stiffness_N_m: {value: 7000}, damping_N_s_m: {value: 0.8}}\n"
)
FILES = {"sdof": RIG, "drag": BLOCK, "network": NETWORK}
PLACED = "acceleration: {column: table_acceleration, body: table}, position_2: {column: tip_position, body: tip}"
SHORT = {"swivel": 8.0, "straight": 8.0, "pull": 8.0, "wheel_drag": 8.0, "free_response": 2.0}
ENTRIES = {
    "free_response": {"rigid6": "motion: roll", "decoupled": "motion: roll", "network": f"channels: {{{PLACED}}}"},
    "forced": {"network": f"channels: {{{PLACED}, force: {{column: force, body: table}}}}"},
    "base_motion": {"network": f"channels: {{{PLACED}}}"},
    "swivel": {"": "yaw_rate_deg_s: 45"},
    "straight": {"": "wheel_speed_m_s: 0.3"},
    "pull": {"": "speed_mm_s: 1.0, direction: lateral"},
}
WORST = {"nrmse_percent": 0.5, "log_psd_db": 2.5}
"""Spectra of chance have a distance of their own; waveforms none but what numbers in a log are rounded to, which a
stick-slip carries on."""


def drive(folder: Path, names: str) -> str:
    time = np.arange(2000) / 500.0
    pushed = np.convolve(np.random.default_rng(3).standard_normal(2000), np.hanning(31), "same") * np.hanning(2000)
    np.savetxt(folder / "drive.csv", np.c_[time, pushed], delimiter=",", header=f"time (s),{names}", comments="")
    return str(folder / "drive.csv")


def written_and_compared(folder: Path, baseline: str, experiment: str, params: str, drives: str = "") -> float:
    options = {}
    if experiment == "forced":
        options = {"force": drive(folder, drives or "force (N)")}
    elif experiment == "base_motion":
        options = {"base": drive(folder, drives)}
    robot = baseline in ("rigid6", "decoupled")
    request = Request(
        EXPERIMENTS[experiment], Conditions(), baseline=baseline if robot else "",
        duration_s=None if options else SHORT.get(experiment), seed=3, **options,
    )  # fmt: skip
    simulate_to_file(params, request, folder / "made.csv")
    said = ENTRIES.get(experiment, {})
    more = said.get(baseline, said.get("", ""))
    (folder / "session.yaml").write_text(
        f"schema: ssmr-ident/session/1\nname: cell\nrobot: {params}\nbaseline: {baseline}\nrecordings:\n"
        f"  - {{file: made.csv, experiment: {experiment}{', ' + more if more else ''}}}\n"
    )
    result = compare_session(folder).recordings[0]
    assert result.value < WORST[result.metric], result
    return result.value


def params_of(folder: Path, baseline: str) -> str:
    if baseline not in FILES:
        return "p3at-extended"
    (folder / "rig.yaml").write_text(f"schema: ssmr-ident/parameters/1\nname: made\n{FILES[baseline]}")
    return str(folder / "rig.yaml")


def test_the_table_is_what_experiments_say_of_themselves() -> None:
    assert {(b, e) for e, cells in TABLE.items() for b in cells} == {
        (b, e) for e in EXPERIMENTS.values() for b in e.baselines
    }


CELLS = [(baseline, experiment) for baseline, experiment in product(BASELINES, EXPERIMENTS)]


@pytest.mark.slow
@pytest.mark.parametrize(("baseline", "experiment"), [c for c in CELLS if c[0] in TABLE[EXPERIMENTS[c[1]]]])
def test_a_cell_compares_to_nought(tmp_path: Path, baseline: str, experiment: str) -> None:
    drives = "base_position (m)" if experiment == "base_motion" else ""
    written_and_compared(tmp_path, baseline, experiment, params_of(tmp_path, baseline), drives)


@pytest.mark.parametrize(("baseline", "experiment"), [c for c in CELLS if c[0] not in TABLE[EXPERIMENTS[c[1]]]])
def test_a_cell_without_sense_says_so(tmp_path: Path, baseline: str, experiment: str) -> None:
    request = Request(EXPERIMENTS[experiment], baseline=baseline)
    with pytest.raises(InputError, match="is nothing for") as refused:
        simulate_to_file(params_of(tmp_path, baseline), request, tmp_path / "made.csv")
    assert "\n" not in str(refused.value)


@pytest.mark.slow
def test_a_foot_by_its_acceleration(tmp_path: Path) -> None:
    written_and_compared(tmp_path, "sdof", "base_motion", params_of(tmp_path, "sdof"), "base_acceleration (m/s^2)")


@pytest.mark.slow
@pytest.mark.parametrize(("experiment", "drives"), [("free_response", ""), ("forced", "torque (N m)")])
def test_a_rotary_rig_logs_angles_and_torques(tmp_path: Path, experiment: str, drives: str) -> None:
    (tmp_path / "rig.yaml").write_text(f"schema: ssmr-ident/parameters/1\nname: rotor\n{ROTOR}")
    written_and_compared(tmp_path, "sdof", experiment, str(tmp_path / "rig.yaml"), drives)
    assert "angle" in (tmp_path / "made.csv").read_text().splitlines()[0]
