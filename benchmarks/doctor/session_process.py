"""One session in a process of its own: what hangs is killed, what crashes takes nothing with it."""

from __future__ import annotations

import math
import multiprocessing
import os
import resource
import time
import traceback
from multiprocessing.connection import Connection

from scoring import Row

from doctor.engines import ENGINES, engine_named
from doctor.frozen import Case
from doctor.judged import judged
from doctor.sources import opened

# children are forked from a process that has imported what takes long (of the package: a fork server does not find
# modules beside a script) and has started no thread
PROCESSES = multiprocessing.get_context("forkserver")
PROCESSES.set_forkserver_preload(
    ["ssmr_ident.simulate", "ssmr_ident.compare", *(e.split(":")[0] for e in ENGINES.values())]
)
PATIENCE = 10.0
"""Seconds on the clock over seconds of processor, until a session that sleeps or shares the machine is given up."""
MAKING = 600.0
"""Seconds on the clock for drawing or reading a session."""


def answered(case: Case, engine: str, limit: float, core: int | None = None) -> Row:
    """The row of one session.

    Parameters
    ----------
    case : Case
    engine : str
        See ``engine_named``.
    limit : float
        Processor seconds that the engine may take; more is a failure.
    core : int, optional
        The one that it runs on, where the system can say so.
    """
    receiver, sender = PROCESSES.Pipe(duplex=False)
    process = PROCESSES.Process(target=_answer, args=(sender, case, engine, limit, core), daemon=True)
    process.start()
    sender.close()
    row: Row = {"key": case.key, "family": case.family, "outcome": "failed", "seconds": limit}
    try:
        for patience in (MAKING, PATIENCE * limit):
            if not receiver.poll(patience):
                row["error"] = f"no answer within {patience:g} s"
                break
            row |= receiver.recv()
            if "error" in row:
                break
    except EOFError:  # it died without a word
        process.join()
        row["error"] = f"ended with {process.exitcode} (the limit is {limit:g} s of processor)"
    finally:  # also where this process is told to stop
        process.kill()
        process.join()
    return row


def _answer(sender: Connection, case: Case, engine: str, limit: float, core: int | None) -> None:
    begun = time.process_time()
    if core is not None and hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})
    try:
        session, diagnose = opened(case), engine_named(engine)
        sender.send({"right": [list(names) for names in session.right]})
        wall, begun = time.perf_counter(), time.process_time()
        most = math.ceil(begun + limit)
        resource.setrlimit(resource.RLIMIT_CPU, (most, most))
        row = judged(session, lambda: diagnose(session.campaign, seed=session.seed))
        sender.send({**row, "wall": time.perf_counter() - wall})
    except Exception:  # a session that cannot be read or breaks the engine is a result
        sender.send({"error": traceback.format_exc(limit=-3), "seconds": time.process_time() - begun})
