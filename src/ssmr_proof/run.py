"""The whole proof: generate, seal, diagnose blind, open, score."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from ssmr_ident.core.atomic import make_folder
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_proof.blind import DIAGNOSE, BlindRun, run_blind
from ssmr_proof.drawn.cases import draw_case
from ssmr_proof.lab.case import Extent, record, write_session
from ssmr_proof.scores.answer import read_answer
from ssmr_proof.scores.heldout import judged
from ssmr_proof.scores.score import marked
from ssmr_proof.scores.summary import Summary, summarised
from ssmr_proof.scores.table import Row, write_table
from ssmr_proof.seal import Envelope, read_seals, session_digest, write_seals

Progress = Callable[[str, int, int], None]
STAGES = ("recording", "diagnosing", "opening")


@dataclass(frozen=True)
class Proof(Shown):
    """What a proof came to.

    Parameters
    ----------
    seed : int
    rows : tuple of Row
    folder : Path
    seals : Path
    """

    seed: int
    rows: tuple[Row, ...]
    folder: Path
    seals: Path

    @property
    def summary(self) -> Summary:
        return summarised(self.rows)

    def __str__(self) -> str:
        return f"proof of {len(self.rows)} cases, seed {self.seed}\n{self.summary}"


def prove(
    cases: int,
    seed: int,
    out: Path,
    jobs: int = 1,
    command: Sequence[str] = DIAGNOSE,
    extent: Extent | None = None,
    progress: Progress | None = None,
    announce: Callable[[str], None] | None = None,
) -> Proof:
    """Run a proof.

    Parameters
    ----------
    cases, seed : int
    out : Path
        Holds nothing yet, or an earlier proof, which is replaced.
    jobs : int
        Processes side by side.
    command : sequence of str
        That diagnoses; see `blind.DIAGNOSE`.
    extent : Extent, optional
        How much is recorded of each case.
    progress : callable, optional
        Takes a stage, how many of its cases are done, and of how many.
    announce : callable, optional
        Takes the list of seals as text, before the first diagnosis starts.

    Raises
    ------
    SealBroken
        What is opened is not what was sealed.
    """
    report = progress or (lambda stage, done, total: None)
    _emptied(out)
    envelopes = _sealed(cases, seed, out / "sessions", jobs, extent, report)
    seals = out / "seals.csv"
    write_seals(seals, envelopes)
    if announce:
        announce(seals.read_text(encoding="utf-8"))
    runs = _diagnosed(envelopes, out, jobs, command, report)
    rows = _opened(envelopes, runs, out, jobs, report)
    write_table(out / "proof.csv", rows)
    return Proof(seed, tuple(rows), out, seals)


def seal_case(seed: int, number: int, sessions: Path, extent: Extent | None = None) -> Envelope:
    """Record one case: its session goes into ``sessions``, its truth and held-out recordings into an envelope."""
    recorded = record(draw_case(seed, number), extent)
    write_session(recorded, sessions / recorded.case.name, heldout=False)
    with tempfile.TemporaryDirectory(prefix="ident-") as place:
        folder = Path(place) / "heldout"
        write_session(recorded, folder, heldout=True)
        files = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
    session = session_digest(sessions / recorded.case.name)
    return Envelope(recorded.case.name, recorded.truth_text().encode(), files, session)


def open_case(envelope: Envelope, seal: str, run: BlindRun, folder: Path, answer_folder: Path) -> Row:
    """Open one envelope into ``folder``, mark the answer, and try both models on the held-out recordings."""
    truth = envelope.opened(seal)
    envelope.unpack(folder)
    answer = read_answer(answer_folder)
    heldout = judged(folder / "heldout", answer.folder, truth)
    return Row(truth, answer, marked(truth, answer), heldout, run.seconds, run.failure)


def _sealed(
    cases: int, seed: int, sessions: Path, jobs: int, extent: Extent | None, report: Progress
) -> list[Envelope]:
    with processes(jobs) as submit:
        waiting = [submit(seal_case, seed, number, sessions, extent) for number in range(1, cases + 1)]
        for done, _ in enumerate(as_completed(waiting), start=1):
            report(STAGES[0], done, cases)
        return [future.result() for future in waiting]


def _diagnosed(
    envelopes: Sequence[Envelope], out: Path, jobs: int, command: Sequence[str], report: Progress
) -> list[BlindRun]:
    with ThreadPoolExecutor(jobs) as pool:
        waiting = [
            pool.submit(run_blind, command, out / "sessions" / envelope.case, out / "answers" / envelope.case)
            for envelope in envelopes
        ]
        for done, _ in enumerate(as_completed(waiting), start=1):
            report(STAGES[1], done, len(waiting))
        return [future.result() for future in waiting]


def _opened(
    envelopes: Sequence[Envelope], runs: Sequence[BlindRun], out: Path, jobs: int, report: Progress
) -> list[Row]:
    seals = read_seals(out / "seals.csv")  # as they lie on disk, not as this process remembers them
    with processes(jobs) as submit:
        waiting = [
            submit(open_case, envelope, seals.get(case, ""), run, out / "opened" / case, out / "answers" / case)
            for envelope, run in zip(envelopes, runs, strict=True)
            for case in (envelope.case,)
        ]
        for done, _ in enumerate(as_completed(waiting), start=1):
            report(STAGES[2], done, len(waiting))
        return [future.result() for future in waiting]


@contextmanager
def processes(jobs: int) -> Iterator[Callable[..., Future[Any]]]:
    """A pool's submit; one job needs no process of its own."""
    if jobs > 1:
        with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
            yield pool.submit
    else:
        with ThreadPoolExecutor(1) as thread:
            yield thread.submit


def _emptied(out: Path) -> None:
    """A folder for a proof; an earlier one is removed, anything else is left alone."""
    if out.exists() and any(out.iterdir()):
        if not (out / "seals.csv").is_file():
            raise InputError(str(out), "holds something that is no proof", "Name a new folder with -o")
        for name in ("sessions", "answers", "opened"):
            shutil.rmtree(out / name, ignore_errors=True)
        for name in ("seals.csv", "proof.csv", "proof.html", "proof.md"):
            (out / name).unlink(missing_ok=True)
    make_folder(out / "sessions")
    make_folder(out / "answers")
