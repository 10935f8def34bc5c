"""Does the diagnosis name what was left out? Random sessions that nobody has seen before, judged one by one.

Every session is drawn from its seed (``bank``): family, what is left out and how much of it, in the catalogue's
formula or another. One JSON line per session is appended to a file; a run that was stopped goes on where it was.

    python benchmarks/bench_diagnosis.py --first 1000 --count 100 --out out/diagnosis.jsonl
    python benchmarks/bench_diagnosis.py --out out/diagnosis.jsonl --summary
"""

from __future__ import annotations

import argparse
from pathlib import Path

from bank import FAMILIES, BankSession, draw, mixed
from scoring import UNNAMED, Row, append, engine, read, row_of, summary, table, write
from visible import true_evidence

from ssmr_ident.workflows.diagnose import diagnose


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--families", default=",".join(FAMILIES), help="comma-separated")
    parser.add_argument("--kind", help="none, one, two, other or unlisted: only these")
    parser.add_argument("--effect", help="with --kind one: only this effect")
    parser.add_argument("--out", type=Path, default=Path("out/diagnosis.jsonl"))
    parser.add_argument("--summary", action="store_true", help="judge what is in the file and run nothing")
    parser.add_argument("--table", action="store_true", help="also print a line per session")
    arguments = parser.parse_args()
    families = tuple(arguments.families.split(","))
    done = {row["seed"] for row in read(arguments.out)}
    if not arguments.summary:
        version = engine()
        for seed in range(arguments.first, arguments.first + arguments.count):
            if seed in done:
                continue
            drawn = _drawn(seed, arguments, families)
            truth = drawn.truth
            row, _ = row_of(
                f"{drawn.family}-{seed}",
                truth.ids,
                lambda drawn=drawn: diagnose(drawn.campaign, seed=drawn.seed),  # type: ignore[misc]
                truth.noise_floor,
                truth.effects,
                truth.parameters,
                family=drawn.family,
                kind=drawn.kind,
                seed=seed,
                size=drawn.size,
                formula=truth.formula,
                strength=dict(truth.effects),
                engine=version,
            )
            append(arguments.out, row)
            said = "+".join(row.get("named", [])) or row.get("verdict", "failed")
            print(
                f"{row['name']:<18} {'+'.join(truth.ids) or 'nothing':<36} {truth.formula:<44} size {drawn.size:4.2f} "
                f"{row['outcome']:<13} {said}  {row['seconds']:.1f} s",
                flush=True,
            )
    rows = read(arguments.out)
    if any("true_evidence" not in row for row in rows if row["outcome"] in UNNAMED):
        rows = [_judged(row, arguments, families) for row in rows]
        write(arguments.out, rows)
    if arguments.table:
        print(table(rows))
    print(summary(rows))
    print("\nby kind\n" + summary(rows, "kind").split("\n\n")[0])


def _drawn(seed: int, arguments: argparse.Namespace, families: tuple[str, ...]) -> BankSession:
    if arguments.kind:
        return draw(families[seed % len(families)], arguments.kind, seed, arguments.effect)
    return mixed(seed, families)


def _judged(row: Row, arguments: argparse.Namespace, families: tuple[str, ...]) -> Row:
    """A row that says, where an effect was missed, or one of two, whether its session shows it."""
    if row["outcome"] not in UNNAMED or "true_evidence" in row:
        return row
    return {**row, "true_evidence": true_evidence(_drawn(row["seed"], arguments, families))}


if __name__ == "__main__":
    main()
