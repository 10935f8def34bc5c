"""A statement of the thesis held against what this tool finds."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from html import escape
from typing import Any


@dataclass(frozen=True)
class Row:
    """One statement.

    Parameters
    ----------
    key : str
        Short name that stays.
    section : str
        Of the thesis.
    statement : str
        In our words.
    found : str
        Numbers measured here, with units.
    expected : str
        What the thesis says, in the same units.
    passed : bool or None
        None where nothing public allows a check; ``comment`` says why.
    comment : str
        Why it differs, or what else was seen.
    command : str
        With which a user sees it.
    """

    key: str
    section: str
    statement: str
    found: str
    expected: str
    passed: bool | None
    comment: str = ""
    command: str = ""

    def __post_init__(self) -> None:
        if self.passed is not None:  # numpy's own bool is neither True nor JSON
            object.__setattr__(self, "passed", bool(self.passed))

    @property
    def mark(self) -> str:
        """yes, NO, or – for what cannot be checked."""
        return {True: "yes", False: "NO", None: "–"}[self.passed]


@dataclass(frozen=True)
class Scoreboard:
    """All statements of sections 2, 3 and 6, in the order of the digest."""

    rows: tuple[Row, ...]

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __getitem__(self, key: str) -> Row:
        return next(row for row in self.rows if row.key == key)

    @property
    def counts(self) -> tuple[int, int, int]:
        """How many hold, do not hold, cannot be checked."""
        marks = [row.passed for row in self.rows]
        return marks.count(True), marks.count(False), marks.count(None)

    @property
    def summary(self) -> str:
        """One line."""
        held, broken, open_ = self.counts
        return f"{held} statements of the thesis hold, {broken} do not, {open_} cannot be checked"

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        held, broken, open_ = self.counts
        return {"held": held, "broken": broken, "unchecked": open_, "rows": [asdict(row) for row in self.rows]}

    def __str__(self) -> str:
        lines = [self.summary]
        for row in self.rows:
            lines.append(f"{row.mark:<4}{row.section:<5} {row.statement}")
            lines.append(f"          found {row.found}; expected {row.expected}")
            if row.comment and row.passed is not True:
                lines += textwrap.wrap(row.comment, 100, initial_indent=" " * 10, subsequent_indent=" " * 10)
            lines.append(f"          {row.command}")
        return "\n".join(lines)

    def markdown(self) -> str:
        """A table."""
        lines = ["| | section | statement | found here | expected | remark | command |", f"|{' --- |' * 7}"]
        for row in self.rows:
            lines.append(
                f"| {row.mark} | {row.section} | {row.statement} | {row.found} | {row.expected} | {row.comment} "
                f"| `{row.command}` |"
            )
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        body = "".join(
            "<tr>"
            + "".join(
                f"<td>{escape(text)}</td>"
                for text in (row.mark, row.section, row.statement, row.found, row.expected, row.comment, row.command)
            )
            + "</tr>"
            for row in self.rows
        )
        names = ("", "section", "statement", "found", "expected", "remark", "command")
        head = "".join(f"<th>{name}</th>" for name in names)
        return f"<p>{escape(self.summary)}</p><table><tr>{head}</tr>{body}</table>"
