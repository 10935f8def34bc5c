"""Results of a batch as Parquet files, and as data frames."""

from __future__ import annotations

import io
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from ssmr_ident.core.atomic import write_bytes
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_ident.workflows.batch.schema import COLUMNS, explanation_rows, parameter_rows, session_row
from ssmr_ident.workflows.parquet import parquet


@dataclass(frozen=True, eq=False)
class Results(Shown):
    """What many sessions came to; columns as in docs/howto/batch.md.

    Parameters
    ----------
    folder : Path
    sessions, parameters, explanations : DataFrame
        A row a session, a parameter of a session, an explanation tried in a session.
    """

    folder: Path
    sessions: pd.DataFrame
    parameters: pd.DataFrame
    explanations: pd.DataFrame

    def __str__(self) -> str:
        states = self.sessions.status.value_counts()
        lines = [f"{len(self.sessions)} sessions: " + ", ".join(f"{n} {state}" for state, n in states.items())]
        found = self.sessions[self.sessions.verdict != ""]
        if len(found):
            named = found.effects.where(found.effects != "", found.verdict).value_counts()
            width = max(map(len, named.index))
            lines += [f"  {name:<{width}}  {n:>6}  {100 * n / len(found):5.1f} %" for name, n in named.items()]
        return "\n".join(lines)


def write_results(folder: Path, rows: Iterable[dict[str, Any]]) -> Results:
    """Lay rows down as ``sessions.parquet``, ``parameters.parquet`` and ``explanations.parquet``.

    Parameters
    ----------
    folder : Path
    rows : iterable of dict
        What each session came to, in the order of their names.
    """
    arrow = parquet()
    rows = list(rows)
    tables = {
        "sessions": [session_row(row) for row in rows],
        "parameters": [line for row in rows for line in parameter_rows(row)],
        "explanations": [line for row in rows for line in explanation_rows(row)],
    }
    for name, lines in tables.items():
        types = {"string": arrow.string(), "double": arrow.float64(), "int64": arrow.int64(), "bool": arrow.bool_()}
        fields = [
            arrow.field(column, types[kind], metadata={"meaning": meaning})
            for column, (kind, meaning) in COLUMNS[name].items()
        ]
        words = [column for column, (kind, _) in COLUMNS[name].items() if kind == "string"]
        lines = [{**line, **{word: line.get(word) or "" for word in words}} for line in lines]
        stream = io.BytesIO()
        arrow.parquet.write_table(arrow.Table.from_pylist(lines, schema=arrow.schema(fields)), stream)
        write_bytes(folder / f"{name}.parquet", stream.getvalue())
    return read_results(folder)


def read_results(folder: str | Path) -> Results:
    """Data frames of what ``ident batch`` left in a folder.

    Raises
    ------
    InputError
        No results there, or pyarrow is not installed.
    """
    parquet()
    folder = Path(folder)
    for name in COLUMNS:
        if not (folder / f"{name}.parquet").is_file():
            raise InputError(str(folder), f"holds no {name}.parquet", "Make it: ident batch SESSIONS -o FOLDER")
    return Results(folder, **{name: pd.read_parquet(folder / f"{name}.parquet") for name in COLUMNS})
