"""How often a pendulum's swing, and a carriage without a spring, are read rightly; neither is the simulator's.

python benchmarks/bench_lab_rigs.py              # four of each
python benchmarks/bench_lab_rigs.py -n 40 --start 1000
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections import Counter
from pathlib import Path

from bank.lab_plants import NAMES, Carriage, Swing, draw_carriage, draw_swing

from ssmr_ident.workflows.diagnose import diagnose_session


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", "--count", type=int, default=4)
    parser.add_argument("--start", type=int, default=0, help="first seed")
    asked = parser.parse_args()
    tally: Counter[str] = Counter()
    for seed in range(asked.start, asked.start + asked.count):
        swing = draw_swing(seed)
        for kind, (laws, plant) in (("swing", (swing.laws, swing)), ("carriage", draw_carriage(seed))):
            tally[f"{kind}, {' and '.join(laws) or 'nothing'}: {_asked(seed, kind, laws, plant)}"] += 1
    print("\n".join(f"{count:4d}  {name}" for name, count in sorted(tally.items())))


def _asked(seed: int, kind: str, laws: tuple[str, ...], plant: Swing | Carriage) -> str:
    """One word for an answer, after a line with all of it."""
    with tempfile.TemporaryDirectory() as folder:
        session = plant.write(Path(folder))
        begun = time.process_time()
        found = diagnose_session(session)
        took = time.process_time() - begun
    named, true = {e.id for e in found.effects}, {NAMES[law] for law in laws}
    right = named == true if true else found.verdict == "nothing_missing"
    word = "right" if right else "part" if named and named < true else "wrong" if named else found.verdict
    error = f"{found.heldout.before:.3g} -> {found.heldout.after:.3g} of {found.heldout.noise_floor:.3g} %"
    said = ", ".join(e.id for e in found.effects) or found.verdict
    print(
        f"{seed:6d} {kind:<8} {', '.join(laws) or 'nothing':<17} {word:<15} {said}; {error}, {took:.0f} s", flush=True
    )
    return word


if __name__ == "__main__":
    main()
