"""Parameter files of the package simulated in swivels, compared with themselves, and diagnosed: nothing may be missing.

    python benchmarks/bench_same.py                                     # every file of data/raw and every bundled robot
    python benchmarks/bench_same.py p3at-extended data/raw/swivel-frame/truth-tile.yaml --calibrated
    python benchmarks/bench_same.py --speeds 30 --seconds 12

Every recording has a floor of its own, so that a distance is that of two runs by chance; the last figure is what an
examination took of the processor. ``--calibrated`` has each speed twice, once as calibration.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
import time
from pathlib import Path

from ssmr_ident.experiments import SWIVEL, Conditions
from ssmr_ident.session import read_parameters
from ssmr_ident.session.parameters_file import bundled_robots
from ssmr_ident.workflows.compare import compare_session
from ssmr_ident.workflows.diagnose import diagnose_session
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.simulate.run import simulate_to_file

RAW = Path(__file__).resolve().parents[1] / "data" / "raw"


def files() -> list[str]:
    """Robots: bundled ones, and those of the reference campaign; concealed/b is a rig."""
    raw = (p for p in sorted(RAW.rglob("*.yaml")) if p.name.startswith(("robot", "truth")) and p.parent.name != "b")
    return [*bundled_robots(), *map(str, raw)]


def session(folder: Path, file: str, speeds: list[float], seconds: float, calibrated: bool) -> None:
    """A session of swivels of a file's robot, in a folder of its own."""
    robot = file
    if Path(file).is_file():
        robot = "robot.yaml"
        shutil.copy(file, folder / robot)
    noise = any(key.startswith("noise.") for key in read_parameters(file))
    roles = ("calibration", "target") if calibrated else ("target",)
    rows = []
    for speed in speeds:
        for role in roles:
            name = f"w{speed:g}-{role}.csv"
            conditions = Conditions(yaw_rate_deg_s=speed)
            request = Request(SWIVEL, conditions, duration_s=seconds, seed=2 + len(rows), noise=noise)
            simulate_to_file(file, request, folder / name)
            rows.append(f"  - {{file: {name}, experiment: swivel, yaw_rate_deg_s: {speed:g}, role: {role}}}")
    head = ["schema: ssmr-ident/session/1", "name: same", f"robot: {robot}", "recordings:"]
    (folder / "session.yaml").write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", default=files())
    parser.add_argument("--speeds", type=float, nargs="+", default=[30.0, 45.0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--calibrated", action="store_true")
    given = parser.parse_args()
    for file in given.files:
        with tempfile.TemporaryDirectory() as place:
            session(Path(place), file, given.speeds, given.seconds, given.calibrated)
            apart = compare_session(Path(place)).overall["log_psd_db"]
            begun = time.process_time()
            found = diagnose_session(Path(place))
            named = ", ".join(effect.id for effect in found.effects)
            took = time.process_time() - begun
            print(f"{file}: {apart:.2f} dB, {found.verdict} {named} ({took:.0f} s)", flush=True)
