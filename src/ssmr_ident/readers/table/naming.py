"""Which quantity each column is and in which unit: the user's word first, then the header, then what words mean."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.errors import did_you_mean
from ssmr_ident.readers.options import ReadOptions, numbered
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import heading_of


def named_columns(source: Source, table: Table, options: ReadOptions) -> list[Column]:
    """The columns to be read, with quantity, unit and role settled.

    Raises
    ------
    InputError
        A column, a unit or a name of the user's that the log does not have.
    """
    for number, column in enumerate(table.columns):
        column.number = number if column.number < 0 else column.number
        _settle(source, column)
    if any(column.label for column in table.columns):
        for column in table.columns:
            if not column.label and column.quantity is None and _counts(column.values):
                column.role = "counter"  # the index that pandas and R write without a name
    columns = _chosen(source, table, options)
    for quantity, header in options.channels.items():
        for column in columns:
            # without a unit the session takes the quantity's own, with a warning
            if header in (column.label, column.quantity) and not column.given and column.unit is not None:
                column.quantity, column.given, column.role = quantity, True, ""
    _apply_units(source, columns, options)
    if table.words:
        table.inform(f"column(s) of text left out: {', '.join(table.words)}")
    dropped = [c for c in columns if c.role and not c.given]
    if dropped and len(dropped) < len(columns):
        shown = ", ".join(c.shown for c in dropped[:8]) + (f" and {len(dropped) - 8} more" if len(dropped) > 8 else "")
        table.inform(f"column(s) that count or are no measurement left out: {shown}")
        columns = [c for c in columns if not c.role or c.given]
    units: dict[str, list[str]] = {}
    for column in columns:
        if column.source:
            units.setdefault(f"{column.unit} (as {column.source} defines)", []).append(column.shown)
    for unit, labels in units.items():
        table.inform(f"{', '.join(labels)}: in {unit}; --units changes that")
    return columns


def _counts(values: np.ndarray) -> bool:
    """True for 0, 1, 2… and for 1, 2, 3…"""
    return len(values) > 0 and values[0] in (0.0, 1.0) and np.array_equal(values, values[0] + np.arange(len(values)))


def _settle(source: Source, column: Column) -> None:
    if column.quantity is not None:
        return
    heading = heading_of(column.label, column.unit, source.vocabulary)
    column.quantity, column.role = heading.quantity, heading.role
    if column.clock and column.quantity is None:
        column.quantity = "time"
    if column.unit is None:
        column.unit, column.source = heading.unit, heading.source


def _chosen(source: Source, table: Table, options: ReadOptions) -> list[Column]:
    """The columns that the user mapped and the time, or all of them."""
    if not options.columns:
        return list(table.columns)
    labels = [column.label for column in table.columns]
    mapped: dict[int, str] = {}
    for quantity, which in options.columns.items():
        mapped[_index(source, labels, which, quantity)] = quantity
    for index, quantity in mapped.items():
        column = table.columns[index]
        column.quantity, column.given, column.role = quantity, True, ""
    others = set(mapped.values()) - {"time"}
    if "time" in mapped.values():
        for index, column in enumerate(table.columns):
            if column.quantity in ("time", "date") and index not in mapped:
                column.role = "counter"  # another clock, of which the user did not speak
        if not others:
            return list(table.columns)
    kept = [
        c for k, c in enumerate(table.columns)
        if k in mapped or ("time" not in mapped.values() and c.quantity in ("time", "date"))
    ]  # fmt: skip
    left = [c.shown for c in table.columns if not any(c is one for one in kept)]
    if left:
        table.inform(f"columns not read, as --columns says: {', '.join(left)}")
    order = {column.number: k for k, column in enumerate(table.columns[i] for i in mapped)}
    return sorted(kept, key=lambda c: order.get(c.number, -1))


def _index(source: Source, labels: list[str], which: int | str, quantity: str) -> int:
    number, unnamed = numbered(which), "no header"
    if number is None:
        assert isinstance(which, str)
        folded = [label.lower() for label in labels]
        if which.lower() in folded:
            return folded.index(which.lower())
        raise source.error(f"has no column {which!r} for {quantity}", did_you_mean(which, [v for v in labels if v]))
    if not 0 <= number < len(labels):
        raise source.error(
            f"has {len(labels)} columns, numbered from 0; column {number} for {quantity} is not there",
            f"They are: {', '.join(f'{i}={label or unnamed}' for i, label in enumerate(labels))}.",
        )
    return number


def _apply_units(source: Source, columns: list[Column], options: ReadOptions) -> None:
    """Units that the user gave win over the file's."""
    for wanted, unit in options.units.items():
        if source.vocabulary.unit(unit) is None:
            raise source.error(
                f"unit {unit!r} of --units {wanted}={unit} is not known",
                "Units are written as in N, lbf, mm, in, s, ms, V, m/s^2, g.",
            )
        folded = wanted.lower()
        known = {id(c): (c.label.lower(), c.quantity or "", str(c.number)) for c in columns}
        matches = [c for c in columns if folded in known[id(c)]]
        matches = matches or [c for c in columns if any(name.startswith(folded) for name in known[id(c)][:2] if name)]
        if not matches:
            raise source.error(
                f"has no column {wanted!r} for --units", did_you_mean(wanted, [c.label for c in columns if c.label])
            )
        for column in matches:
            column.unit, column.source = unit, ""
            if not column.given:  # a name among words that nobody knows is believed where the unit says the same
                heading = heading_of(column.label, unit, source.vocabulary)
                if heading.quantity is not None and column.quantity is None:
                    column.quantity, column.role = heading.quantity, ""
