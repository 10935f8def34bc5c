"""How often physics at a random spring of two or three bodies is named, with its spring, and how often none is named
where there is none.

    python benchmarks/bench_networks.py            # six sessions
    python benchmarks/bench_networks.py -n 100 --start 1000
"""

from __future__ import annotations

import argparse
import time
from collections import Counter

from bank.networks import draw_network

from ssmr_ident.doctor.run import diagnose

NULLS = 5
"""Every so many-th session hides nothing."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", "--count", type=int, default=6)
    parser.add_argument("--start", type=int, default=0, help="first seed")
    asked = parser.parse_args()
    tally: Counter[str] = Counter()
    longest = 0.0
    for seed in range(asked.start, asked.start + asked.count):
        session = draw_network("none" if seed % NULLS == 0 else "one", seed)
        begun = time.process_time()
        found = diagnose(session.campaign)
        took = time.process_time() - begun
        longest = max(longest, took)
        answer = judged(session.truth.ids, session.truth.element, found)
        tally[answer] += 1
        said = ", ".join(f"{e.id} at {e.element}" for e in found.effects) or found.verdict
        true = ", ".join(f"{i} at {session.truth.element}" for i in session.truth.ids) or "nothing"
        error = f"{found.heldout.before:.3g} -> {found.heldout.after:.3g} of {found.heldout.noise_floor:.3g} %"
        print(f"{seed:6d} {answer:<14} {true} (size {session.size:.2f}): {said}; {error}, {took:.1f} s", flush=True)
    whole = sum(tally.values())
    print(", ".join(f"{name} {count}/{whole}" for name, count in tally.most_common()), f"longest {longest:.1f} s")


def judged(ids: tuple[str, ...], element: str, found: object) -> str:
    """One word for an answer."""
    named = tuple(e.id for e in found.effects)
    if not ids:
        return "right" if not named else "false alarm"
    if not named:
        return "missed" if found.verdict == "nothing_missing" else "undetermined"
    where = "" if all(e.element == element for e in found.effects) else ", elsewhere"
    ties = {other for e in found.effects for other in e.indistinguishable_from}
    return ("right" if named == ids else "tie" if set(ids) <= ties else "other law") + where


if __name__ == "__main__":
    main()
