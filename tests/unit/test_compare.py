"""Simulation against recordings: metric, contract, nuisances."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.compare import Prediction, compare
from ssmr_ident.compare.comparison import measure
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.experiments import FORCED
from ssmr_ident.experiments.campaign import load
from ssmr_ident.experiments.pull import pull
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import read_parameters, write_parameters
from ssmr_ident.simulate.many import simulate_alike
from ssmr_ident.workflows.compare import compare_session
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.simulate.run import simulate_to_file

RIG = """\
schema: ssmr-ident/parameters/1
name: rig
mass_kg: {value: 8.0, unit: kg}
stiffness_N_m: {value: 20000, unit: N/m}
damping_N_s_m: {value: 50, unit: N s/m}
"""


@pytest.fixture
def rig_session(tmp_path: Path) -> Path:
    """A rig driven by noise, recorded with an offset in force and acceleration, and a cubic spring."""
    random = np.random.default_rng(3)
    force = np.convolve(random.standard_normal(3000), np.hanning(25), "same")
    time = np.arange(3000) / 1000
    np.savetxt(
        tmp_path / "drive.csv", np.column_stack([time, force]), delimiter=",", header="time [s],force [N]", comments=""
    )
    (tmp_path / "rig.yaml").write_text(RIG)
    (tmp_path / "true.yaml").write_text(
        RIG + "effects: {nonlinear_stiffness: {k3_N_m3: {value: 5.0e+9, unit: N/m^3}}}\n"
    )
    simulate_to_file(
        str(tmp_path / "true.yaml"), Request(FORCED, force=str(tmp_path / "drive.csv")), tmp_path / "made.csv"
    )
    made = np.loadtxt(tmp_path / "made.csv", delimiter=",", skiprows=1)
    made[:, 1] += 0.7  # the force sensor's zero
    made[:, 4] += 0.05 + 1e-3 * random.standard_normal(3000)
    header = (tmp_path / "made.csv").read_text().splitlines()[0]
    np.savetxt(
        tmp_path / "log.csv",
        made[:, [0, 1, 4]],
        delimiter=",",
        comments="",
        header=header.split(",", 1)[0] + ",F [N],a [m/s^2]",
    )
    (tmp_path / "session.yaml").write_text(
        "schema: ssmr-ident/session/1\nname: rig\nrobot: rig.yaml\nbaseline: sdof\nrecordings:\n"
        "  - {file: log.csv, experiment: forced, channels: {force: F, acceleration: a}}\n"
    )
    return tmp_path


def test_the_truth_leaves_noise_and_the_baseline_does_not(rig_session: Path) -> None:
    before = compare_session(rig_session)
    after = compare_session(rig_session, str(rig_session / "true.yaml"))
    assert before.recordings[0].metric == "nrmse_percent"
    assert before.overall["nrmse_percent"] > 10 * after.overall["nrmse_percent"]
    assert after.overall["nrmse_percent"] < 1.0


def test_json_is_what_the_contract_says(rig_session: Path) -> None:
    result = json.loads(json.dumps(compare_session(rig_session).as_dict()))
    assert set(result) == {"session", "params", "recordings", "overall"}
    row = result["recordings"][0]
    assert set(row) == {"file", "experiment", "metric", "value", "channels"}
    assert list(row["channels"]) == ["acceleration"]


@pytest.mark.slow
def test_plots_and_table_are_written_where_asked(rig_session: Path, tmp_path: Path) -> None:
    compare_session(rig_session, output=tmp_path / "out", command="ident compare rig -o out")
    assert (tmp_path / "out" / "log.png").stat().st_size > 10_000
    assert (tmp_path / "out" / "compare.csv").read_text().splitlines()[0] == "file,experiment,metric,channel,value"
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "ident compare rig -o out" in page
    for file in ("session.yaml", "rig.yaml", "log.csv"):
        assert f"{hashlib.sha256((rig_session / file).read_bytes()).hexdigest()}  {file}" in page


@pytest.mark.slow
@pytest.mark.parametrize("file", ["roll-2.xlsx", "pitch-3.xlsx", "yaw-1.xlsx"])
def test_a_decay_is_explained_by_its_own_parameters_whatever_its_start(root: Path, file: str) -> None:
    """With the generator's parameters the main channel is left with noise, with others it is not."""
    folder = root / "data" / "raw" / "free_response"
    campaign = load(folder)
    chosen = tuple(m for m in campaign.measurements if m.entry.file == file)
    campaign = replace(campaign, measurements=chosen)
    truth = read_parameters(folder / "truth.yaml")
    axis = "ax" if file.startswith("pitch") else "ay"
    right = compare(campaign, truth).recordings[0].channels[axis]
    key = "tire.stiffness_x_N_m" if axis == "ax" else "tire.stiffness_y_N_m"
    wrong_set = truth.updated({key: replace(truth[key], value=1.1 * truth[key].value)})
    wrong = compare(campaign, wrong_set).recordings[0].channels[axis]
    assert right < 6.0
    assert wrong > 2.0 * right


@pytest.mark.compiles
def test_a_pull_finds_slack_and_zero(tmp_path: Path) -> None:
    robot = robot_from_parameters(read_parameters("p3at-extended"))
    (pulled,) = simulate_alike([(robot, {}, pull(duration=3.0))], 100.0, 1e-4, ("force",))[:, :, 0]
    slack, zero = 40, 2.5  # samples at 1 mm/s and 100 Hz: 0.4 mm
    force = np.concatenate([np.zeros(slack), pulled[:-slack]]) + zero
    time = np.arange(len(force)) / 100.0
    np.savetxt(
        tmp_path / "log.csv",
        np.column_stack([time, 1e-3 * time, force]),
        delimiter=",",
        header="time [s],position [m],force [N]",
        comments="",
    )
    (tmp_path / "session.yaml").write_text(
        "schema: ssmr-ident/session/1\nname: pull\nrobot: p3at-extended\nrecordings:\n"
        "  - {file: log.csv, experiment: pull, direction: lateral, speed_mm_s: 1.0, cable: steel}\n"
    )
    prediction = compare_session(tmp_path).recordings[0].prediction
    assert prediction.nuisances["slack_m"] == pytest.approx(4e-4, abs=2e-5)
    assert prediction.nuisances["zero_N"] == pytest.approx(zero, abs=1.0)


def test_effects_that_do_not_exist_name_the_file(tmp_path: Path, rig_session: Path) -> None:
    parameters = read_parameters(rig_session / "rig.yaml")
    wrong = replace(parameters, effects={"nonlinear_stifness": {"k3_N_m3": Estimate(1.0, None, "N/m^3")}})
    write_parameters(tmp_path / "wrong.yaml", wrong)
    with pytest.raises(InputError, match="Did you mean 'nonlinear_stiffness'") as caught:
        compare_session(rig_session, str(tmp_path / "wrong.yaml"))
    assert "wrong.yaml" in caught.value.where


def test_a_baseline_without_a_model_of_the_experiment_says_so(rig_session: Path) -> None:
    text = (rig_session / "session.yaml").read_text().replace("baseline: sdof", "baseline: rigid6")
    (rig_session / "session.yaml").write_text(text)
    with pytest.raises(InputError, match="has no model of forced"):
        compare_session(rig_session)


def test_strong_hum_counts_by_the_gain_of_the_low_pass_alone() -> None:
    """Three times the motion, at any phase: what is left of it is 1/(1 + (60/50)^20), ends included."""
    time = np.arange(2000) / 1000
    motion = np.exp(-3 * time) * np.sin(2 * np.pi * 6 * time)
    for phase in (0.0, 1.0, 2.0):
        hum = 3.0 * np.sin(2 * np.pi * 60 * time + phase)
        prediction = Prediction(time, ("ay",), ("m/s^2",), (motion + hum)[:, None], motion[:, None])
        left = np.linalg.norm(hum) / (1 + (60 / 50) ** 20)
        assert measure(prediction)[0] == pytest.approx(100 * left / np.hypot(np.linalg.norm(motion), left), rel=0.03)


@pytest.mark.parametrize("seconds", [0.01, 0.05])
def test_a_stretch_too_short_for_the_mains_or_the_low_pass_is_compared(seconds: float) -> None:
    """As a fast rig's single recording is held back in; 2 of 100 is 2 %, filtered or not."""
    time = np.arange(round(1000 * seconds)) / 1000
    motion = np.cos(2 * np.pi * 5 * time)[:, None]
    assert measure(Prediction(time, ("a",), ("m/s^2",), motion, 0.98 * motion))[0] == pytest.approx(2.0, rel=1e-6)
