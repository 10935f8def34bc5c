"""Every parameter file of the package on its own wheels: what it simulates and what it compares with are one run.

A floor of its own seed makes another run of the same robot; how far that lies away is chance, and ``compare`` must add
nothing to it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.experiments import EXPERIMENTS, Conditions
from ssmr_ident.session.parameters_file import bundled_robots
from ssmr_ident.signals.metrics import log_psd_db
from ssmr_ident.workflows.compare import compare_session
from ssmr_ident.workflows.diagnose import diagnose_session
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.simulate.run import simulate_to_file

RAW = Path(__file__).resolve().parents[2] / "data" / "raw"
FILES = [
    path for path in sorted(RAW.rglob("*.yaml"))
    if path.name.startswith(("robot", "truth")) and path.parent != RAW / "concealed" / "b"
]  # fmt: skip
"""Robots of the reference campaign; concealed/b is a rig."""

ON_WHEELS = {"swivel": "yaw_rate_deg_s: 45", "straight": "wheel_speed_m_s: 0.3"}


def apart(folder: Path, robot: str, experiment: str) -> None:
    runs, values = [], []
    for seed in (0, 3):
        request = Request(EXPERIMENTS[experiment], Conditions(), duration_s=6.0, seed=seed)
        made = simulate_to_file(str(folder / robot) if robot.endswith("yaml") else robot, request, folder / "made.csv")
        runs.append(np.column_stack([made[axis] for axis in ("ax", "ay", "az")]))
        entry = f"{{file: made.csv, experiment: {experiment}, {ON_WHEELS[experiment]}}}"
        text = f"schema: ssmr-ident/session/1\nname: same\nrobot: {robot}\nrecordings:\n  - {entry}\n"
        (folder / "session.yaml").write_text(text)
        values.append(compare_session(folder).recordings[0].value)
    chance = float(np.sqrt(np.mean(np.square(log_psd_db(runs[1], runs[0], 1000.0)))))
    assert values[0] < 0.02
    assert values[1] == pytest.approx(chance, abs=0.02)


@pytest.mark.parametrize("robot", bundled_robots())
def test_bundled_robots(tmp_path: Path, robot: str) -> None:
    apart(tmp_path, robot, "swivel")


@pytest.mark.slow
@pytest.mark.parametrize("experiment", ON_WHEELS)
@pytest.mark.parametrize("file", FILES, ids=[path.relative_to(RAW).as_posix() for path in FILES])
def test_files_of_the_campaign(tmp_path: Path, file: Path, experiment: str) -> None:
    shutil.copy(file, tmp_path / "robot.yaml")
    apart(tmp_path, "robot.yaml", experiment)


@pytest.mark.slow
def test_a_file_in_which_all_is_fixed_is_diagnosed_and_lacks_nothing(tmp_path: Path) -> None:
    """`benchmarks/bench_same.py` does this with every file."""
    file = RAW / "swivel-frame" / "truth-concrete.yaml"
    shutil.copy(file, tmp_path / "robot.yaml")
    rows = []
    for role, seed in (("calibration", 3), ("target", 4)):
        request = Request(
            EXPERIMENTS["swivel"], Conditions(yaw_rate_deg_s=45.0), duration_s=12.0, seed=seed, noise=True
        )
        simulate_to_file(str(file), request, tmp_path / f"{role}.csv")
        rows.append(f"  - {{file: {role}.csv, experiment: swivel, {ON_WHEELS['swivel']}, role: {role}}}")
    head = ["schema: ssmr-ident/session/1", "name: same", "robot: robot.yaml", "recordings:"]
    (tmp_path / "session.yaml").write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    assert diagnose_session(tmp_path).verdict == "nothing_missing"


@pytest.mark.slow
@pytest.mark.parametrize("law", ["cone", "relay", "printed_6_4"])
def test_a_law_that_is_named(tmp_path: Path, law: str) -> None:
    text = (RAW / "swivel-frame" / "robot-tile.yaml").read_text(encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(text.replace("tire:\n", f"tire:\n  contact: {law}\n"), encoding="utf-8")
    apart(tmp_path, "robot.yaml", "swivel")


@pytest.mark.slow
@pytest.mark.parametrize("truth", sorted(RAW.glob("swivel-*/truth-*.yaml")), ids=lambda p: f"{p.parent.name}-{p.stem}")
def test_recordings_of_the_campaign_against_what_they_were_made_with(truth: Path) -> None:
    """Two runs of 20 s differ by 0.9 to 1.5 dB; a robot that shakes in two ways may have been recorded in the other."""
    found = compare_session(truth.with_name(truth.name.removeprefix("truth-")), str(truth))
    assert np.median([one.value for one in found.recordings]) < 1.5
