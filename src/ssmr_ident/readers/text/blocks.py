"""The parts of a text log: facts, headers, runs of numbers, results tables, and rows that belong to none."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.headings import Heading
from ssmr_ident.readers.text.dialect import Layout
from ssmr_ident.readers.text.header_rows import Header, header_of
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
_FEW = 0.01
"""Choice: share of a table's rows that may have another shape; with more of them the table is not understood."""


@dataclass
class Block:
    """A header with the rows of numbers below it.

    Parameters
    ----------
    headings : list of Heading
        With empty labels when the block has no header.
    values : (n, m) float
    lines : (n,) int
    timed : tuple of int
        Columns of stamps.
    short : list of int
        Lines that lack cells.
    text : tuple of int
        Columns of words.
    broken : list of TextRow
        Lines among the rows that are none.
    names : list of str
        Of a header that does not fit.
    more : list of NumberRun
        Runs that go on behind broken lines, until they are put to ``values``.
    """

    headings: list[Heading]
    values: np.ndarray
    lines: np.ndarray
    timed: tuple[int, ...] = ()
    short: list[int] = field(default_factory=list)
    text: tuple[int, ...] = ()
    facts: dict[str, str] = field(default_factory=dict)
    results: bool = False
    broken: list[TextRow] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    more: list[NumberRun] = field(default_factory=list)

    @property
    def has_time(self) -> bool:
        return any(h.quantity in ("time", "date") for h in self.headings)

    @property
    def named(self) -> bool:
        return any(h.label for h in self.headings)


def blocks_of(source: Source, items: list[NumberRun | TextRow], layout: Layout) -> list[Block]:
    """Group the items of a text log into blocks."""
    blocks: list[Block] = []
    pending: list[TextRow] = []
    facts: dict[str, str] = {}
    repeated = 0
    for item in _without_strays(items, layout):
        if isinstance(item, TextRow):
            pending.append(item)
            continue
        filled = [row for row in pending if row.cells]
        header = header_of(filled, item.values.shape[1], layout.dialect, source.vocabulary, item.written)
        facts = facts | header.facts
        previous = blocks[-1] if blocks else None
        results = any(_is_results(row) for row in filled[-4:])
        if previous is not None and header.used and not results and _goes_on(previous, header, item):
            _join(previous, item, [])
            repeated += 1
            pending = []
            continue
        if (
            previous is not None
            and not header.used
            and item.values.shape[1] == previous.values.shape[1]
            and not results
        ):
            if not _restarts(previous, item) and not previous.results:
                _join(previous, item, filled)
                pending = []
                continue
            header = Header(previous.headings)
        blocks.append(_block(item, header, facts, results))
        pending = []
    if repeated:
        source.inform(f"the header stands {repeated + 1} times among rows that go on evenly; read as one recording")
    for block in blocks:
        if block.more:
            block.values = np.concatenate([block.values, *(run.values for run in block.more)])
            block.lines = np.concatenate([block.lines, *(run.lines for run in block.more)])
            block.more = []
    if pending and blocks:
        filled = [row for row in pending if row.cells]
        if filled and any(_is_results(row) for row in filled):
            source.inform(f"{len(filled)} line(s) of results after the data are not data", f"line {filled[0].line}")
        elif filled:
            _tail(source, filled)
    return blocks


def _block(item: NumberRun, header: Header, facts: dict[str, str], results: bool) -> Block:
    return Block(header.headings, item.values, item.lines, item.timed, list(item.short), item.text, facts, results,
                 names=header.names)  # fmt: skip


def _without_strays(items: list[NumberRun | TextRow], layout: Layout) -> list[NumberRun | TextRow]:
    """A row or two of numbers of another width than the log's, with no header of their own, are broken lines."""
    runs = [item for item in items if isinstance(item, NumberRun)]
    if not runs:
        return items
    main = max(runs, key=lambda run: len(run.values)).values.shape[1]
    made: list[NumberRun | TextRow] = []
    for k, item in enumerate(items):
        if isinstance(item, TextRow) or item.values.shape[1] == main or len(item.values) > 2:
            made.append(item)
            continue
        width = item.values.shape[1]
        above = items[k - 1] if k else None
        if isinstance(above, TextRow) and len(above.cells) >= width > 1 and not any(c.isdigit() for c in above.raw):
            made.append(item)
            continue
        for line, row in zip(item.lines, item.values, strict=True):
            cells = [f"{v:g}" for v in row]
            made.append(TextRow(int(line), cells, layout.dialect.delimiter.join(cells)))
    return made


def refuse_many_broken(source: Source, block: Block, on_bad: str) -> None:
    """Leave rows of another shape out, with their lines; or stop where they are many.

    Raises
    ------
    InputError
        More than a hundredth of the rows are broken, unless ``on_bad`` is ``nan``.
    """
    lacking = set(block.short)
    if len(lacking) > max(3, _FEW * len(block.values)):
        lacking = set()  # the log's own way of writing empty cells at the end of a row
    if lacking:
        kept = ~np.isin(block.lines, list(lacking))
        block.values, block.lines = block.values[kept], block.lines[kept]
    lines = sorted({row.line for row in block.broken} | lacking)
    if not lines:
        return
    first = next((row.raw.strip()[:60] for row in block.broken if row.line == lines[0]), "cells are missing")
    if len(lines) > max(3, _FEW * len(block.values)) and on_bad != "nan":
        raise source.error(
            f"{len(lines)} lines among {len(block.values)} rows have another shape, the first: {first!r}",
            "Leave such lines out with --on-bad nan, or mend them.",
            f"line {lines[0]}",
        )
    shown = ", ".join(map(str, lines[:5])) + (f" and {len(lines) - 5} more" if len(lines) > 5 else "")
    source.warn(
        f"{len(lines)} line(s) among the rows have another shape and are left out (line {shown}): {first!r}",
        f"line {lines[0]}",
    )


def _tail(source: Source, rows: list[TextRow]) -> None:
    row = rows[0]
    tell = source.inform if all(set(r.raw.strip()) <= set("-=_*+ ") for r in rows) else source.warn
    tell(f"{len(rows)} line(s) of text after the data not read: {row.raw.strip()[:60]!r}", f"line {row.line}")


def _restarts(previous: Block, item: NumberRun) -> bool:
    """True when the time of a run falls back to where the block before it began."""
    index = next((i for i, h in enumerate(previous.headings) if h.quantity == "time"), 0)
    if not len(previous.values) or index >= item.values.shape[1]:
        return False
    return bool(item.values[0, index] <= previous.values[0, index] + 1e-12)


def _goes_on(previous: Block, header: Header, item: NumberRun) -> bool:
    """True for rows under the same names whose first stamp is a step behind the last: a header on every page."""
    if [(h.label, h.unit) for h in header.headings] != [(h.label, h.unit) for h in previous.headings]:
        return False
    index = next((i for i, h in enumerate(previous.headings) if h.quantity == "time"), None)
    last = previous.more[-1].values if previous.more else previous.values
    if index is None or len(last) < 2:
        return False
    step = float(np.median(np.diff(previous.values[:, index]))) if len(previous.values) > 1 else 0.0
    return bool(0.0 < item.values[0, index] - last[-1, index] < 1.5 * step)


def _join(block: Block, item: NumberRun, between: list[TextRow]) -> None:
    block.more.append(item)
    block.timed = tuple(sorted({*block.timed, *item.timed}))
    block.short += item.short
    block.broken += between


def _is_results(row: TextRow) -> bool:
    first = row.cells[0].lower() if row.cells else ""
    return first.startswith(_RESULT_WORDS)
