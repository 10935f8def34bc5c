"""The diagnosis on the practice sessions and the real recordings beside the checkout: one line per case, and totals.

Each practice session has further recordings of the same robot in a folder of its own, which the diagnosis never sees;
before.yaml and after.yaml are compared with them by ``ident compare``, and that is the held-out error of the table.

    python benchmarks/score_practice.py                  # all
    python benchmarks/score_practice.py --only 01,15     # some
    python benchmarks/score_practice.py --real           # the real recordings
    python benchmarks/score_practice.py --out out/practice.jsonl
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from real_cases import REAL, judge
from scoring import append, engine, read, row_of, summary, table

from ssmr_ident.compare import compare
from ssmr_ident.experiments.campaign import load
from ssmr_ident.workflows.diagnose import diagnose, write_diagnosis

SHARED = Path(__file__).resolve().parents[2] / "shared"
SWIVELS = ("20", "21")
PATHS = {
    "m": "mass_kg", "Ixx": "inertia_kg_m2.xx", "Iyy": "inertia_kg_m2.yy", "Izz": "inertia_kg_m2.zz",
    "Ixz": "inertia_kg_m2.xz", "Kx": "tire.stiffness_x_N_m", "Ky": "tire.stiffness_y_N_m",
    "Kz": "tire.stiffness_z_N_m", "Dx": "tire.damping_x_N_s_m", "Dy": "tire.damping_y_N_s_m",
    "Dz": "tire.damping_z_N_s_m", "mus": "tire.mu_static", "k": "stiffness_N_m", "d": "damping_N_s_m",
}  # fmt: skip


def practice(folder: Path, write: Path | None) -> dict[str, Any]:
    """One practice session."""
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    ids = [effect["id"] for effect in truth["effects"]]
    numbers = {
        effect["id"]: {
            name: float(value["value"]) for name, value in effect["parameters"].items() if isinstance(value, dict)
        }
        for effect in truth["effects"]
    }
    known = {PATHS[name]: float(value) for name, value in truth["true_robot"].items() if name in PATHS}
    campaign = load(folder / "session")
    row, found = row_of(
        folder.name[-2:], ids, lambda: diagnose(campaign), {}, numbers, known, family=truth["family"], engine=engine()
    )
    if found is not None:
        further = load(folder / "heldout")
        row["said"] = {"before": row["before"], "after": row["after"]}
        row["before"], row["after"] = (
            float(np.mean(list(compare(further, parameters).overall.values())))
            for parameters in (found.before, found.after)
        )
        row["floor"] = truth["heldout"]["noise_floor"]
        row["reference_before"] = truth["heldout"]["baseline_refit"]
        if write is not None:
            write_diagnosis(found, campaign, write / folder.name)
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="numbers of practice sessions, or names of real ones, comma-separated")
    parser.add_argument("--real", action="store_true", help="the real recordings instead")
    parser.add_argument("--swivels", action="store_true", help="the swivelling sessions as well")
    parser.add_argument("--out", type=Path, help="append a JSON line per session here")
    parser.add_argument("--write", type=Path, help="write each diagnosis with its report into this folder")
    parser.add_argument("--summary", action="store_true", help="judge what is in the file and run nothing")
    arguments = parser.parse_args()
    only = arguments.only.split(",") if arguments.only else None
    rows = read(arguments.out) if arguments.summary else []
    if not arguments.summary:
        if arguments.real:
            names = [name for name in REAL if only is None or name in only]
            cases = [(SHARED / "recordings" / name, judge) for name in names]
        else:
            folders = sorted((SHARED / "practice").glob("practice-*"))
            wanted = [f for f in folders if (arguments.swivels or f.name[-2:] not in SWIVELS)]
            cases = [(f, practice) for f in wanted if only is None or f.name[-2:] in only]
        for folder, run in cases:
            row = run(folder, arguments.write)
            rows.append(row)
            if arguments.out:
                append(arguments.out, row)
            print(table([row]).splitlines()[-1], *row.get("remarks", []), sep="\n    ", flush=True)
            if "error" in row:
                print(row["error"])
    print("\n" + table(rows))
    if not arguments.real:
        print("\n" + summary(rows))


if __name__ == "__main__":
    main()
