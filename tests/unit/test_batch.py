"""Many sessions: one that fails, hangs or is killed costs itself alone; what is done is not done again."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import pandas as pd
import pytest
from small_fleet import write_fleet

from ssmr_ident.core.errors import InputError
from ssmr_ident.report.html import Link, Page, Section, Table, render_page
from ssmr_ident.workflows.batch.forked import FORKS, Forked, ForkServer
from ssmr_ident.workflows.batch.guarded import COMMAND, Guarded, environment
from ssmr_ident.workflows.batch.outliers import farthest
from ssmr_ident.workflows.batch.page import batch_page
from ssmr_ident.workflows.batch.results import Results, read_results, write_results
from ssmr_ident.workflows.batch.run import run_batch
from ssmr_ident.workflows.batch.schema import COLUMNS
from ssmr_ident.workflows.batch.task import ROW, find_tasks

DIAGNOSED = {
    "session": "a", "status": "done", "error": "", "name": "a", "robot": "rig", "baseline": "sdof",
    "experiments": ["free_response"], "recordings": 2, "logged": "2026-01-02T03:04:05+00:00", "seconds": 1.5,
    "parameters": [{"source": "fit", "parameter": "stiffness_N_m", "value": 2e3, "std": 3.0, "unit": "N/m"}],
    "diagnosis": {
        "verdict": "missing_physics", "summary": "Dry friction.",
        "effects": [{"id": "dry_friction", "confidence": 0.9}],
        "fit": {"metric": "nrmse_percent", "heldout": {"before": 20.0, "after": 2.0, "noise_floor": 1.9}},
        "explanations_tried": [{"id": "dry_friction", "log_evidence": 90.0, "heldout_metric": 2.0}],
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Three sessions of which one cannot be read, fitted."""
    folder = tmp_path_factory.mktemp("fleet")
    write_fleet(folder / "in", 2)
    (folder / "in" / "bad").mkdir()
    (folder / "in" / "bad" / "session.yaml").write_text("schema: something else\n", encoding="utf-8")
    run_batch(folder / "in", folder / "out", diagnose=False, jobs=1)
    return folder / "in", folder / "out"


@pytest.mark.slow
def test_a_session_that_cannot_be_read_costs_itself_alone(fitted: tuple[Path, Path]) -> None:
    results = read_results(fitted[1])
    assert dict(zip(results.sessions.session, results.sessions.status, strict=True)) == {
        "bad": "failed", "rig-0000": "done", "rig-0001": "done",
    }  # fmt: skip
    assert "schema" in results.sessions.error[0]
    assert list(results.sessions.columns) == list(COLUMNS["sessions"])


@pytest.mark.slow
def test_what_is_done_is_kept_and_what_has_changed_is_run_again(fitted: tuple[Path, Path]) -> None:
    folder, out = fitted
    again = run_batch(folder, out, diagnose=False, jobs=1)
    assert (again.kept, again.run) == (3, 0)
    log = folder / "rig-0001" / "decay-2.csv"
    log.write_text(log.read_text(encoding="utf-8") + "1.5,0\n", encoding="utf-8")
    again = run_batch(folder, out, diagnose=False, jobs=1)
    assert (again.kept, again.run) == (2, 1)


@pytest.mark.slow
def test_a_session_that_takes_too_long_is_stopped_and_the_next_one_runs(tmp_path: Path) -> None:
    write_fleet(tmp_path / "in", 1)
    (task,) = find_tasks(tmp_path / "in", tmp_path / "out", "", False, False, 0)
    guarded = Guarded(0.05)
    assert guarded.run(task)["status"] == "timeout"
    guarded.timeout = 300.0
    assert guarded.run(task)["status"] == "done"
    guarded.stop()


def test_a_process_that_dies_is_told_with_what_it_died_of(tmp_path: Path) -> None:
    write_fleet(tmp_path / "in", 1)
    (task,) = find_tasks(tmp_path / "in", tmp_path / "out", "", False, False, 0)
    guarded = Guarded(300.0)
    threading.Timer(0.1, lambda: guarded._living().terminate()).start()  # long before it has imported what it needs
    row = guarded.run(task)
    assert row["status"] == "killed"
    assert "SIGTERM" in row["error"] or os.name != "posix"
    assert json.loads((Path(task.out) / ROW).read_text(encoding="utf-8")) == row


@pytest.mark.slow
@pytest.mark.skipif(not FORKS, reason="forks no processes here")
def test_forked_processes_hang_and_die_as_others_and_outlive_who_forked_them(tmp_path: Path) -> None:
    write_fleet(tmp_path / "in", 1)
    (task,) = find_tasks(tmp_path / "in", tmp_path / "out", "", False, False, 0)
    server = ForkServer(COMMAND, environment())
    guarded = Guarded(300.0, server=server)
    assert guarded.run(task)["status"] == "done"
    guarded.timeout = 0.01
    assert guarded.run(task)["status"] == "timeout"
    guarded.timeout = 300.0
    child = guarded._living()
    assert isinstance(child, Forked)
    os.kill(child.pid, signal.SIGSTOP)
    threading.Timer(0.1, lambda: [os.kill(child.pid, number) for number in (signal.SIGTERM, signal.SIGCONT)]).start()
    row = guarded.run(task)
    assert (row["status"], "SIGTERM" in row["error"]) == ("killed", True)
    assert guarded.run(task)["status"] == "done"
    server.close()
    assert guarded.run(task)["status"] == "done"
    assert not isinstance(guarded._living(), Forked)
    guarded.stop()


def _marked(mark: dict[str, str]) -> list[Path]:
    """Processes that live with a mark in their environment; none where the system does not say."""
    ((name, value),) = mark.items()
    found = []
    for environ in Path("/proc").glob("[0-9]*/environ"):
        with suppress(OSError):
            if f"{name}={value}".encode() in environ.read_bytes().split(b"\0"):
                found.append(environ.parent)
    return found


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_killed_and_run_again_gives_what_one_go_gives(tmp_path: Path) -> None:
    write_fleet(tmp_path / "in", 6)
    command = [sys.executable, "-m", "ssmr_ident", "batch", str(tmp_path / "in"), "--no-diagnose", "-q", "--jobs", "1"]
    mark = {"IDENT_TRIED": str(tmp_path)}
    run = subprocess.Popen([*command, "-o", str(tmp_path / "killed")], env={**os.environ, **mark})
    rows = tmp_path / "killed" / "sessions"
    until = time.monotonic() + 300
    while len(list(rows.glob(f"*/{ROW}"))) < 2:
        assert time.monotonic() < until
        assert run.poll() is None
        time.sleep(0.02)
    assert sys.platform != "linux" or len(_marked(mark)) > 2  # the run, what forks, and what is forked
    run.kill()
    run.wait()
    while _marked(mark):
        assert time.monotonic() < until
        time.sleep(0.02)
    made = {path: path.stat().st_mtime_ns for path in rows.glob(f"*/{ROW}")}
    resumed = run_batch(tmp_path / "in", tmp_path / "killed", diagnose=False, jobs=1)
    assert resumed.kept == len(made)
    assert {path: path.stat().st_mtime_ns for path in made} == made
    whole = run_batch(tmp_path / "in", tmp_path / "whole", diagnose=False, jobs=1).results
    for name in COLUMNS:
        pd.testing.assert_frame_equal(
            getattr(resumed.results, name).drop(columns="seconds", errors="ignore"),
            getattr(whole, name).drop(columns="seconds", errors="ignore"),
        )


@pytest.mark.slow
def test_two_runs_do_not_write_into_one_folder(fitted: tuple[Path, Path]) -> None:
    from ssmr_ident.workflows.batch.held import held

    with held(fitted[1]), pytest.raises(InputError, match="another run"):
        run_batch(*fitted, diagnose=False)


def test_a_folder_without_sessions_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"holds no session\.yaml"):
        run_batch(tmp_path, tmp_path / "out")
    with pytest.raises(InputError, match=r"holds no sessions\.parquet"):
        read_results(tmp_path)


def test_another_engine_reads_the_tables(tmp_path: Path) -> None:
    duckdb = pytest.importorskip("duckdb")
    write_results(tmp_path, [DIAGNOSED])
    found = duckdb.sql(
        f"select s.effects, p.value from '{tmp_path}/sessions.parquet' s join '{tmp_path}/parameters.parquet' p "
        "using (session) where s.confidence > 0.5"
    ).fetchall()
    assert found == [("dry_friction", 2000.0)]


def test_the_page_leads_to_each_report_and_names_the_one_that_stands_apart(tmp_path: Path) -> None:
    rows = []
    for n, value in enumerate([2.0e3, 2.01e3, 1.99e3, 2.0e3, 2.02e3, 2.5e3]):
        parameter = {**DIAGNOSED["parameters"][0], "value": value}
        rows.append({**DIAGNOSED, "session": f"s{n}", "parameters": [parameter]})
    place = tmp_path / "sessions" / "s5"
    place.mkdir(parents=True)
    (place / "report.html").write_text("", encoding="utf-8")
    results = write_results(tmp_path, rows)
    assert abs(farthest(results.parameters).deviations["s5"]) > 10
    page = batch_page(results, "ident batch")
    table = next(section for section in page.sections if "outliers" in section.title).tables[0]
    assert table.rows[0][0] == Link("s5", "sessions/s5/report.html")
    assert '<a href="sessions/s5/report.html">s5</a>' in render_page(page)
    assert "dry_friction" in page.verdict.sentence


def test_a_page_takes_a_time_in_proportion_to_its_rows() -> None:
    def spent(count: int) -> float:
        table = Table("", ("session", "value", "why"), tuple((f"s{n}", f"{n}", "none") for n in range(count)))
        begun = time.process_time()
        render_page(Page("", (), (Section("", tables=(table,)),), ""))
        return time.process_time() - begun

    spent(10)
    # the garbage of other tests may be collected within one of them
    assert min(spent(1600) for _ in range(3)) < 10.0 * min(spent(400) for _ in range(3))


def test_results_print_on_a_screen(tmp_path: Path) -> None:
    results = write_results(tmp_path, [DIAGNOSED])
    assert isinstance(results, Results)
    assert "dry_friction" in str(results)
