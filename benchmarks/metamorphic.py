"""One experiment, logged in other ways, must have one answer: verdict, names, and parameters within their intervals.

python benchmarks/metamorphic.py                       # all sessions, some minutes each
python benchmarks/metamorphic.py --only hardening      # those whose name holds a word
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from retold import OTHERWISE, Told, let_go, rolls, shaken

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.session import read_parameters
from ssmr_ident.session.yaml_file import load_mapping
from ssmr_ident.workflows.diagnose import diagnose_session

SESSIONS: dict[str, Callable[[], Told]] = {
    "rig, shaken": shaken,
    "rig, shaken, hardening": lambda: shaken(hardening=2e7),
    "rig, shaken, dry friction": lambda: shaken(friction=1.5),
    "rig, let go, dry friction": lambda: let_go(friction=0.5),
    "robot, let go in roll": rolls,
    "robot, let go in roll, hardening": lambda: rolls("nonlinear_stiffness.k3_N_m3", 1e10),
}
APART = 3.0
"""Standard deviations, of both together, that a parameter may be moved by other samples of the same experiment."""


@dataclass(frozen=True)
class Answer:
    """What a diagnosis said, and what it fitted."""

    verdict: str
    names: tuple[str, ...]
    after: ParameterSet

    def __str__(self) -> str:
        return f"{self.verdict.replace('_', ' ')}: {' + '.join(self.names)}" if self.names else self.verdict


def asked(folder: Path) -> Answer:
    """Diagnose a session here, on the processors that there are."""
    found = diagnose_session(folder)
    return Answer(found.verdict, tuple(effect.id for effect in found.effects), found.after)


def asked_on(folder: Path, processors: set[int]) -> Answer:
    """As a user does, on some processors alone, which decides how many threads it has."""
    out = folder.with_name(f"{folder.name}-out")
    call = [sys.executable, "-m", "ssmr_ident", "diagnose", str(folder), "-o", str(out), "-q"]
    subprocess.run(call, check=True, preexec_fn=lambda: os.sched_setaffinity(0, processors))
    said = load_mapping(out / "diagnosis.yaml")
    names = tuple(effect["id"] for effect in said["effects"])
    return Answer(str(said["verdict"]), names, read_parameters(out / "after.yaml"))


def moved(usual: Answer, other: Answer) -> tuple[float, str]:
    """The parameter that is farthest away, in standard deviations of both together."""
    far = (0.0, "none")
    pairs = [(key, usual.after[key], other.after[key]) for key in usual.after if key in other.after]
    for id, block in usual.after.effects.items():
        theirs = other.after.effects.get(id, {})
        pairs += [(f"{id}.{key}", one, theirs[key]) for key, one in block.items() if key in theirs]
    for key, one, two in pairs:
        if one.std and two.std and not one.fixed and isinstance(one.value, float):
            far = max(far, (abs(one.value - two.value) / math.hypot(one.std, two.std), key))
    return far


def ways(told: Told, root: Path, allowed: list[int]) -> Iterator[tuple[str, Callable[[], Answer]]]:
    """Every way to log a session again, and the session itself on fewer processors and all."""
    for way, change in OTHERWISE.items():
        yield way, lambda change=change, way=way: asked(change(replace(told, folder=way)).write(root))
    for count in range(1, len(allowed) + 1):
        yield f"on {count} of the processors", lambda n=count: asked_on(root / told.folder, set(allowed[:n]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="sessions whose name holds this word")
    choices = parser.parse_args()
    allowed = sorted(os.sched_getaffinity(0))
    unlike = 0
    for name, make in SESSIONS.items():
        if choices.only not in name:
            continue
        begun, told = time.monotonic(), make()
        with tempfile.TemporaryDirectory() as place:
            root = Path(place)
            usual = asked(told.write(root))
            print(f"\n{name}: {usual}\n| logged | answer | farthest parameter |\n| --- | --- | --- |", flush=True)
            for way, ask in ways(told, root, allowed):
                other = ask()
                far, key = moved(usual, other)
                alike = (usual.verdict, usual.names) == (other.verdict, other.names) and far < APART
                unlike += not alike
                print(f"| {way} | {'' if alike else '**OTHER** '}{other} | {key}: {far:.2g} std |", flush=True)
        print(f"{time.monotonic() - begun:.0f} s", flush=True)
    print(f"\n{unlike} answers are others")
    return 1 if unlike else 0


if __name__ == "__main__":
    sys.exit(main())
