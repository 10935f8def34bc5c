"""Faults of the world around a run: signals, full disks, closed ends, names. One line, or it works."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name == "nt", reason="signals and devices of POSIX")]

HARD = """
import hashlib, subprocess, sys
from ssmr_ident.core import atomic
from ssmr_ident.core.stopping import stoppable
with stoppable():
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    atomic._BEGUN.add(atomic.Path(sys.argv[1]))
    atomic.Path(sys.argv[1]).write_text("half")
    print(child.pid, flush=True)
    hashlib.pbkdf2_hmac("sha256", b"", b"", 10**9)  # minutes in which no handler of Python's is called
"""
LOG = "time [s],ax [m/s^2]\n" + "".join(f"{i / 100},{(i * i) % 7}\n" for i in range(400))
LONG = ("simulate", "p3at-extended", "-e", "free_response", "--duration-s", "2000")


def _ident(*words: str, **settings: object) -> subprocess.CompletedProcess[str]:
    call = [sys.executable, "-m", "ssmr_ident", *words]
    given = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **settings}
    return subprocess.run(call, text=True, timeout=120, check=False, **given)  # type: ignore[call-overload,no-any-return]


def _lives(process: int) -> bool:
    """Not one that has ended and waits for someone to ask how."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


def test_a_signal_in_a_destructor_says_no_more_than_any_other() -> None:
    code = """
import os, signal, time
from ssmr_ident.__main__ import main
import ssmr_ident.cli

class Slow:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.1)

def run():
    del [Slow()][0]
    time.sleep(60)

ssmr_ident.cli.main = run
main()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (130, "ident: stopped; what was being written is not there\n")


def test_a_run_that_is_done_does_not_wait_for_the_interpreter_to_take_itself_apart() -> None:
    code = """
import atexit, sys
from ssmr_ident.__main__ import main
import ssmr_ident.cli

class Kept:
    def __del__(self):
        print("taken apart")

kept = Kept()

def run():
    atexit.register(print, "let go")
    print("done")
    sys.exit(3)

ssmr_ident.cli.main = run
main()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (3, "done\nlet go\n", "")


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_loop_that_hears_nothing_ends_all_the_same(tmp_path: Path, how: signal.Signals) -> None:
    half = tmp_path / "half"
    with subprocess.Popen(
        [sys.executable, "-c", HARD, str(half)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        child = int(process.stdout.readline())
        time.sleep(0.5)  # until it is in the loop: before it Python's own handler would end it
        asked = time.monotonic()
        process.send_signal(how)
        _, told = process.communicate(timeout=30)
        spent = time.monotonic() - asked
    assert process.returncode == 128 + how
    assert spent < 2.0 + 3.0  # a busy machine's own waiting aside
    assert told == "ident: stopped; what was being written is not there\n"
    assert not half.exists()
    while _lives(child) and time.monotonic() < asked + 10.0:  # killed, it ends when it is next given a processor
        time.sleep(0.05)
    assert not _lives(child)


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_run_stopped_at_its_beginning_or_its_work_says_so(tmp_path: Path, how: signal.Signals) -> None:
    for wait in (0.3, 1.5, 4.0):
        call = [sys.executable, "-m", "ssmr_ident", *LONG, "-o", str(tmp_path / "r.csv")]
        with subprocess.Popen(call, stderr=subprocess.PIPE, text=True) as process:
            time.sleep(wait)
            process.send_signal(how)
            _, told = process.communicate(timeout=30)
        if wait < 1.0 and process.returncode in (-how, 1):  # before the interpreter had read the first of our lines
            continue
        assert process.returncode == 128 + how, told
        assert told.strip().splitlines()[-1] == "ident: stopped; what was being written is not there"
        assert "Traceback" not in told
        assert not list(tmp_path.iterdir())


def test_a_sweep_whose_terminal_is_asked_to_stop_says_one_line(tmp_path: Path) -> None:
    """Ctrl-C goes to the processes of a sweep as well, as they begin and as they work."""
    call = [sys.executable, "-m", "ssmr_ident", "sweep", "p3at-extended", "-e", "free_response", "--duration-s", "5"]
    call += ["--over", "lambda_max=0.2:1:4", "--workers", "2", "-o", str(tmp_path / "out"), "-q"]
    with subprocess.Popen(call, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        while len(list((tmp_path / "out" / "runs").glob("*.json"))) < 1:  # the first run is the sweep's own
            assert process.poll() is None
            time.sleep(0.05)
        time.sleep(0.5)
        os.killpg(process.pid, signal.SIGINT)
        _, told = process.communicate(timeout=60)
    assert (process.returncode, told) == (130, "ident: stopped; what was being written is not there\n")
    assert not [path for path in (tmp_path / "out" / "runs").iterdir() if path.name.startswith(".")]


def test_a_run_asked_to_stop_when_it_has_just_ended_keeps_to_its_statuses(tmp_path: Path) -> None:
    """From its last line to the interpreter's end is a tenth of a second."""
    for wait in (0.0, 0.02, 0.04, 0.06, 0.1):
        with subprocess.Popen(
            [sys.executable, "-m", "ssmr_ident", "effects", "dry_friction", "--json"], stdout=subprocess.PIPE, text=True
        ) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(wait)
            process.send_signal(signal.SIGTERM)
            assert process.wait(timeout=30) in (0, 143)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
@pytest.mark.parametrize("more", [(), ("--json",)])
def test_a_full_disk_behind_standard_output(more: tuple[str, ...]) -> None:
    with Path("/dev/full").open("w") as full:
        done = _ident("effects", *more, stdout=full)
    assert (done.returncode, done.stderr) == (1, "ident: standard output: No space left on device\n")


def test_a_file_that_may_not_grow(tmp_path: Path) -> None:
    import resource

    # as a full disk ends a write: some of it is there already
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))  # noqa: E731
    words = ("simulate", "p3at-extended", "-e", "free_response", "--duration-s", "1", "-o", str(tmp_path / "r.csv"))
    done = _ident(*words, preexec_fn=limit)
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith(f"ident: {tmp_path / 'r.csv'}: cannot be written (File too large)")
    assert len(done.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", [("simulate", "p3at-extended", "-e", "swivel", "-o"), ("diagnose", ".", "-o")])
def test_a_file_where_a_folder_should_be_is_told_before_any_work(tmp_path: Path, words: tuple[str, ...]) -> None:
    (tmp_path / "file").write_text("")
    done = _ident(*words, str(tmp_path / "file" / "r.csv"))
    assert done.returncode == 2
    assert f"cannot be written ({tmp_path / 'file'} is a file)" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_reader_that_has_read_enough_and_one_that_never_was() -> None:
    call = f"{sys.executable} -m ssmr_ident effects --json"
    first = subprocess.run(["sh", "-c", f"{call} | head -c 20"], capture_output=True, text=True, check=False)
    assert (first.returncode, len(first.stdout), first.stderr) == (0, 20, "")
    closed = subprocess.run(["sh", "-c", f"{call} >&-"], capture_output=True, text=True, check=False)
    assert (closed.returncode, closed.stderr) == (0, "")


def test_a_terminal_that_knows_ascii_alone() -> None:
    done = _ident("effects", "dry_friction", env={**os.environ, "LC_ALL": "C", "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0, done.stderr
    assert "…" in done.stdout or "\\u2026" in done.stdout


@pytest.mark.slow
def test_no_home_and_no_cache(tmp_path: Path) -> None:
    kept = {key: value for key, value in os.environ.items() if key not in ("MPLCONFIGDIR", "XDG_CACHE_HOME")}
    (tmp_path / "nowhere").write_text("")
    (tmp_path / "a.csv").write_text(LOG)
    home = str(tmp_path / "nowhere" / "at" / "all")
    done = _ident("spectrum", "a.csv", "-o", "out", cwd=tmp_path, env={**kept, "HOME": home})
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "out").is_dir()


CACHED = """
from pathlib import Path
from numba.core import caching
from ssmr_ident.core import kernel

def double(x):
    return 2.0 * x

def refuse(self, sig, data):
    raise OSError(28, "No space left on device")

caching.FunctionCache._save_overload = refuse
assert kernel.kernel(double)(2.0) == 4.0
caching.CacheImpl._locator_classes = []
assert kernel.kernel(double)(3.0) == 6.0
"""


def test_a_compiled_loop_that_cannot_be_kept_runs(tmp_path: Path) -> None:
    """numba's disk is full; numba finds no folder at all."""
    (tmp_path / "cached.py").write_text(CACHED)
    done = subprocess.run([sys.executable, tmp_path / "cached.py"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two\nlines.csv", "ünï — °.csv", "-rf.csv", "a'b\"c <b>.csv", "‮gpj.csv"])
def test_odd_names(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(LOG)
    done = _ident("inspect", f"./{name}", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "csv" in done.stdout


@pytest.mark.slow
def test_a_name_that_is_no_text(tmp_path: Path) -> None:
    folder = os.fsencode(tmp_path)
    with open(folder + b"/\xff\xfe.csv", "wb") as stream:  # noqa: PTH123
        stream.write(LOG.encode())
    for more in ((), ("--json",)):
        done = subprocess.run(
            [sys.executable, "-m", "ssmr_ident", "inspect", b"\xff\xfe.csv", *more], cwd=tmp_path, capture_output=True
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout
