"""A table as a log holds it, before units and names are settled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.recording import Note


@dataclass
class Column:
    """A column as the file has it: label without unit, unit as written (None: not stated), values (n,)."""

    label: str
    unit: str | None
    values: np.ndarray
    clock: bool = False
    quantity: str | None = None


@dataclass
class Table:
    """Columns of one length with what is known about them.

    Parameters
    ----------
    columns : list of Column
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
    units_given : bool
        The user's units have been applied already.
    """

    columns: list[Column]
    place: Callable[[int], str]
    part: str = ""
    header: dict[str, str] = field(default_factory=dict)
    notes: list[Note] = field(default_factory=list)
    assumed_unit: str | None = None
    axes_in_volts: bool = False
    split: bool = False
    units_given: bool = False


def all_finite(values: np.ndarray) -> bool:
    """True when (n,) values are numbers throughout; NaN and infinity show in the least and the largest."""
    return len(values) == 0 or bool(np.isfinite(values.min()) and np.isfinite(values.max()))


def at_lines(lines: np.ndarray) -> Callable[[int], str]:
    """Names rows by their lines in the file, (n,) int."""
    return lambda row: f"line {lines[row]}"


def facts(pairs: Mapping[str, str]) -> dict[str, str]:
    """Header facts without empty ones, cut to a sane length."""
    return {key[:80]: value[:400] for key, value in list(pairs.items())[:200] if key and value}
