"""What many small sessions cost beside their own seconds, and whether killing costs more than time.

python benchmarks/bench_batch.py --count 2000 --alone            # fitted only, and by one process without a batch
python benchmarks/bench_batch.py --count 20 --diagnose --report
python benchmarks/bench_batch.py --count 200 --kills 3 --dask

Beside the seconds of the clock stand those of the processor, which other work on the machine hardly changes.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

from ssmr_ident.workflows.batch.results import read_results

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from small_fleet import write_fleet

ALONE = """
import sys, time
from pathlib import Path
out = Path(sys.argv[1])
from ssmr_ident import fit_session, write_parameters
import ssmr_ident.workflows.fit.run
begun = time.monotonic()
for name in sys.argv[2:]:
    write_parameters(out / f"{Path(name).name}.yaml", fit_session(name).parameters)
print(time.monotonic() - begun)
"""
"""The same fits, one after the other in one process, their answers written, and nothing else."""


def batch(folder: Path, out: Path, words: list[str]) -> list[str]:
    return [sys.executable, "-m", "ssmr_ident", "batch", str(folder), "-o", str(out), "-q", *words]


def memory_mb(above: int) -> float:
    """Of the largest process below one [MB]; 0 where the system does not say."""
    facts = {}
    for status in Path("/proc").glob("[0-9]*/status"):
        with suppress(OSError):
            rows = dict(row.split(":\t", 1) for row in status.read_text().splitlines() if ":\t" in row)
            facts[int(rows["Pid"])] = (int(rows["PPid"]), float(rows.get("VmRSS", "0 kB").split()[0]) / 1024)
    below, size = {above}, 0
    while len(below) > size:
        size = len(below)
        below |= {process for process, (parent, _) in facts.items() if parent in below}
    return max((facts[process][1] for process in below - {above} if process in facts), default=0.0)


def _begun(out: Path) -> int:
    """Sessions begun so far; what asks more of the disk would take a share of what is measured."""
    return sum(1 for _ in (out / "sessions").iterdir()) if (out / "sessions").is_dir() else 0


def alone(folders: list[Path], out: Path, processes: int) -> tuple[float, float, float]:
    """Seconds of the clock and of processors for processes that share sessions out beforehand and know of no other.

    The third is what a session takes such a process by the clock, imports aside.
    """
    out.mkdir()
    begun, used = time.monotonic(), _processor_s()
    commands = [[sys.executable, "-c", ALONE, str(out), *map(str, folders[k::processes])] for k in range(processes)]
    runs = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for command in commands]
    inside = [float(run.communicate()[0]) for run in runs]
    return time.monotonic() - begun, _processor_s() - used, sum(inside) / len(folders)


def watched(command: list[str], out: Path, every: float = 5.0) -> tuple[float, float, list[tuple[int, float]]]:
    """Seconds of the clock and of processors, and over the run how many sessions were begun and the memory [MB]."""
    begun, used = time.monotonic(), _processor_s()
    run = subprocess.Popen(command)
    seen = []
    while True:
        try:
            run.wait(every)
            break
        except subprocess.TimeoutExpired:
            seen.append((_begun(out), memory_mb(run.pid)))
    return time.monotonic() - begun, _processor_s() - used, seen


def _processor_s() -> float:
    """Of all children so far that have ended, and theirs."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


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
            time.sleep(0.5)
        run.kill()
        run.wait()
    subprocess.run(batch(folder, out, words), check=True)


def on_dask(folder: Path, out: Path, words: list[str], count: int) -> str:
    """Two workers, one of them killed half way; what travelled, and what the scheduler had to do, of each session."""
    say = out.parent / "scheduler.json"
    start = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--scheduler-file", str(say), "--port", "0"]
    scheduler = subprocess.Popen([*start, "--no-dashboard"], stderr=subprocess.DEVNULL)
    work = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(say), "--nthreads", "1"]
    workers = [subprocess.Popen([*work, "--no-dashboard", "--no-nanny"], stderr=subprocess.DEVNULL) for _ in range(2)]
    try:
        while not say.is_file():
            time.sleep(0.1)
        address = json.loads(say.read_text(encoding="utf-8"))["address"]
        time.sleep(10.0)  # of workers that begin
        idle = _watch(scheduler.pid)
        time.sleep(10.0)
        begun = _watch(scheduler.pid)
        run = subprocess.Popen(batch(folder, out, [*words, "--scheduler", address]))
        while run.poll() is None and sum(1 for _ in out.rglob("row.json")) < count / 2:
            time.sleep(0.5)
        workers[0].kill()
        run.wait()
        ended = _watch(scheduler.pid)
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()
    wall, travelled, busy = (b - a for a, b in zip(begun, ended, strict=True))
    still, idle_bytes, idle_busy = (b - a for a, b in zip(idle, begun, strict=True))
    travelled, busy = travelled - idle_bytes * wall / still, busy - idle_busy * wall / still
    return (
        f"beyond what Dask does at rest, a session: {travelled / count / 1e3:.2f} kB travelled (task, row and all of "
        f"Dask's words), {1e3 * busy / count:.2f} ms of the scheduler's processor ({count / wall:.1f} sessions/s here)"
    )


def _watch(scheduler: int) -> tuple[float, int, float]:
    """The time [s], bytes that went through the loopback, and the scheduler's processor time [s], so far."""
    return time.monotonic(), _loopback_bytes(), _processor_of(scheduler)


def _loopback_bytes() -> int:
    """Sent so far from this machine to itself."""
    lines = Path("/proc/net/dev").read_text(encoding="ascii").splitlines()
    return int(next(line for line in lines if line.strip().startswith("lo:")).split(":")[1].split()[8])


def _processor_of(process: int) -> float:
    """Seconds of a processor that a process has used."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--alone", action="store_true", help="fit all of them in one process without a batch, too")
    parser.add_argument("--diagnose", action="store_true", help="diagnose as well")
    parser.add_argument("--report", action="store_true", help="draw pages of diagnoses")
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--dask", action="store_true")
    a = parser.parse_args()
    words = [*([] if a.report else ["--no-report"]), *([] if a.diagnose else ["--no-diagnose"])]
    here = [*words, "--jobs", str(a.jobs)]
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        names = write_fleet(root / "in", a.count)
        wall, used, seen = watched(batch(root / "in", root / "out", here), root / "out")
        own = read_results(root / "out").sessions.seconds.sum()
        print(
            f"{a.count} sessions, {a.jobs} processes: {wall:.1f} s, {used:.1f} s of processors, {own:.1f} in sessions"
        )
        beside = f"{(wall * a.jobs - own) / a.count:.3f} s by the clock, {(used - own) / a.count:.3f} of processors"
        print(f"a session, beside its own seconds: {beside}")
        shown = seen[:: max(1, len(seen) // 8)]
        print("sessions begun, memory of the largest process [MB]:", *(f"{n}: {mb:.0f}" for n, mb in shown))
        if a.alone:
            folders = [root / "in" / name for name in names]
            clock, spent, each = alone(folders, root / "alone", 1)
            print(f"by one process without a batch: {clock:.1f} s, {spent:.1f} s of its processor")
            print(f"efficiency: {clock / wall / a.jobs:.1%} by the clock, {spent / used:.1%} of processors' seconds")
            *_, beside = alone(folders[: max(a.jobs, a.count // 5)], root / "beside", a.jobs)
            print(f"{a.jobs} such processes side by side, which is this machine's own limit: {each / beside:.1%}")
        if a.kills:
            killed(root / "in", root / "killed", here, a.kills, a.count)
            print(
                f"killed {a.kills} times and resumed: {'the same' if same(root / 'out', root / 'killed') else 'OTHERS'}"
            )
        if a.dask:
            told = on_dask(root / "in", root / "dask", words, a.count)
            print(f"two Dask workers, one killed: {'the same' if same(root / 'out', root / 'dask') else 'OTHERS'}")
            print(told)


if __name__ == "__main__":
    main()
