"""``drive:``, ``controller:``, ``voltage`` and ``enabled``: what a session may say of a motor, and what it may not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import load
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.voltage_drive import Controller, Course, drive_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.rig import simulate_rig

RIG = """schema: ssmr-ident/parameters/1
name: servo
inertia_kg_m2: {value: 0.008, std: 0.0008}
stiffness_N_m_rad: {value: 0.5, std: 0.01}
damping_N_m_s_rad: {value: 0.004}
"""
STRAIGHT = """schema: ssmr-ident/parameters/1
mass_kg: {value: 2.0}
stiffness_N_m: {value: 500.0}
damping_N_s_m: {value: 4.0}
"""
DRIVE = "drive: {kt_N_m_A: {value: 0.4, std: 0.04}, R_ohm: {value: 4.0, std: 0.4}}\n"
VOLTS = "channels: {voltage: u, angle: phi, enabled: connected}"
LOOP = "channels: {position_reference: goal, angle: phi}, controller: {kp_V_rad: 3.0, limit_V: 2.0}"


def session(folder: Path, recording: str, rig: str = RIG + DRIVE, experiment: str = "forced") -> Path:
    rate, time = 100.0, np.arange(300) / 100.0
    goal = 0.8 * np.sin(2.0 * np.pi * 0.5 * time)
    on = (time < 2.0).astype(float)
    (folder / "rig.yaml").write_text(rig, encoding="utf-8")
    (folder / "volts.yaml").write_text(RIG + DRIVE, encoding="utf-8")
    motor = drive_from_parameters(read_parameters(folder / "volts.yaml"))
    held = Controller(3.0, 2.0) if "controller" in recording else None
    course = Course(goal if held else 3.0 * goal, np.ones(300) if held else on, held)
    angle = simulate_rig(Rig(0.008, 0.004, 0.5, True), np.zeros(300), rate, motor=motor, course=course)[:, 0]
    rows = np.column_stack([time, 3.0 * goal, goal, angle, on])
    lines = [
        "time [s],u [V],goal [rad],phi [rad],connected",
        *(",".join(f"{value:.9g}" for value in row) for row in rows),
    ]
    (folder / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "session.yaml").write_text(
        "schema: ssmr-ident/session/1\nrobot: rig.yaml\nbaseline: sdof\nrecordings:\n"
        f"- {{file: log.csv, experiment: {experiment}, {recording}}}\n",
        encoding="utf-8",
    )
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("recording", [VOLTS, LOOP])
def test_a_simulated_drive_is_compared_to_next_to_nothing(tmp_path: Path, recording: str) -> None:
    from ssmr_ident.compare import compare

    campaign = load(session(tmp_path, recording))
    (found,) = compare(campaign, campaign.parameters).recordings
    assert found.metric == "nrmse_percent"
    assert found.value < 0.2


@pytest.mark.parametrize(
    ("recording", "rig", "experiment", "words"),
    [
        (VOLTS, RIG, "forced", ("recordings[0].channels.voltage", "has no drive:", "Write drive:")),
        (LOOP, RIG, "forced", ("recordings[0].controller", "has no drive:")),
        (LOOP.replace("position_reference: goal, ", ""), RIG + DRIVE, "forced", ("needs position_reference",)),
        (LOOP.replace("kp_V_rad: 3.0, ", ""), RIG + DRIVE, "forced", ("controller", "kp_V_rad")),
        (LOOP.replace("3.0", "0"), RIG + DRIVE, "forced", ("controller.kp_V_rad", "more than 0")),
        (LOOP, RIG + DRIVE, "free_response", ("controller", "drives nothing in a free_response")),
        (VOLTS, RIG + DRIVE.replace("kt_N", "k_N"), "forced", ("drive.k_N_m_A", "kt_N_m_A")),
        (VOLTS, RIG + DRIVE.replace("R_ohm: {value: 4.0, std: 0.4}", "gear_ratio: 2"), "forced", ("drive.R_ohm",)),
        (VOLTS, STRAIGHT + DRIVE, "forced", ("turns the one joint of a rotary rig",)),
    ],
)
def test_what_cannot_be_is_said_in_one_line(
    tmp_path: Path, recording: str, rig: str, experiment: str, words: tuple[str, ...]
) -> None:
    with pytest.raises(InputError) as caught:
        load(session(tmp_path, recording, rig, experiment))
    said = str(caught.value)
    assert "\n" not in said
    for word in words:
        assert word in said, said


@pytest.mark.slow
@pytest.mark.parametrize("controller", [False, True])
def test_a_simulated_log_reads_back_by_its_own_names(tmp_path: Path, controller: bool) -> None:
    from ssmr_ident.compare import compare
    from ssmr_ident.experiments import FORCED, Conditions
    from ssmr_ident.workflows.simulate.request import Request
    from ssmr_ident.workflows.simulate.run import simulate_to_file

    session(tmp_path, "controller: {kp_V_rad: 3.0, limit_V: 2.0}" if controller else "trial: 1")
    time = np.arange(300) / 100.0
    given, header = [time, 2.0 * np.sin(3.0 * time)], "time [s],voltage [V],enabled"
    if controller:
        header = "time [s],position_reference [rad],enabled"
    rows = np.column_stack([*given, (time < 2.0).astype(float)])
    np.savetxt(tmp_path / "given.csv", rows, "%.9g", ",", header=header, comments="")
    conditions = Conditions(kp_V_rad=3.0, limit_V=2.0) if controller else Conditions()
    request = Request(FORCED, conditions, force=str(tmp_path / "given.csv"))
    written = simulate_to_file(str(tmp_path / "rig.yaml"), request, tmp_path / "log.csv")
    assert written.names[1] == "enabled"
    campaign = load(tmp_path)
    assert compare(campaign, campaign.parameters).recordings[0].value < 0.2
