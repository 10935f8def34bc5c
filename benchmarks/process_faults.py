"""Faults of the world around a run, each tried on the commands a user types: what happened, as a table.

A run must do its work, or end with one line on standard error and the status that belongs to it; no traceback, no half
file, no process left behind, and within two seconds where it was asked to end.

    python benchmarks/process_faults.py             # all of them, some minutes; mounts small file systems where it may
    python benchmarks/process_faults.py --only stop # those whose name holds a word
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from small_fleet import write_fleet

MARK = "IDENT_FAULT"
"""In the environment of a run and of all that it starts, so that those left behind are found."""
PATIENCE_S = 2.0
STOPPED = "ident: stopped; what was being written is not there"


@dataclass
class Ground:
    """Where faults are tried: a rig's sessions, and a folder of its own for each try."""

    root: Path
    tried: int = 0
    env: dict[str, str] = field(default_factory=lambda: {**os.environ, "OPENBLAS_NUM_THREADS": "1"})

    def place(self) -> Path:
        self.tried += 1
        place = self.root / f"try-{self.tried}"
        place.mkdir()
        return place

    def call(self, verb: str, out: Path | str) -> list[str]:
        """A verb as it is typed, whose answer goes to ``out``."""
        session = str(self.root / "fleet" / "rig-0000")
        words = {
            "simulate": ["simulate", "p3at-extended", "-e", "free_response", "--duration-s", "1", "-o", f"{out}/r.csv"],
            "spectrum": ["spectrum", session, "-o", f"{out}/spectrum"],
            "fit": ["fit", session, "-o", f"{out}/p.yaml"],
            "diagnose": ["diagnose", session, "-o", f"{out}/diagnosis"],
            "batch": ["batch", str(self.root / "fleet"), "-o", f"{out}/batch", "--no-diagnose", "--jobs", "2"],
            "sweep": [
                *("sweep", "p3at-extended", "-e", "free_response", "--duration-s", "0.3", "--workers", "2"),
                *("--over", "lambda_max=0.2:1:4", "-o", f"{out}/sweep"),
            ],
        }[verb]
        return [sys.executable, "-m", "ssmr_ident", *words]

    def run(self, call: list[str], env: dict[str, str] | None = None, **how: Any) -> subprocess.CompletedProcess[str]:
        how = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **how}
        return subprocess.run(
            call, env={**self.env, **(env or {})}, text=True, errors="replace", timeout=900, check=False, **how
        )


@dataclass(frozen=True)
class Row:
    """What happened; ``wrong`` where it may not be."""

    what: str
    happened: str
    wrong: bool


def told(done: subprocess.CompletedProcess[str], allowed: tuple[int, ...]) -> tuple[str, bool]:
    """An ended run in words, and whether it ended as it may not."""
    lines = (done.stderr or "").strip().splitlines()
    wrong = done.returncode not in allowed or len(lines) > 1 or "Traceback" in (done.stderr or "")
    wrong |= done.returncode != 0 and not lines
    words = lines[-1].removeprefix("ident: ") if lines else "works" if done.returncode == 0 else "silent"
    return f"{words[:160]} ({done.returncode})", wrong


def half(place: Path) -> list[str]:
    """Temporary files and tables that are not whole."""
    files = [path for path in place.rglob("*") if path.is_file() and path.name != ".held"]
    ends = {".png": b"IEND\xaeB`\x82", ".parquet": b"PAR1", ".html": b"</html>", ".csv": b"\n", ".yaml": b"\n"}
    broken = [f for f in files if f.suffix in ends and not f.read_bytes().rstrip(b" ").endswith(ends[f.suffix])]
    broken = [f for f in broken if f.suffix != ".html" or b"</html>" not in f.read_bytes()[-20:]]
    return [path.name for path in (*broken, *(f for f in files if f.name.startswith(".")))]


def left(token: str) -> list[int]:
    """Processes that a run has left behind, a second after its end."""
    until = time.monotonic() + 1.0
    while True:
        found = []
        for environ in Path("/proc").glob("[0-9]*/environ"):
            try:
                if f"{MARK}={token}".encode() in environ.read_bytes().split(b"\0"):
                    found.append(int(environ.parent.name))
            except OSError:
                continue
        if not found or time.monotonic() > until:
            return found
        time.sleep(0.05)


def stop(ground: Ground, verb: str, how: signal.Signals, moments: int) -> Row:
    """A signal at moments spread over a run's length, beginning at its start."""
    begun = time.monotonic()
    ground.run(ground.call(verb, ground.place()))
    length = time.monotonic() - begun
    slowest, ended, faults = 0.0, {}, []
    for moment in range(moments):
        place, token = ground.place(), f"{verb}-{how.name}-{moment}"
        call = ground.call(verb, place)
        run = subprocess.Popen(
            call, env={**ground.env, MARK: token}, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
            start_new_session=True,
        )  # fmt: skip
        waited = 0.05 + 0.95 * length * moment / moments
        time.sleep(waited)
        asked = time.monotonic()
        if how is signal.SIGINT:
            with suppress(ProcessLookupError):
                os.killpg(run.pid, how)  # as a terminal's Ctrl-C: to all that the run has begun, too
        else:
            run.send_signal(how)
        _, said = run.communicate()
        spent = time.monotonic() - asked
        expected = {signal.SIGKILL: -9}.get(how, 128 + how)
        # Python itself had not read the first of our lines: it ends by the signal, or of an interrupted start
        early = waited < 1.0 and run.returncode in (-how, 1) and STOPPED not in said
        if run.returncode not in (0, expected) and not early:
            faults.append(f"status {run.returncode}")
        if run.returncode == expected and how is not signal.SIGKILL and said.strip() != STOPPED:
            faults.append(f"said {said.strip()[-80:]!r}")
        if run.returncode != 0:
            slowest = max(slowest, spent)
        status = "while Python starts" if early else f"{run.returncode}"
        ended[status] = ended.get(status, 0) + 1
        if how is not signal.SIGKILL and spent > PATIENCE_S:
            faults.append(f"took {spent:.1f} s")
        faults += [f"left process {number}" for number in left(token)]
        faults += [f"half {name}" for name in half(place) if how is not signal.SIGKILL or not name.startswith(".")]
    statuses = ", ".join(f"{count} x {status}" for status, count in sorted(ended.items()))
    happened = f"{statuses}; ended within {slowest:.1f} s; no half file, no process left"
    return Row(f"{how.name}, {verb}, at {moments} moments", "; ".join(faults) or happened, bool(faults))


@contextmanager
def mounted(place: Path, options: str) -> Iterator[bool]:
    """A small file system on a folder; False where this user may not."""
    quiet = {"stderr": subprocess.DEVNULL, "check": False}
    works = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(place)], **quiet).returncode == 0
    try:
        yield works
    finally:
        if works:
            subprocess.run(["umount", str(place)], **quiet)


def full(ground: Ground, verb: str, free_kB: int) -> Row:
    """A disk that has a few pages free, or none."""
    place = ground.place()
    what = f"disk with {free_kB} kB free, {verb}"
    with mounted(place, f"size={free_kB + 4}k") as works:
        if not works:
            return Row(what, "not tried: may not mount", False)
        (place / "there.bin").write_bytes(b"x" * 4096)
        words, wrong = told(ground.run([*ground.call(verb, place), "-q"]), (1, 2))
        broken = half(place)
    return Row(what, "; ".join([words, *broken]), wrong or bool(broken))


def read_only(ground: Ground, verb: str) -> Row:
    place = ground.place()
    with mounted(place, "ro") as works:
        if not works:
            return Row(f"read-only folder, {verb}", "not tried: may not mount", False)
        return Row(f"read-only folder, {verb}", *told(ground.run([*ground.call(verb, place), "-q"]), (2,)))


def limited(ground: Ground, verb: str, name: str, number: int, most: int, allowed: tuple[int, ...]) -> Row:
    """A limit of the system's, set for the run."""
    place = ground.place()
    limit = lambda: resource.setrlimit(number, (most, most))  # noqa: E731
    words, wrong = told(ground.run([*ground.call(verb, place), "-q"], preexec_fn=limit), allowed)
    broken = half(place)
    return Row(f"{name}, {verb}", "; ".join([words, *broken]), wrong or bool(broken))


def setting(ground: Ground, what: str, verb: str, **env: str | None) -> Row:
    """Another environment, in which the run must work; None stands for a variable that is not there."""
    place = ground.place()
    without = [word for key, value in env.items() if value is None for word in ("-u", key)]
    kept = {key: value for key, value in env.items() if value is not None}
    call = ["env", *without, *ground.call(verb, place), "-q"]
    return Row(f"{what}, {verb}", *told(ground.run(call, kept), (0,)))


def stream(ground: Ground, what: str, verb: str, ending: str, allowed: tuple[int, ...]) -> Row:
    """Standard streams that are closed, full or read no further."""
    call = " ".join(f"'{word}'" for word in ground.call(verb, ground.place()))
    done = ground.run(["bash", "-c", f"set -o pipefail; {call} {ending}"])
    lines = (done.stderr or "").strip().splitlines()
    words = lines[-1].removeprefix("ident: ") if lines else "silent"
    wrong = done.returncode not in allowed or len(lines) > 1 or "Traceback" in done.stderr
    return Row(f"{what}, {verb}", f"{words[:160]} ({done.returncode})", wrong)


def together(ground: Ground, verb: str) -> Row:
    """Two runs into one folder at the same time."""
    place = ground.place()
    runs = [
        subprocess.Popen([*ground.call(verb, place), "-q"], env=ground.env, stderr=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    ended = [(run.communicate()[1].strip(), run.returncode) for run in runs]
    broken = half(place)
    wrong = bool(broken) or any(code not in (0, 2) or len(said.splitlines()) > 1 for said, code in ended)
    words = " / ".join(f"{said.removeprefix('ident: ')[-90:] or 'works'} ({code})" for said, code in ended)
    return Row(f"two runs into one folder, {verb}", "; ".join([words, *broken]), wrong)


def named(ground: Ground, what: str, name: str, verb: str) -> Row:
    """A session in a folder of an odd name, whose logs and session are called so, too."""
    place = ground.place()
    folder = place / name
    shutil.copytree(ground.root / "fleet" / "rig-0000", folder)
    call = [sys.executable, "-m", "ssmr_ident", verb, f"./{name}", "-o", f"./{name}/out", "-q"]
    return Row(f"{what}, {verb}", *told(ground.run(call, cwd=place), (0,)))


def gone(ground: Ground) -> Row:
    """The folder that a run stands in has been deleted."""
    place = ground.place()
    call = " ".join(f"'{word}'" for word in ground.call("fit", ground.place()))
    done = ground.run(["bash", "-c", f"cd '{place}' && rmdir '{place}' && {call} -q"])
    return Row("the folder one stands in is deleted, fit", *told(done, (0, 2)))


NAMES = {
    "spaces": "a b  c",
    "quotes and markup": "a'b\"c <b>&amp;",
    "a line end": "two\nlines",
    "right-to-left mark": "\u202egpj",
    "a dash in front": "-rf",
    "percent and braces": "100%{x}$HOME",
    "the longest there can be": "x" * 255,
}


def faults(ground: Ground, moments: int) -> Iterator[tuple[str, Callable[[], Row]]]:
    for verb in ("simulate", "spectrum", "fit", "diagnose", "batch", "sweep"):
        for how in (signal.SIGINT, signal.SIGTERM):
            yield f"stop {verb}", lambda v=verb, h=how: stop(ground, v, h, moments)
    for verb in ("batch", "sweep"):
        yield f"stop {verb}", lambda v=verb: stop(ground, v, signal.SIGKILL, moments)
    for verb in ("simulate", "spectrum", "fit", "diagnose", "batch", "sweep"):
        yield f"full disk {verb}", lambda v=verb: full(ground, v, 0)
        yield f"read-only {verb}", lambda v=verb: read_only(ground, v)
    for verb in ("simulate", "spectrum", "diagnose", "batch", "sweep"):
        yield f"full disk {verb}", lambda v=verb: full(ground, v, 12)
    for verb in ("simulate", "fit", "batch"):
        what = "files of 100 bytes at the most"
        yield f"limit {verb}", lambda v=verb, w=what: limited(ground, v, w, resource.RLIMIT_FSIZE, 100, (1, 2))
    yield "limit", lambda: limited(ground, "fit", "900 MB of addresses", resource.RLIMIT_AS, 900 << 20, (0, 1))
    yield "limit", lambda: limited(ground, "batch", "24 open files", resource.RLIMIT_NOFILE, 24, (0, 1, 2))
    for verb in ("fit", "simulate"):
        nowhere = str(ground.root / "nowhere" / "at" / "all")
        yield f"home {verb}", lambda v=verb: setting(ground, "no HOME that can be", v, HOME="/dev/null/home")
        yield f"home {verb}", lambda v=verb: setting(ground, "no HOME", v, HOME=None)
        yield f"home {verb}", lambda v=verb: setting(ground, "HOME empty", v, HOME="")
        caches = dict.fromkeys(("NUMBA_CACHE_DIR", "MPLCONFIGDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"), "/dev/null/c")
        yield f"cache {verb}", lambda v=verb, c=caches: setting(ground, "no folder for caches", v, **c)
        yield f"temporary {verb}", lambda v=verb, n=nowhere: setting(ground, "no TMPDIR", v, TMPDIR=n)
        yield f"locale {verb}", lambda v=verb: setting(ground, "C locale", v, LC_ALL="C", LANG="C", PYTHONUTF8="0")
    yield "temporary batch", lambda: setting(ground, "no TMPDIR", "batch", TMPDIR="/dev/null/t")
    for verb in ("fit", "simulate", "batch"):
        yield f"stream {verb}", lambda v=verb: stream(ground, "standard output closed", v, ">&-", (0,))
        yield f"stream {verb}", lambda v=verb: stream(ground, "all streams closed", v, "<&- >&- 2>&-", (0,))
        yield f"stream {verb}", lambda v=verb: stream(ground, "full disk behind standard output", v, ">/dev/full", (1,))
        yield f"stream {verb}", lambda v=verb: stream(ground, "read no further", v, "| head -c 1", (0, 1, 141))
    for verb in ("fit", "simulate", "spectrum", "diagnose", "batch", "sweep"):
        yield f"two {verb}", lambda v=verb: together(ground, v)
    for what, name in NAMES.items():
        yield "name", lambda w=what, n=name: named(ground, f"folder with {w}", n, "fit")
    yield "folder", lambda: gone(ground)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="faults whose name holds this word")
    parser.add_argument("--moments", type=int, default=8, help="at which a signal is sent to each command")
    choices = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job would hand on a deaf ear
    begun, rows = time.monotonic(), []
    with tempfile.TemporaryDirectory() as name:
        ground = Ground(Path(name))
        write_fleet(ground.root / "fleet", 3)
        print("| what was tried | what happened |\n| --- | --- |", flush=True)
        for kind, fault in faults(ground, choices.moments):
            if choices.only in kind:
                row = fault()
                rows.append(row)
                happened = row.happened.replace(str(ground.root), "…").replace("|", "\\|")
                print(f"| {row.what} | {'**WRONG** ' if row.wrong else ''}{happened} |", flush=True)
    wrong = sum(row.wrong for row in rows)
    print(f"\n{len(rows)} faults tried, {wrong} wrong, {time.monotonic() - begun:.0f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
