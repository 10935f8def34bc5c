"""How engines of the doctor fare on a frozen set of sessions: one table per engine, and two engines side by side.

    make bench-doctor                                       # the small form: N=3
    make bench-doctor N=100 FAMILIES=rigs,rig-nulls         # more of some families
    make bench-doctor START=1000 N=100                      # sessions that are not in the frozen set
    make bench-doctor ENGINE=module:function                # another engine than `ident diagnose`
    python benchmarks/bench_doctor.py --between fc9efe7-diagnose 1a2b3c4-second

Every session runs in a process of its own on one core, as many side by side as there are cores, and is given up after
``--limit`` seconds of processor. Its row goes at once
to ``benchmarks/results/doctor/COMMIT-ENGINE.jsonl``, so that a run goes on where it was stopped; sessions that lie
beside the checkout and are absent are passed over with a word. Tables count the sessions that were asked for, or with
``--between`` those that both files have.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import active_children
from pathlib import Path
from queue import SimpleQueue
from threading import Event

from doctor.engines import ENGINES
from doctor.frozen import FAMILIES, Case
from doctor.session_process import answered
from doctor.side_by_side import differences
from doctor.sources import absent, cases
from doctor.tables import answers, said, table
from doctor.unseen import with_unseen
from scoring import Row, append, engine, read

RESULTS = Path(__file__).parent / "results" / "doctor"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", "--count", type=int, default=3, help="N: sessions of a stream of share 1")
    parser.add_argument("--start", type=int, default=0, help="sessions of every stream that are passed over")
    parser.add_argument("--families", default=",".join(FAMILIES), help=f"of {', '.join(FAMILIES)}")
    parser.add_argument("--engine", default="diagnose", help=f"{', '.join(ENGINES)}, or module:function")
    parser.add_argument("--limit", type=float, default=300.0, help="processor seconds that a session may take")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin no session after so long")
    parser.add_argument("--show", action="store_true", help="run nothing, print what is stored")
    parser.add_argument("--visible", action="store_true", help="work out whether what was missed shows at all")
    parser.add_argument("--list", action="store_true", help="with every session's own line")
    parser.add_argument("--between", nargs=2, metavar="STORED", help="two result files by name, side by side")
    asked = parser.parse_args()
    families = tuple(asked.families.split(","))
    if unknown := set(families) - set(FAMILIES):
        parser.error(f"--families: no {', '.join(sorted(unknown))}; there are {', '.join(FAMILIES)}")
    if asked.between:
        for name in asked.between:
            if not (RESULTS / f"{name}.jsonl").is_file():
                there = ", ".join(sorted(file.stem for file in RESULTS.glob("*-*.jsonl"))) or "none yet"
                parser.error(f"--between: no results of {name}; there are {there}")
        between(*asked.between, families)
        return
    for folder in absent():
        print(f"{folder} is not there: its sessions are passed over")
    wanted = list(cases(families, asked.count, asked.start))
    file = RESULTS / f"{engine()}-{asked.engine.replace(':', '.')}.jsonl"
    if not asked.show:
        run(wanted, asked.engine, file, asked.limit, asked.seconds)
    found = {row["key"]: row for row in read(file)}
    rows = [found[case.key] for case in wanted if case.key in found]
    if asked.visible:
        from doctor.visible import look

        look(rows)
    rows = with_unseen(rows)
    if asked.list:
        print("\n".join(line_of(row) for row in rows))
    took = sum(row["seconds"] for row in rows)
    print(f"{file.stem}, {len(rows)} of {len(wanted)} sessions, {took:.0f} s of processor")
    print(f"\n{table(rows)}\n\n{answers(rows)}")


def run(wanted: list[Case], engine_name: str, file: Path, limit: float, seconds: float) -> None:
    """What has no row yet, one session on every core."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that the sessions' own processes end as well
    done = {row["key"] for row in read(file)}
    end = time.monotonic() + seconds
    cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [None]
    free: SimpleQueue[int | None] = SimpleQueue()
    for core in cores:
        free.put(core)
    stopped = Event()

    def one(case: Case) -> None:
        if stopped.is_set() or time.monotonic() > end:
            return
        core = free.get()
        row = answered(case, engine_name, limit, core)
        free.put(core)
        if not stopped.is_set():
            append(file, row)
            print(line_of(row), flush=True)

    with ThreadPoolExecutor(len(cores)) as side_by_side:
        try:
            for _ in side_by_side.map(one, [case for case in wanted if case.key not in done]):
                pass
        finally:  # also where this process is told to stop
            stopped.set()
            for session in active_children():
                session.kill()


def line_of(row: Row) -> str:
    """One session."""
    truth = " or ".join("+".join(names) or "nothing" for names in row.get("right", []))
    return f"{row['key']:<34} {truth:<40} {row['outcome']:<13} {row['seconds']:6.1f} s  {said(row)}"


def between(first: str, second: str, families: tuple[str, ...]) -> None:
    """Tables of the sessions that both have, and the differences."""
    stored = [with_unseen(read(RESULTS / f"{name}.jsonl")) for name in (first, second)]
    stored = [[row for row in own if row["family"] in families] for own in stored]
    both = {row["key"] for row in stored[0]} & {row["key"] for row in stored[1]}
    rows = [[row for row in own if row["key"] in both] for own in stored]
    for name, own in zip((first, second), rows, strict=True):
        print(f"{name}\n\n{table(own)}\n\n{answers(own)}\n")
    print(differences(*rows))


if __name__ == "__main__":
    main()
