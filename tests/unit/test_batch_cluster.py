"""The same on a Dask cluster, one of whose workers dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
from small_fleet import write_fleet

from ssmr_ident.core.errors import InputError
from ssmr_ident.workflows.batch.run import run_batch

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.slow


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_a_worker_that_dies_loses_nothing(tmp_path: Path) -> None:
    write_fleet(tmp_path / "in", 6)
    say = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    scheduler = subprocess.Popen([*dask, "--scheduler-file", str(say), "--port", "0", "--no-dashboard"])
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(say), "--nthreads", "1"]
    workers = [subprocess.Popen([*worker, "--no-dashboard", "--no-nanny"]) for _ in range(2)]
    try:
        address = distributed.utils.json_load_robust(say, timeout=120)["address"]
        with distributed.Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=120)

        def kill_one(row: dict, done: int, total: int) -> None:
            if done == 1:
                os.kill(workers[0].pid, signal.SIGKILL)

        found = run_batch(
            tmp_path / "in", tmp_path / "out", diagnose=False, scheduler=address, timeout=300.0, progress=kill_one
        ).results
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()
    here = run_batch(tmp_path / "in", tmp_path / "here", diagnose=False, jobs=1).results
    assert set(found.sessions.status) == {"done"}
    pd.testing.assert_frame_equal(found.parameters, here.parameters)


def test_a_scheduler_that_does_not_answer_is_said(tmp_path: Path) -> None:
    write_fleet(tmp_path / "in", 1)
    with pytest.raises(InputError, match="does not answer"):
        run_batch(tmp_path / "in", tmp_path / "out", scheduler="tcp://127.0.0.1:9")
