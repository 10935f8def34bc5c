"""Do two checkouts give the same answers? Every verb on every session that is at hand, number by number.

``record`` runs the commands of one checkout and keeps what they print and write; ``hold`` lays two such folders side by
side. A run that was stopped goes on where it was. Of another checkout its ``src`` is given.

    python benchmarks/same_answers.py record out/before --source ../before/src
    python benchmarks/same_answers.py record out/after
    python benchmarks/same_answers.py hold out/before out/after --within 1e-9
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from ssmr_ident.core.atomic import write_text

ROOT = Path(__file__).resolve().parents[1]
SHARED = ROOT.parent / "shared"
VERBS = ("simulate", "spectrum", "compare", "fit", "diagnose")
SIMULATED = {
    "roll": ["-e", "free_response", "--motion", "roll"],
    "pitch": ["-e", "free_response", "--motion", "pitch", "--noise", "--seed", "3"],
    "lateral": ["-e", "pull", "--direction", "lateral"],
    "longitudinal": ["-e", "pull", "--direction", "longitudinal", "--cable", "rope"],
    "drag": ["-e", "wheel_drag"],
    "compression": ["-e", "vertical_compression"],
    "swivel": ["-e", "swivel", "--duration-s", "5"],
    "straight": ["-e", "straight", "--duration-s", "5"],
    "friction": ["-e", "free_response", "--effect", "dry_friction:F_c_N=2"],
}
READERS = {
    ".json": json.loads,
    ".yaml": yaml.safe_load,
    ".csv": lambda text: [[_number(cell) for cell in row] for row in csv.reader(text.splitlines())],
}
FOLDERS = re.compile(r"(?<!\w)(?:/[\w.+~-]+)+/(?=[\w.+~-])")
"""What stands before a file's name: checkouts and outputs lie in folders of their own."""


def commands(verbs: list[str], out: Path) -> Iterator[tuple[str, list[str]]]:
    """Name of a result and the words that make it, the quick verbs first; only practice sessions are diagnosed."""
    raw, recordings, practice = ROOT / "data" / "raw", SHARED / "recordings", SHARED / "practice"
    known = {f"raw-{'-'.join(p.parent.relative_to(raw).parts)}": p.parent for p in sorted(raw.rglob("session.yaml"))}
    known |= {p.parent.name: p.parent for p in sorted(recordings.glob("*/session.yaml"))}
    diagnosed = {p.name: p / "session" for p in sorted(practice.glob("practice-*"))}
    for verb in (verb for verb in VERBS if verb in verbs):
        if verb == "simulate":
            for robot in ("p3at-extended", "p3at-platform"):
                for name, words in SIMULATED.items():
                    key = f"simulate/{robot}-{name}"
                    yield key, ["simulate", robot, *words, "-o", str(out / f"{key}.csv"), "--json"]
            continue
        for name, folder in (diagnosed if verb == "diagnose" else known | diagnosed).items():
            more = {"diagnose": ["-o", str(out / "diagnose" / name)], "spectrum": ["--no-figures"]}.get(verb, [])
            yield f"{verb}/{name}", [verb, str(folder), *more, "--json"]


def record(out: Path, source: Path, verbs: list[str], only: str, limit: float) -> None:
    """Run what has no result in ``out`` yet, by the package below ``source``."""
    environment = {**os.environ, "PYTHONPATH": str(source.resolve()), "OPENBLAS_NUM_THREADS": "1"}
    for key, words in commands(verbs, out):
        answer = out / f"{key}.json"
        if answer.exists() or not re.search(only, key):
            continue
        answer.parent.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, "-m", "ssmr_ident", *words]
        try:
            run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=limit, check=False)
            kept = {
                "exit": run.returncode,
                "printed": _printed(run.stdout),
                "error": run.stderr if run.returncode else "",
            }
        except subprocess.TimeoutExpired:
            kept = {"exit": f"no end within {limit:g} s"}
        write_text(answer, json.dumps(kept, indent=1))
        print(key, kept["exit"], flush=True)


def _printed(text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text.splitlines()


def _number(cell: str) -> float | str:
    try:
        return float(cell)
    except ValueError:
        return cell


def differences(one: Any, other: Any, within: float, where: str = "") -> Iterator[str]:
    """Where two answers part: numbers by more than ``within`` of their size, anything else at all."""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in sorted({*one, *other}, key=str):
            if key in one and key in other:
                yield from differences(one[key], other[key], within, f"{where}/{key}")
            else:
                yield f"{where}/{key}: only in the {'first' if key in one else 'second'}"
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for n, (a, b) in enumerate(zip(one, other, strict=True)):
            yield from differences(a, b, within, f"{where}[{n}]")
    elif isinstance(one, float | int) and isinstance(other, float | int):
        alike = one == other or (math.isnan(one) and math.isnan(other))
        if not alike and not abs(one - other) <= within * max(abs(one), abs(other)):
            yield f"{where}: {one!r} and {other!r}"
    elif _without_folders(one) != _without_folders(other):
        yield f"{where}: {one!r} and {other!r}"


def _without_folders(value: Any) -> Any:
    return FOLDERS.sub("", value) if isinstance(value, str) else value


def hold(one: Path, other: Path, within: float, most: int) -> int:
    """Print where two folders of results part; how many of their files do."""
    files = sorted({p.relative_to(d) for d in (one, other) for p in d.rglob("*") if p.suffix in READERS})
    apart: Counter[str] = Counter()
    for name in files:
        if not ((one / name).exists() and (other / name).exists()):
            found = [f"only in the {'first' if (one / name).exists() else 'second'}"]
        else:
            texts = [(folder / name).read_text(encoding="utf-8") for folder in (one, other)]
            found = list(differences(*map(READERS[name.suffix], texts), within))
        if found:
            apart[name.parts[0]] += 1
            print(f"{name}: {len(found)} places", *found[:most], sep="\n    ")
    for verb, count in Counter(name.parts[0] for name in files).items():
        print(f"{verb}: {count - apart[verb]} of {count} files agree within {within:g}")
    return apart.total()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    does = parser.add_subparsers(dest="what", required=True)
    recorded = does.add_parser("record", help="run the commands of one checkout")
    recorded.add_argument("out", type=Path)
    recorded.add_argument("--source", type=Path, default=ROOT / "src", help="the checkout's src")
    recorded.add_argument("--verbs", default=",".join(VERBS), help="comma-separated")
    recorded.add_argument("--only", default="", help="regular expression that a result's name holds: practice-(14|20)")
    recorded.add_argument("--limit", type=float, default=1800.0, help="seconds that a command may take")
    held = does.add_parser("hold", help="lay two folders of results side by side")
    held.add_argument("one", type=Path)
    held.add_argument("other", type=Path)
    held.add_argument("--within", type=float, default=1e-9, help="of a number's size")
    held.add_argument("--most", type=int, default=5, help="differences printed of each file")
    asked = parser.parse_args()
    if asked.what == "record":
        record(asked.out.resolve(), asked.source, asked.verbs.split(","), asked.only, asked.limit)
    elif hold(asked.one, asked.other, asked.within, asked.most):
        sys.exit(1)


if __name__ == "__main__":
    main()
