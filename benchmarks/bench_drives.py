"""How often the friction of a geared drive under position control is named, and how often where there is none.

python benchmarks/bench_drives.py              # six sessions
python benchmarks/bench_drives.py -n 60 --start 1000
"""

from __future__ import annotations

import argparse
import time
from collections import Counter

from bank.drives import KINDS, draw_drive

from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.doctor.run import diagnose


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", "--count", type=int, default=6)
    parser.add_argument("--start", type=int, default=0, help="first seed")
    asked = parser.parse_args()
    tally: Counter[str] = Counter()
    for seed in range(asked.start, asked.start + asked.count):
        session = draw_drive(KINDS[seed % len(KINDS)], seed)
        begun = time.process_time()
        found = diagnose(session.campaign)
        took = time.process_time() - begun
        answer = judged(session.truth.ids, found)
        tally[f"{session.kind}: {answer}"] += 1
        values = {name: e for effect in found.effects for name, e in effect.parameters.items()}
        share = f", c {values['c']} of {session.size:.3f}" if "c" in values else ""
        said = ", ".join(e.id for e in found.effects) or found.verdict
        error = f"{found.heldout.before:.3g} -> {found.heldout.after:.3g} of {found.heldout.noise_floor:.3g} %"
        true = ", ".join(session.truth.ids) or "nothing"
        print(f"{seed:6d} {answer:<12} {true}: {said}{share}; {error}, {took:.0f} s", flush=True)
    print(", ".join(f"{name} {count}" for name, count in sorted(tally.items())))


def judged(ids: tuple[str, ...], found: Diagnosis) -> str:
    """One word for an answer; of a weight that rubs, friction alone is half of it."""
    named = {e.id for e in found.effects}
    if not ids:
        return "right" if not named else "false alarm"
    if not named:
        return "missed" if found.verdict == "nothing_missing" else "undetermined"
    ties = {other for e in found.effects for other in e.indistinguishable_from}
    if named == set(ids):
        return "right"
    if set(ids) <= named | ties:
        return "tie"
    return "half" if named < set(ids) else "other law"


if __name__ == "__main__":
    main()
