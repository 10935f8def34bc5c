"""Delimited text: MTESTQuattro and other testing machines, LabVIEW graph exports, loggers, phones, plain CSV.

No public MTESTQuattro text export fixes a layout, and operators choose columns and units; so nothing here counts
lines or columns. The longest run of rows gives delimiter and decimal sign, the text above it labels and units.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from ssmr_ident.core.recording import Note, Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table, facts
from ssmr_ident.readers.table.headings import heading_of
from ssmr_ident.readers.table.long_form import Words, in_own_columns
from ssmr_ident.readers.table.vocabulary import words_of
from ssmr_ident.readers.text.blocks import Block, blocks_of, refuse_many_broken
from ssmr_ident.readers.text.dialect import Layout, sniff
from ssmr_ident.readers.text.encoding import Text, text_of
from ssmr_ident.readers.text.header_rows import rate_from, units_from
from ssmr_ident.readers.text.last_line import without_cut_line
from ssmr_ident.readers.text.line_forms import plain_rows
from ssmr_ident.readers.text.numeric_run import NumberRun, TextRow, walk

NAMES = ("csv", "mtestquattro")
_FACTOR = re.compile(r"\s*\d(?:\.\d{1,9})?[eE][+-]?\d{1,3}\s?\*\s*\Z")
MACHINE_WORDS = {"load", "standardkraft", "prüfkraft", "obciążenie", "kraft", "force", "charge", "carga", "fuerza"}


def recognises(source: Source) -> bool:
    """Any text is worth a try: this is the last reader asked."""
    return source.kind == "text"


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of a delimited text log.

    Raises
    ------
    InputError
        No numbers, no time, no unit of a force, ambiguous numbers, too many broken lines.
    """
    text = plain_rows(source, text_of(source))
    return recordings_of_text(source, text, options, "csv", lambda line: f"line {line}")


def recordings_of_text(
    source: Source,
    text: Text,
    options: ReadOptions,
    reader: str,
    place: Callable[[int], str],
    within: str = "",
    delimiters: str = "\t;,| ",
) -> list[Recording]:
    """Recordings of rows of cells.

    Parameters
    ----------
    reader : str
        What the recordings say read them.
    place : function of int to str
        Names a line for the user.
    within : str
        The part of the file that the text is.
    delimiters : str
        Those that may be the text's.
    """
    layout = sniff(source, text, options, delimiters=delimiters)
    if not within:
        text = without_cut_line(source, text, layout.dialect.delimiter)
    items = list(walk(text, layout))
    _refuse_common_factor(source, items)
    blocks = _data_blocks(source, blocks_of(source, items, layout))
    _refuse_split_decimals(source, items, blocks, layout)
    recordings: list[Recording] = []
    for number, block in enumerate(blocks, start=1):
        refuse_many_broken(source, block, options.on_bad)
        part = f"lines {block.lines[0]}-{block.lines[-1]}"
        if len(blocks) > 1:
            part = f"block {number} of {len(blocks)}, {part}"
        part = f"{within}, {part}" if within and len(blocks) > 1 else within or part
        recordings += _recordings_of_block(source, text, block, part, layout, options, reader, place)
    return recordings


def _refuse_common_factor(source: Source, items: list[NumberRun | TextRow]) -> None:
    """``1.0e+03 *`` above a matrix, as MATLAB shows it: the numbers below are neither the values nor exact."""
    for item in items:
        if isinstance(item, TextRow) and _FACTOR.match(item.raw[:40]):
            raise source.error(
                f"{item.raw.strip()[:40]!r} stands above numbers that were printed for reading, to few digits",
                "Export the values themselves, with writematrix or writetable.",
                f"line {item.line}",
            )


def _data_blocks(source: Source, blocks: list[Block]) -> list[Block]:
    """The blocks that are measurements: those with time when any has it, and no results tables."""
    if any(block.has_time for block in blocks):
        kept = [block for block in blocks if block.has_time]
    else:
        kept = [block for block in blocks if not block.results] or blocks
        longest = max((len(block.values) for block in kept), default=0)
        kept = [block for block in kept if len(block.values) >= 0.1 * longest]  # stray numbers in a header
    for block in blocks:
        if any(block is one for one in kept):
            continue
        # a table with a header of its own is a results table; bare numbers may be what the user wanted
        tell = source.inform if block.results or block.named else source.warn
        tell(
            f"{len(block.values)} row(s) of numbers without a time column (results, not data) left out",
            f"line {block.lines[0]}",
        )
    if not kept:
        raise source.error("holds no rows of numbers", "Export the data, not a report.")
    return kept


def _refuse_split_decimals(
    source: Source, items: list[NumberRun | TextRow], blocks: list[Block], layout: Layout
) -> None:
    """``1,5,2,5`` below two names is two numbers with decimal commas; one number below four names is no channel."""
    for block in blocks:
        if block.named:
            continue
        width = block.values.shape[1]
        if width == 1 and len(block.names) > 1:
            raise source.error(
                f"has {len(block.names)} names in the header ({', '.join(block.names[:6])}) and one number a row: "
                "no channel was logged",
                "Log again with the sensors switched on, or export the columns too.",
                f"line {block.lines[0]}",
            )
        if layout.dialect.delimiter != ",":
            continue
        above = [item for item in items if isinstance(item, TextRow) and item.line < block.lines[0] and item.cells]
        names = above[-1].cells if above else []
        if names and len(names) * 2 == width and all(v[:1].isalpha() or v[:1] == '"' for v in names):
            raise source.error(
                f"rows have {width} cells below {len(names)} names: comma as separator and as decimal sign?",
                "Export with ; or tab as the separator.",
                f"line {block.lines[0]}",
            )


def _recordings_of_block(
    source: Source,
    text: Text,
    block: Block,
    part: str,
    layout: Layout,
    options: ReadOptions,
    reader: str,
    place: Callable[[int], str],
) -> list[Recording]:
    words = [h.label or f"column {k}" for k, h in enumerate(block.headings) if k in block.text]
    columns = [
        Column(h.label, h.unit, np.ascontiguousarray(block.values[:, k]), k in block.timed, source=h.source, number=k)
        for k, h in enumerate(block.headings)
        if k not in block.text and not (not h.label and np.isnan(block.values[:, k]).all())
    ]
    graph = _is_graph_export([c.label for c in columns])
    if graph:
        for column in columns[::2]:
            column.quantity = "time"  # its label may be edited or in any language
    _units_said(source, columns, block.facts)
    rate, told = rate_from(block.facts, source.vocabulary) or (0.0, "")
    table = Table(
        columns,
        lambda row: place(int(block.lines[row])),
        part,
        facts(block.facts),
        [Note("info", f"{len(block.values)} rows, {layout.dialect}", part)],
        "V" if graph or reader == "labview-xlsx" else None,
        axes_in_volts=graph or reader == "labview-xlsx" or not block.named,
        split=True,
        rate=rate,
        rate_from=told,
        words=words,
    )
    _units_beside(source, block, columns, lambda k: _words(text, block, layout, k))
    named = {w: _words(text, block, layout, k) for w, k in zip(words, block.text, strict=False)}
    table.columns = in_own_columns(source, columns, named, table)
    recordings = recordings_of(source, reader, table, options)
    if reader == "csv" and _is_testing_machine(columns):
        return [_by_machine(recording) for recording in recordings]
    return recordings


def _words(text: Text, block: Block, layout: Layout, number: int) -> Words:
    """Cells of a column of words, read when they are asked for: few logs need them."""

    @cache
    def lines() -> list[bytes]:
        return text.data.split(b"\n")

    def cells(rows: slice) -> list[str]:
        found = [layout.dialect.cells(text.decode(lines()[line - 1])) for line in block.lines[rows].tolist()]
        return [row[number] if number < len(row) else "" for row in found]

    return cells


def _units_beside(source: Source, block: Block, columns: list[Column], cells_of: Callable[[int], Words]) -> None:
    """Units that stand in a column of their own, the same one in every row, right of the numbers."""
    known = source.vocabulary
    for column in columns:
        beside, heading = column.number + 1, heading_of(column.label, column.unit, known)
        if column.unit or heading.unit or beside not in block.text:
            continue
        called = words_of(block.headings[beside].label)
        if called and not known.has("units_said", called):
            continue
        cells = cells_of(beside)
        unit = cells(slice(0, 1))[0]
        if known.unit(unit) is not None and set(cells(slice(None))) == {unit}:
            column.unit = unit
            source.inform(f"{column.shown}: {unit}, as the cells beside it say")


def _units_said(source: Source, columns: list[Column], facts: dict[str, str]) -> None:
    """Units that stand among the facts above the table, for columns whose headers write none."""
    times = [c for c in columns if heading_of(c.label, c.unit, source.vocabulary).quantity in ("time", "date")]
    clocks = [c for c in times if c.unit or c.clock] or times  # beside Time(s), an X_Value is no clock
    bare = [c for c in columns if not any(c is clock for clock in clocks)]
    said = units_from(facts, len(bare), source.vocabulary)
    if said is None or any(c.unit for c in bare):
        return
    for column, unit in zip(bare, said[0], strict=True):
        column.unit = unit
    source.inform(f"units from {said[1]!r}")


def _by_machine(recording: Recording) -> Recording:
    return replace(recording, provenance=replace(recording.provenance, reader="mtestquattro"))


def _is_graph_export(labels: list[str]) -> bool:
    """LabVIEW's exports, pairs of ``{x label} - {plot}``, ``{y label} - {plot}``, or ``time[0]``, ``Y[0]``."""
    if len(labels) % 2 or not labels:
        return False
    for first, second in zip(labels[::2], labels[1::2], strict=True):
        if first.startswith("time[") and second.startswith("Y["):
            continue
        a, b = first.partition(" - "), second.partition(" - ")
        if not (a[1] and b[1] and (a[2] == b[2] or words_of(a[2])[-1:] == words_of(b[0])[-1:])):
            return False
    return True


def _is_testing_machine(columns: list[Column]) -> bool:
    """Force over position, with their units spelt out: what a testing machine writes."""
    words = {column.label.strip().lower() for column in columns}
    return {"force", "position"} <= {c.quantity for c in columns} and bool(words & MACHINE_WORDS)
