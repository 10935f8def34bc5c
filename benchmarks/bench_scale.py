"""The same robot at other sizes: decays that differ in nothing but mass, length and time must get the same answer.

Each seed gives a session of decays, with something left out of it or not; it is asked as it is, of a robot of 2 kg and
0.4 times the length, and of one of 470 kg and 2.5 times the length (``bank.scaled``).

    python benchmarks/bench_scale.py --first 1000 --count 12 --out out/scale.jsonl
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path

import numpy as np
from bank import KINDS, SHARES
from bank.decays import draw_decays
from bank.scaled import AS_IT_IS, Scale
from scoring import GOOD, Row, append, engine, read, row_of, share

from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.workflows.diagnose import diagnose

SCALES = {"small": Scale(0.064, 0.4), "as it is": AS_IT_IS, "large": Scale(15.6, 2.5)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--out", type=Path, default=Path("out/scale.jsonl"))
    parser.add_argument("--summary", action="store_true", help="judge what is in the file and run nothing")
    arguments = parser.parse_args()
    done, version = {(row["seed"], row["scale"]) for row in read(arguments.out)}, engine()
    seeds = [] if arguments.summary else range(arguments.first, arguments.first + arguments.count)
    for seed in seeds:
        for name, scale in SCALES.items():
            if (seed, name) in done:
                continue
            row, _ = _asked(seed, name, scale, version)
            append(arguments.out, row)
            print(_line(row), flush=True)
    print(summary(read(arguments.out)))


def _asked(seed: int, name: str, scale: Scale, version: str) -> tuple[Row, Diagnosis | None]:
    random = np.random.default_rng([seed, 0])
    odds = np.array([SHARES[kind] for kind in KINDS["decays"]])
    drawn = draw_decays(str(random.choice(KINDS["decays"], p=odds / odds.sum())), seed, None, None, False, scale)
    truth = drawn.truth
    return row_of(
        f"{name}-{seed}",
        truth.ids,
        lambda: diagnose(drawn.campaign, seed=seed),
        truth.noise_floor,
        kind=drawn.kind,
        seed=seed,
        scale=name,
        size=drawn.size,
        formula=truth.formula,
        engine=version,
    )


def _line(row: Row) -> str:
    said = "+".join(row.get("named", [])) or row.get("verdict", "")
    return (
        f"{row['seed']:<7} {row['scale']:<9} {'+'.join(row['truth']) or 'nothing':<36} {row['formula']:<36} "
        f"size {row['size']:4.2f} {row['outcome']:<12} {said}  {row['seconds']:.0f} s"
    )


def summary(rows: list[Row]) -> str:
    """How often each size is answered rightly, and as the robot that it was scaled from."""
    answers = {(row["seed"], row["scale"]): (row.get("verdict"), tuple(sorted(row.get("named", [])))) for row in rows}
    lines = []
    for name in SCALES:
        own = [row for row in rows if row["scale"] == name]
        right = sum(row["outcome"] in GOOD for row in own)
        pairs = [(row["seed"], name) for row in own if (row["seed"], "as it is") in answers]
        same = sum(answers[pair] == answers[pair[0], "as it is"] for pair in pairs)
        outcomes = ", ".join(f"{outcome} {n}" for outcome, n in Counter(row["outcome"] for row in own).most_common())
        seconds = float(np.median([row["seconds"] for row in own])) if own else float("nan")
        lines.append(
            f"{name:<9} right or tie {share(right, len(own))}; as the original {same} of {len(pairs)}; "
            f"{seconds:.0f} s; {outcomes}"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    main()
