"""A table as a log holds it, before units and names are settled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.recording import Note


@dataclass
class Column:
    """A column as the file has it.

    Parameters
    ----------
    label : str
        Header without its unit.
    unit : str or None
        As written; None when none is stated.
    values : (n,) float
    clock : bool
        True for times of day and dates, in seconds.
    quantity : str or None
        In this package's words, where the reader or the user knows it; else the label says.
    source : str
        Where the unit is from, when the header does not write it.
    start, step : float [s]
        The column's own clock, where the format states one; a step of 0 is none.
    number : int
        Place in the file, from 0.
    given : bool
        True when the user named the quantity.
    role : str
        ``counter`` or ``ignored`` for what is no measurement.
    rows : (k,) int or None
        Rows of the table that are this column's samples, where a row is of one sensor; None for all.
    """

    label: str
    unit: str | None
    values: np.ndarray
    clock: bool = False
    quantity: str | None = None
    source: str = ""
    start: float = 0.0
    step: float = 0.0
    number: int = -1
    given: bool = False
    role: str = ""
    rows: np.ndarray | None = None

    @property
    def shown(self) -> str:
        """What a message calls the column; never empty."""
        return self.label or f"column {self.number + 1}"


@dataclass
class Table:
    """Columns with what is known about them.

    Parameters
    ----------
    columns : list of Column
        Of one length, unless they have clocks of their own.
    place : function of int to str
        Names a row for the user.
    part : str
        Part of the file, for the provenance.
    header : dict
    notes : list of Note
    assumed_unit : str or None
        Unit of columns that state none (``V`` where LabVIEW wrote the log), with a warning.
    axes_in_volts : bool
        Three voltage columns are x, y, z (logs of a data-acquisition card).
    split : bool
        A restart of time begins another sample.
    rate : float [Hz]
        That facts above the table state, for one without a time column; 0 for none.
    rate_from : str
        The fact as written.
    words : list of str
        Columns that hold text and are left out.
    """

    columns: list[Column]
    place: Callable[[int], str]
    part: str = ""
    header: dict[str, str] = field(default_factory=dict)
    notes: list[Note] = field(default_factory=list)
    assumed_unit: str | None = None
    axes_in_volts: bool = False
    split: bool = False
    rate: float = 0.0
    rate_from: str = ""
    words: list[str] = field(default_factory=list)

    def inform(self, text: str) -> None:
        self.notes.append(Note("info", text, self.part))

    def warn(self, text: str) -> None:
        self.notes.append(Note("warning", text, self.part))


def all_finite(values: np.ndarray) -> bool:
    """True when (n,) values are numbers throughout; NaN and infinity show in the least and the largest."""
    return len(values) == 0 or bool(np.isfinite(values.min()) and np.isfinite(values.max()))


def at_lines(lines: np.ndarray) -> Callable[[int], str]:
    """Names rows by their lines in the file, (n,) int."""
    return lambda row: f"line {lines[row]}"


def facts(pairs: Mapping[str, str]) -> dict[str, str]:
    """Header facts without empty ones, cut to a sane length."""
    return {key[:80]: value[:400] for key, value in list(pairs.items())[:200] if key and value}
