"""Stands in for ``ident diagnose``: claims by the session's name, and writes what the contract asks for."""

import shutil
import sys
from pathlib import Path

import yaml


def main() -> None:
    """What the command does."""
    session, out = map(Path, sys.argv[1:3])
    out.mkdir()
    name = yaml.safe_load((session / "session.yaml").read_text(encoding="utf-8"))["name"]
    number = int(name.rsplit("-", 1)[1])
    for model in ("before", "after"):
        shutil.copy(session / "robot.yaml", out / f"{model}.yaml")
    claim = {
        "id": ("dry_friction", "nonlinear_stiffness")[number % 2],
        "sentence": "Something rubs.",
        "equation": "F",
        "parameters": {"F_c_N": {"value": 1.0, "std": 0.1, "unit": "N"}},
        "confidence": 0.9,
        "indistinguishable_from": ["hysteresis"],
    }
    missing = number % 3 > 0
    answer = {
        "schema": "ssmr-ident/diagnosis/1",
        "session": name,
        "verdict": "missing_physics" if missing else "nothing_missing",
        "summary": "Pretended.",
        "located": [],
        "effects": [claim] if missing else [],
        "fit": {"metric": "nrmse_percent", "heldout": {"before": 1.0, "after": 1.0, "noise_floor": 1.0}},
    }
    (out / "diagnosis.yaml").write_text(yaml.safe_dump(answer), encoding="utf-8")


if __name__ == "__main__":
    main()
