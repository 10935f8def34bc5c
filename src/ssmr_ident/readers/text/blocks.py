"""The parts of a text log: facts, headers, runs of numbers, results tables."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.headings import bare_unit, is_units_row, quantity_of, split_header
from ssmr_ident.readers.text.numeric_run import NumberRun, TextRow

_RESULT_WORDS = (
    "mean",
    "std dev",
    "stddev",
    "standard deviation",
    "minimum",
    "maximum",
    "median",
    "average",
    "results",
    "mittelwert",
    "średnia",
    "variance",
    "coefficient",
)


@dataclass
class Block:
    """A header with the rows of numbers below it.

    Parameters
    ----------
    labels : list of str
        Without units; empty when the block has no header.
    units : list of str or None
    values : (n, m) float
    lines : (n,) int
    """

    labels: list[str]
    units: list[str | None]
    values: np.ndarray
    lines: np.ndarray
    timed: tuple[int, ...] = ()
    short: list[int] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    results: bool = False

    @property
    def has_time(self) -> bool:
        return any(quantity_of(label, unit) == "time" for label, unit in zip(self.labels, self.units, strict=True))


def blocks_of(source: Source, items: list[NumberRun | TextRow], on_bad: str) -> list[Block]:
    """Group the items of a text log into blocks.

    Raises
    ------
    InputError
        Text in the middle of a run of numbers, unless ``on_bad`` is ``nan``.
    """
    blocks: list[Block] = []
    pending: list[TextRow] = []
    facts: dict[str, str] = {}
    for item in items:
        if isinstance(item, TextRow):
            pending.append(item)
            continue
        filled = [row for row in pending if row.cells]
        if blocks and not pending and item.values.shape[1] != blocks[-1].values.shape[1]:
            raise source.error(
                f"row has {item.values.shape[1]} cells, {blocks[-1].values.shape[1]} are expected",
                "Mend the row.",
                f"line {item.lines[0]}",
            )
        labels, units, used = _header(filled, item.values.shape[1])
        facts = facts | _facts(filled[: len(filled) - used])
        previous = blocks[-1] if blocks else None
        results = any(_is_results(row) for row in filled[-4:])
        if previous is not None and not used and item.values.shape[1] == previous.values.shape[1] and not results:
            if not filled and not _restarts(previous, item):
                _join(previous, item)
                pending = []
                continue
            if filled and not _restarts(previous, item) and not previous.results:
                bad = filled[0]
                if on_bad != "nan":
                    raise source.error(
                        f"text {bad.raw.strip()[:60]!r} inside the data",
                        "Drop such rows with --on-bad nan, or mend the line.",
                        f"line {bad.line}",
                    )
                source.warn(
                    f"{len(filled)} line(s) of text inside the data dropped: {bad.raw.strip()[:60]!r}",
                    f"line {bad.line}",
                )
                _join(previous, item)
                pending = []
                continue
            labels, units = previous.labels, previous.units
        blocks.append(Block(labels, units, item.values, item.lines, item.timed, list(item.short), facts, results))
        pending = []
    if pending and blocks:
        filled = [row for row in pending if row.cells]
        if filled and any(_is_results(row) for row in filled):
            source.inform(f"{len(filled)} line(s) of results after the data are not data", f"line {filled[0].line}")
        elif filled:
            _tail(source, filled)
    return blocks


def _tail(source: Source, rows: list[TextRow]) -> None:
    row = rows[0]
    source.warn(f"{len(rows)} line(s) of text after the data not read: {row.raw.strip()[:60]!r}", f"line {row.line}")


def _restarts(previous: Block, item: NumberRun) -> bool:
    index = next(
        (
            i
            for i, (label, unit) in enumerate(zip(previous.labels, previous.units, strict=True))
            if quantity_of(label, unit) == "time"
        ),
        0,
    )
    if not len(previous.values) or index >= item.values.shape[1]:
        return False
    return bool(item.values[0, index] <= previous.values[0, index] + 1e-12)


def _join(block: Block, item: NumberRun) -> None:
    block.values = np.concatenate([block.values, item.values])
    block.lines = np.concatenate([block.lines, item.lines])
    block.timed = tuple(sorted({*block.timed, *item.timed}))
    block.short += item.short


def _header(rows: list[TextRow], width: int) -> tuple[list[str], list[str | None], int]:
    """Labels, units and how many of the last text rows they took."""
    if not rows:
        return [""] * width, [None] * width, 0
    last = rows[-1]
    unit_cells: list[str] | None = None
    used = 0
    if is_units_row(last.cells) and len(rows) > 1 and len(last.cells) <= width:
        unit_cells = last.cells
        used = 1
    names = rows[-1 - used] if len(rows) > used else None
    # one name too many is the Comment column of a table whose comments are empty
    fits = names is not None and (len(names.cells) == width or (width > 1 and len(names.cells) == width + 1))
    if names is None or not fits or any(_is_number(cell) for cell in names.cells):
        return [""] * width, [None] * width, 0
    split = [split_header(cell) for cell in names.cells[:width]]
    labels = [label for label, _ in split]
    units = [unit for _, unit in split]
    if unit_cells is not None:
        units = [
            bare_unit(cell) if cell else unit
            for cell, unit in zip([*unit_cells, *[""] * (width - len(unit_cells))], units, strict=True)
        ]
    return labels, units, used + 1


def _is_number(cell: str) -> bool:
    """True for what begins like a number, even a spoilt one: such a row is damaged data, no header."""
    return bool(re.match(r"[+-]?[.,]?\d", cell))


def _facts(rows: list[TextRow]) -> dict[str, str]:
    found = {}
    for row in rows[:200]:
        cells = [cell for cell in row.cells if cell]
        if len(cells) == 1 and ":" in cells[0]:
            key, _, value = cells[0].partition(":")
            found[key.strip()[:80]] = value.strip()[:400]
        elif len(cells) >= 2:
            found[cells[0].rstrip(":")[:80]] = " ".join(cells[1:])[:400]
    return found


def _is_results(row: TextRow) -> bool:
    first = row.cells[0].lower() if row.cells else ""
    return first.startswith(_RESULT_WORDS)
