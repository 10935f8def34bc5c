"""What a diagnosis costs: seconds over the number of recordings, with something missing and with nothing.

python benchmarks/bench_cost.py
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np
from bank import draw
from bank.truth import BankSession

from ssmr_ident.campaign import Campaign
from ssmr_ident.pipeline.diagnose import diagnose

CASES = (("decays", "nonlinear_stiffness", 6), ("forced", "nonlinear_stiffness", 4), ("pulls", "cable_compliance", 4))


def first(drawn: BankSession, count: int) -> Campaign:
    """The session with ``count`` recordings, targets and held-out ones in the same proportion; repeated where few."""
    entries, measurements = [], []
    for role in ("target", "heldout"):
        own = [m for m in drawn.campaign.measurements if m.entry.role == role]
        total = len(drawn.campaign.measurements)
        for index in range(max(1, round(count * len(own) / total))):
            measurement = own[index % len(own)]
            entry = replace(measurement.entry, file=f"{index}-{measurement.entry.file}")
            entries.append(entry)
            measurements.append(replace(measurement, entry=entry))
    session = replace(drawn.campaign.session, entries=tuple(entries))
    return replace(drawn.campaign, session=session, measurements=tuple(measurements))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=7)
    arguments = parser.parse_args()
    warm = draw("forced", "one", 1, short=True).campaign
    diagnose(warm)  # compiles what is compiled once
    for family, effect, least in CASES:
        for kind in ("none", "one"):
            drawn = draw(family, kind, arguments.seed, effect if kind == "one" else None, 0.7)
            counts = [least, 2 * least, 4 * least, 8 * least]
            seconds = []
            for count in counts:
                campaign = first(drawn, count)
                begin = time.perf_counter()
                diagnose(campaign)
                seconds.append(time.perf_counter() - begin)
            power = float(np.polyfit(np.log(counts), np.log(seconds), 1)[0])
            samples = sum(len(m.recording.time) for m in campaign.measurements) // len(campaign.measurements)
            parts = ", ".join(f"{n}: {s:.1f} s" for n, s in zip(counts, seconds, strict=True))
            missing = effect if kind == "one" else "nothing"
            print(f"{family:<8} {missing:<20} {samples:>6} samples each  {parts}  grows as N^{power:.2f}", flush=True)


if __name__ == "__main__":
    main()
