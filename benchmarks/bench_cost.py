"""What a diagnosis costs: seconds over the number of recordings, with something missing and with nothing.

python benchmarks/bench_cost.py            # how cost grows with recordings, the middle one of three sessions
python benchmarks/bench_cost.py --whole    # one session of nine decays, one of eight driven runs of 8,000 samples
"""

from __future__ import annotations

import argparse
import itertools
import time
from dataclasses import replace

import bank.decays
import bank.pulls
import bank.rigs
import numpy as np
from bank import draw
from bank.truth import BankSession

from ssmr_ident.core.threads import processors
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.workflows.diagnose import diagnose

MULTIPLES = (1, 2, 4, 8)
WHOLE = (
    ("decays", ("nonlinear_stiffness", "dry_friction", "flexible_mast", "free_play", "wheel_lift"), 9, 4096, 20.0),
    ("forced", ("nonlinear_stiffness",), 8, 8000, 30.0),
)
"""Family, effects, recordings (of decays those to be fitted), samples in each, and the seconds that it may take. What a
decay asks of the search differs by effect: each that bends the motion otherwise stands here."""

DRAWN = 3
"""Sessions of each case, of which the middle one is told: one alone may ask for a road that others do not."""

CASES = (("decays", "nonlinear_stiffness", 6), ("forced", "nonlinear_stiffness", 4), ("pulls", "cable_compliance", 4))


PLANS = {"decays": (bank.decays, "PLAN"), "forced": (bank.rigs, "FORCED"), "pulls": (bank.pulls, "PLAN")}


def many(family: str, kind: str, seed: int, effect: str) -> BankSession:
    """A session with as many recordings as are asked for at the most, each with a release, force and noise of its own.

    Recordings that stand in a session twice are no new evidence: of 48 decays that were 13, each three or four times, a
    null was called a relaxation with 48 units, and what was timed was the search for it.
    """
    module, name = PLANS[family]
    plan = getattr(module, name)
    try:
        setattr(module, name, [*plan] * MULTIPLES[-1])
        return _drawn(family, kind, seed, effect)
    finally:
        setattr(module, name, plan)


def first(drawn: BankSession, count: int) -> Campaign:
    """The session with ``count`` recordings, targets and held-out ones in the same proportion."""
    entries, measurements = [], []
    for role in ("target", "heldout"):
        own = [m for m in drawn.campaign.measurements if m.entry.role == role]
        total = len(drawn.campaign.measurements)
        for index in range(max(1, round(count * len(own) / total))):
            measurement = own[index]
            entry = replace(measurement.entry, file=f"{index}-{measurement.entry.file}")
            entries.append(entry)
            measurements.append(replace(measurement, entry=entry))
    session = replace(drawn.campaign.session, entries=tuple(entries))
    return replace(drawn.campaign, session=session, measurements=tuple(measurements))


def timed(campaign: Campaign) -> float:
    """Seconds that one diagnosis takes."""
    begin = time.perf_counter()
    diagnose(campaign)
    return time.perf_counter() - begin


def samples(campaign: Campaign) -> int:
    """In a recording, on average."""
    return sum(len(m.recording.time) for m in campaign.measurements) // len(campaign.measurements)


def whole(seed: int) -> None:
    """Sessions as large as those for which a time is promised, with and without something missing."""
    for family, effects, count, length, limit in WHOLE:
        for kind, effect in (("none", "nothing"), *(("one", effect) for effect in effects)):
            seeds = (s for s in itertools.count(seed) if samples(_drawn(family, kind, s, effect).campaign) == length)
            drawn = _drawn(family, kind, next(seeds), effect)
            print(
                f"{family:<8} {effect:<20} {count} x {length} samples  {timed(drawn.campaign):5.1f} s "
                f"(limit {limit:.0f} s)  on {processors()} processors, seed {drawn.seed}",
                flush=True,
            )


def _drawn(family: str, kind: str, seed: int, effect: str) -> BankSession:
    return draw(family, kind, seed, effect if kind == "one" else None, 0.7)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--whole", action="store_true", help="the sessions for which a time is promised, nothing else")
    arguments = parser.parse_args()
    for family in ("forced", "decays", "pulls"):  # compiles what is compiled once
        diagnose(draw(family, "none", 1, short=True).campaign)
    if arguments.whole:
        whole(arguments.seed)
        return
    for family, effect, least in CASES:
        for kind in ("none", "one"):
            drawn = [many(family, kind, arguments.seed + k, effect) for k in range(DRAWN)]
            counts = [times * least for times in MULTIPLES]
            each = [[timed(first(session, count)) for count in counts] for session in drawn]
            seconds = np.median(each, axis=0)
            power = float(np.polyfit(np.log(counts), np.log(seconds), 1)[0])
            parts = ", ".join(f"{n}: {s:.1f} s" for n, s in zip(counts, seconds, strict=True))
            missing = effect if kind == "one" else "nothing"
            print(
                f"{family:<8} {missing:<20} {samples(drawn[0].campaign):>6} samples each  {parts}  "
                f"grows as N^{power:.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
