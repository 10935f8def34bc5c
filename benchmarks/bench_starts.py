"""Whether a rig's diagnosis hangs on the values that it begins from: stiffness off by three, damping by ten.

python benchmarks/bench_starts.py              # four sessions of each stream
python benchmarks/bench_starts.py -n 40 --start 1000

Every session is diagnosed from its own file and from one whose stiffness and damping are multiplied or divided, as
chance has it, without a stated deviation.
"""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import replace

import numpy as np
from doctor.sources import cases, opened

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.doctor.run import diagnose

OFF = {"stiffness_N_m": 3.0, "damping_N_s_m": 10.0}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", "--count", type=int, default=4, help="N: sessions of a stream of share 1")
    parser.add_argument("--start", type=int, default=1, help="sessions of every stream that are passed over")
    asked = parser.parse_args()
    tally: Counter[str] = Counter()
    for case in cases(("rigs", "rig-nulls"), asked.count, asked.start):
        campaign = opened(case).campaign
        wrong = astray(campaign.parameters, int(case.key.rsplit("/", 1)[1]))
        told, other = diagnose(campaign), diagnose(campaign, wrong)
        word = _compared(told, other)
        tally[word] += 1
        print(f"{case.key:<34} {word:<6} {_said(told):<45} {_said(other)}", flush=True)
    print(", ".join(f"{count} {word}" for word, count in tally.most_common()))


def astray(known: ParameterSet, seed: int) -> ParameterSet:
    """A file with wrong values, and without their deviations."""
    chance, wrong = np.random.default_rng([seed, 7]), {}
    for path, factor in OFF.items():
        side = float(chance.choice([-1.0, 1.0]))
        if path in known and not known[path].fixed:
            wrong[path] = replace(known[path], value=float(known[path].value) * factor**side, std=None)
    return known.updated(wrong)


def _compared(told: Diagnosis, other: Diagnosis) -> str:
    """``same``: verdict and effects; ``tie``: the effects of one are among the names of the other's."""
    if told.verdict != other.verdict:
        return "other"
    first, second = ({e.id for e in d.effects} for d in (told, other))
    if first == second:
        return "same"
    tied = {i for d in (told, other) for e in d.effects for i in e.indistinguishable_from}
    return "tie" if first ^ second <= tied else "other"


def _said(told: Diagnosis) -> str:
    return "+".join(sorted(e.id for e in told.effects)) or told.verdict


if __name__ == "__main__":
    main()
