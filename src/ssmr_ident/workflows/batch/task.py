"""What is asked of one session, and how a session that is done already is known again."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ssmr_ident import __version__
from ssmr_ident.core.errors import InputError
from ssmr_ident.session import Session
from ssmr_ident.workflows.files_read import files_read

ROW = "row.json"
"""Written last into a session's folder of results: where it is, the rest is."""


@dataclass(frozen=True)
class Task:
    """One session to be fitted and diagnosed.

    Parameters
    ----------
    name : str
        Folder of the session below the folder that was searched, with ``/``; ``.`` for that folder itself.
    folder, out : str
        Absolute: the session, and where its results go.
    params : str
        Parameter file known beforehand; empty for the session's own.
    diagnose, report : bool
        Whether the session is diagnosed beside being fitted, and whether its page is drawn.
    seed : int
    effects : tuple of str
        Absolute: Python files with effects of the user's own.
    """

    name: str
    folder: str
    out: str
    params: str = ""
    diagnose: bool = True
    report: bool = True
    seed: int = 0
    effects: tuple[str, ...] = ()

    def as_line(self) -> str:
        """One line of JSON."""
        return json.dumps(asdict(self))

    @classmethod
    def from_line(cls, line: str) -> Task:
        values = json.loads(line)
        return cls(**{**values, "effects": tuple(values["effects"])})

    def fingerprint(self, session: Session | None = None) -> str:
        """SHA-256 of everything that the answer rests on: files by their content, settings, this package's version.

        Parameters
        ----------
        session : Session, optional
            As its file says, where that has been read.
        """
        digest = hashlib.sha256(f"{__version__} {self.params} {self.diagnose} {self.report} {self.seed}".encode())
        try:
            files = files_read(session or self.folder, self.params)
        except (InputError, OSError):  # a session that cannot be read is told by its file, and tried again once mended
            files = [Path(self.folder) / "session.yaml"]
        for file in (*files, *map(Path, self.effects)):
            digest.update(os.path.relpath(file, self.folder).encode())
            digest.update(hashlib.sha256(file.read_bytes()).digest() if file.is_file() else b"")
        return digest.hexdigest()

    def done(self) -> dict[str, Any] | None:
        """The row of an earlier run that rests on the same; None where there is none."""
        try:
            row = json.loads((Path(self.out) / ROW).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return row if isinstance(row, dict) and row.get("fingerprint") == self.fingerprint() else None


def find_tasks(
    folder: Path, out: Path, params: str, diagnose: bool, report: bool, seed: int, effects: tuple[str, ...] = ()
) -> tuple[Task, ...]:
    """Every session below a folder, by name; results of an earlier run are not searched.

    Raises
    ------
    InputError
        The folder is missing or holds no session, or lies where results go.
    """
    if not folder.is_dir():
        raise InputError(str(folder), "is no folder", "Give the folder that the sessions are in")
    if folder.absolute().is_relative_to(out.absolute()):
        raise InputError(str(out), "holds the sessions themselves", "Give another name with -o")
    tasks = tuple(
        Task(name, str(place), str(out.absolute() / "sessions" / name), params, diagnose, report, seed, effects)
        for name, place in _sessions(folder.absolute(), out.absolute())
    )
    if not tasks:
        raise InputError(str(folder), "holds no session.yaml, at any depth", f"Make one from logs: ident new {folder}")
    return tasks


def _sessions(folder: Path, out: Path) -> Iterator[tuple[str, Path]]:
    for file in sorted(folder.rglob("session.yaml")):
        if not file.is_relative_to(out):
            yield file.parent.relative_to(folder).as_posix(), file.parent
