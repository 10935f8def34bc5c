"""From a folder of sessions to their results: what is done already is kept, the rest is run, all of it gathered."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

from ssmr_ident.core.atomic import make_folder
from ssmr_ident.core.shown import Shown
from ssmr_ident.workflows.batch.cluster import run_on_cluster
from ssmr_ident.workflows.batch.held import held
from ssmr_ident.workflows.batch.local import run_here
from ssmr_ident.workflows.batch.task import find_tasks
from ssmr_ident.workflows.parquet import refuse_without_parquet

if TYPE_CHECKING:
    from ssmr_ident.workflows.batch.results import Results

Progress = Callable[[dict[str, Any], int, int], None]


@dataclass(frozen=True, eq=False)
class Batch(Shown):
    """What a run did: how many sessions it found done, how many it ran, and the results of all of them."""

    kept: int
    run: int
    results: Results

    def __str__(self) -> str:
        kept = f"\n  {self.kept} of them were done already" if self.kept else ""
        return f"{self.results}{kept}"


def run_batch(
    folder: str | Path,
    out: str | Path,
    *,
    params: str = "",
    diagnose: bool = True,
    report: bool = True,
    seed: int = 0,
    jobs: int = 0,
    scheduler: str = "",
    timeout: float = float("inf"),
    retry: bool = False,
    effects: Sequence[str | Path] = (),
    command: str = "",
    progress: Progress | None = None,
) -> Batch:
    """Fit and diagnose every session below a folder.

    Parameters
    ----------
    folder, out : path
        Where sessions are searched, at any depth, and where results go.
    params : str
        Parameter file known beforehand, of all of them; empty for each session's own.
    diagnose, report : bool
        False leaves the diagnosis, or its pages, out.
    seed : int
    jobs : int
        Processes on this machine; 0 for one on each processor.
    scheduler : str
        Address of a Dask scheduler whose workers see the same folders; empty for this machine.
    timeout : float [s]
        What one session may take.
    retry : bool
        Try again what failed, hung or was killed in an earlier run.
    effects : sequence of path
        Python files with effects beyond the catalogue, which every process runs.
    command : str
        The call, for the page's last lines.
    progress : callable, optional
        Called with each row, how many are done and of how many.

    Raises
    ------
    InputError
        No sessions, something that is needed is not installed, or another run holds ``out``.
    """
    refuse_without_parquet()
    folder, out = Path(folder), Path(out)
    params = str(Path(params).absolute()) if Path(params).is_file() else params
    files = tuple(str(Path(file).absolute()) for file in effects)
    tasks = find_tasks(folder, out, params, diagnose, report, seed, files)
    make_folder(out)
    with held(out):
        rows = {task.name: row for task in tasks if (row := task.done()) and (row["status"] == "done" or not retry)}
        kept = len(rows)
        left = [task for task in tasks if task.name not in rows]
        run = run_on_cluster(left, scheduler, timeout) if scheduler else run_here(left, jobs, timeout)
        with _gathered(out, rows, command) as gather:
            for row in run:
                rows[row["session"]] = row
                if progress:
                    progress(row, len(rows), len(tasks))
        return Batch(kept, len(rows) - kept, gather())


@contextmanager
def _gathered(out: Path, rows: dict[str, dict[str, Any]], command: str) -> Iterator[Callable[[], Results]]:
    """Whatever ends the run, what is done by then is laid down in tables and on a page."""

    Thread(target=import_module, args=("ssmr_ident.workflows.batch.page",), daemon=True).start()  # as sessions run

    def gather() -> Results:
        from ssmr_ident.workflows.batch.page import write_batch_page
        from ssmr_ident.workflows.batch.results import write_results

        results = write_results(out, (rows[name] for name in sorted(rows)))
        write_batch_page(results, command)
        return results

    try:
        yield gather
    except BaseException:
        if rows:
            gather()
        raise
