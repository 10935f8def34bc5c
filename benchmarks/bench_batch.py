"""What many small sessions cost beside their own seconds, and whether killing costs more than time.

python benchmarks/bench_batch.py --count 2000            # fitted only
python benchmarks/bench_batch.py --count 40 --diagnose
python benchmarks/bench_batch.py --count 200 --kills 3 --dask
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pandas as pd

from ssmr_ident.workflows.batch import read_results

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from small_fleet import write_fleet


def batch(folder: Path, out: Path, words: list[str]) -> list[str]:
    return [sys.executable, "-m", "ssmr_ident", "batch", str(folder), "-o", str(out), "-q", *words]


def memory_mb(parent: int) -> float:
    """Of the largest child of a process [MB]; 0 where the system does not say."""
    sizes = [0.0]
    for status in Path("/proc").glob("[0-9]*/status"):
        try:
            facts = dict(line.split(":\t", 1) for line in status.read_text().splitlines() if ":\t" in line)
        except OSError:
            continue
        if facts.get("PPid", "").strip() == str(parent) and "VmRSS" in facts:
            sizes.append(float(facts["VmRSS"].split()[0]) / 1024)
    return max(sizes)


def watched(command: list[str], out: Path, every: float = 5.0) -> tuple[float, list[tuple[int, float]]]:
    """Wall time [s], and how many sessions were done and the memory [MB] then, over the run."""
    begun = time.monotonic()
    run = subprocess.Popen(command)
    seen = []
    while run.poll() is None:
        time.sleep(every)
        seen.append((sum(1 for _ in out.rglob("row.json")), memory_mb(run.pid)))
    return time.monotonic() - begun, seen


def same(one: Path, other: Path) -> bool:
    """Whether two runs came to the same, times aside."""
    a, b = read_results(one), read_results(other)
    tables = ((a.sessions.drop(columns="seconds"), b.sessions.drop(columns="seconds")), (a.parameters, b.parameters))
    return all(x.equals(y) for x, y in tables)


def killed(folder: Path, out: Path, words: list[str], times: int, count: int) -> None:
    """Start and kill, each time a further share of the way, then run to the end."""
    for kill in range(1, times + 1):
        run = subprocess.Popen(batch(folder, out, words))
        while run.poll() is None and sum(1 for _ in out.rglob("row.json")) < kill * count / (times + 1):
            time.sleep(0.05)
        run.kill()
        run.wait()
    subprocess.run(batch(folder, out, words), check=True)


def on_dask(folder: Path, out: Path, words: list[str], count: int) -> None:
    """Two workers, one of them killed half way."""
    say = out.parent / "scheduler.json"
    start = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--scheduler-file", str(say), "--port", "0"]
    scheduler = subprocess.Popen([*start, "--no-dashboard"], stderr=subprocess.DEVNULL)
    work = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(say), "--nthreads", "1"]
    workers = [subprocess.Popen([*work, "--no-dashboard", "--no-nanny"], stderr=subprocess.DEVNULL) for _ in range(2)]
    try:
        while not say.is_file():
            time.sleep(0.1)
        address = json.loads(say.read_text(encoding="utf-8"))["address"]
        run = subprocess.Popen(batch(folder, out, [*words, "--scheduler", address]))
        while run.poll() is None and sum(1 for _ in out.rglob("row.json")) < count / 2:
            time.sleep(0.05)
        workers[0].kill()
        run.wait()
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--diagnose", action="store_true", help="diagnose as well, without pages")
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--dask", action="store_true")
    a = parser.parse_args()
    words = ["--no-report", *([] if a.diagnose else ["--no-diagnose"])]
    here = [*words, "--jobs", str(a.jobs)]
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        write_fleet(root / "in", a.count)
        wall, seen = watched(batch(root / "in", root / "out", here), root / "out")
        seconds: pd.Series = read_results(root / "out").sessions.seconds
        print(f"{a.count} sessions, {a.jobs} processes: {wall:.1f} s wall, {seconds.sum():.1f} s of processor in them")
        print(f"beside their own seconds: {(wall * a.jobs - seconds.sum()) / a.count:.3f} s of a processor a session")
        shown = seen[:: max(1, len(seen) // 8)]
        print("sessions done, memory of the largest process [MB]:", *(f"{n}: {mb:.0f}" for n, mb in shown))
        if a.kills:
            killed(root / "in", root / "killed", here, a.kills, a.count)
            print(
                f"killed {a.kills} times and resumed: {'the same' if same(root / 'out', root / 'killed') else 'OTHERS'}"
            )
        if a.dask:
            on_dask(root / "in", root / "dask", words, a.count)
            print(f"two Dask workers, one killed: {'the same' if same(root / 'out', root / 'dask') else 'OTHERS'}")


if __name__ == "__main__":
    main()
