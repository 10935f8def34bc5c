"""How often is something named where nothing is missing? Null sessions by the thousand.

Each seed gives a family, a robot or rig, lengths and rates, coloured noise, mains, a wandering zero and gains within
the file's own uncertainty. Three in four are short (fewer and shorter recordings), so that a thousand are feasible;
the rest are full sessions.

    python benchmarks/bench_nulls.py --count 1000 --out out/nulls.jsonl
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path

import numpy as np
from bank import KINDS, draw
from scoring import Row, append, engine, read, row_of, share

from ssmr_ident.workflows.diagnose import diagnose

FAMILIES = tuple(name for name, kinds in KINDS.items() if "none" in kinds)
FULL = 0.25


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=100_000, help="first seed")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--families", default=",".join(FAMILIES), help="comma-separated, in turn")
    parser.add_argument("--out", type=Path, default=Path("out/nulls.jsonl"))
    parser.add_argument("--summary", action="store_true", help="judge what is in the file and run nothing")
    arguments = parser.parse_args()
    families = arguments.families.split(",")
    done = {row["seed"] for row in read(arguments.out)}
    seeds = [] if arguments.summary else range(arguments.first, arguments.first + arguments.count)
    version = engine()
    for seed in seeds:
        if seed in done:
            continue
        family = families[seed % len(families)]
        short = bool(np.random.default_rng([seed, 7]).random() >= FULL)
        drawn = draw(family, "none", seed, short=short)
        row, _ = row_of(
            f"{family}-{seed}",
            (),
            lambda drawn=drawn: diagnose(drawn.campaign, seed=drawn.seed),  # type: ignore[misc]
            drawn.truth.noise_floor,
            family=family,
            seed=seed,
            short=short,
            engine=version,
        )
        append(arguments.out, row)
        if row["outcome"] != "clean":
            print(f"{row['name']:<18} {row['outcome']:<13} {row.get('named', row.get('error'))}", flush=True)
    print(report(read(arguments.out)))


def report(rows: list[Row]) -> str:
    """Rates per family, and what was named."""
    lines = [f"{'family':<12}{'false alarms':<40}{'clean':<40}seconds, median"]
    for family in [*FAMILIES, "all"]:
        part = [row for row in rows if family in (row["family"], "all")]
        if part:
            alarms, clean = (sum(r["outcome"] == name for r in part) for name in ("false alarm", "clean"))
            seconds = np.median([r["seconds"] for r in part])
            lines.append(f"{family:<12}{share(alarms, len(part)):<40}{share(clean, len(part)):<40}{seconds:.1f}")
    named = Counter("+".join(row["named"]) for row in rows if row["outcome"] == "false alarm")
    others = Counter(row["outcome"] for row in rows)
    lines.append("outcomes: " + ", ".join(f"{name} {count}" for name, count in others.most_common()))
    if named:
        lines.append("named: " + ", ".join(f"{name} {count}" for name, count in named.most_common()))
    return "\n".join(lines)


if __name__ == "__main__":
    main()
