"""Delimited text: MTESTQuattro and other testing machines, LabVIEW graph exports, plain CSV.

No public MTESTQuattro text export fixes a layout, and operators choose columns and units; so nothing here counts
lines or columns. The longest run of number rows gives delimiter and decimal sign, the text above it labels and
units.
"""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.recording import Note, Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table import clocks
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table, facts
from ssmr_ident.readers.table.headings import quantity_of, split_header
from ssmr_ident.readers.text.blocks import Block, blocks_of
from ssmr_ident.readers.text.dialect import sniff
from ssmr_ident.readers.text.encoding import text_of
from ssmr_ident.readers.text.last_line import without_cut_line
from ssmr_ident.readers.text.numeric_run import TextRow, walk

NAMES = ("csv", "mtestquattro")
_DAQ_RANGE = 10.0  # V, the widest input range of NI's data-acquisition cards


def recognises(source: Source) -> bool:
    """Any text is worth a try: this is the last reader asked."""
    return source.kind == "text"


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of a delimited text log.

    Raises
    ------
    InputError
        No numbers, no time, no unit of a force, ambiguous numbers, text inside the data.
    """
    text = text_of(source)
    dialect = sniff(source, text, options)
    text = without_cut_line(source, text, dialect.delimiter)
    items = list(walk(text, dialect))
    blocks = _data_blocks(source, blocks_of(source, items, options.on_bad))
    _refuse_split_decimals(source, items, blocks)
    recordings: list[Recording] = []
    for number, block in enumerate(blocks, start=1):
        part = f"lines {block.lines[0]}-{block.lines[-1]}"
        if len(blocks) > 1:
            part = f"block {number} of {len(blocks)}, {part}"
        recordings += _recordings_of_block(source, block, part, str(dialect), options)
    return recordings


def _data_blocks(source: Source, blocks: list[Block]) -> list[Block]:
    """The blocks that are measurements: those with time when any has it, and no results tables."""
    if any(block.has_time for block in blocks):
        dropped = [block for block in blocks if not block.has_time]
        kept = [block for block in blocks if block.has_time]
    else:
        kept = [block for block in blocks if not block.results] or blocks
        longest = max((len(block.values) for block in kept), default=0)
        dropped = [block for block in blocks if not any(block is one for one in kept)]
        short = [block for block in kept if len(block.values) < 0.1 * longest]  # stray numbers in a header
        dropped += short
        kept = [block for block in kept if len(block.values) >= 0.1 * longest]
    for block in dropped:
        # a table with a header of its own is a results table; bare numbers may be what the user wanted
        tell = source.inform if block.results or any(block.labels) else source.warn
        tell(
            f"{len(block.values)} row(s) of numbers without a time column (results, not data) left out",
            f"line {block.lines[0]}",
        )
    if not kept:
        raise source.error("holds no rows of numbers", "Export the data, not a report.")
    return kept


def _refuse_split_decimals(source: Source, items: list, blocks: list[Block]) -> None:
    """``1,5,2,5`` below two names is two numbers with decimal commas, cut in four."""
    for block in blocks:
        if any(block.labels):
            continue
        width = block.values.shape[1]
        above = [item for item in items if isinstance(item, TextRow) and item.line < block.lines[0] and item.cells]
        if above and len(above[-1].cells) * 2 == width and not any(v.isdigit() for v in above[-1].cells):
            raise source.error(
                f"rows have {width} cells below {len(above[-1].cells)} names: comma as separator and as decimal sign?",
                "Export with ; or tab as the separator.",
                f"line {block.lines[0]}",
            )


def _recordings_of_block(
    source: Source, block: Block, part: str, dialect: str, options: ReadOptions
) -> list[Recording]:
    notes = [Note("info", f"{len(block.values)} rows, {dialect}", part)]
    columns = [
        Column(label, unit, np.ascontiguousarray(block.values[:, index]), index in block.timed)
        for index, (label, unit) in enumerate(zip(block.labels, block.units, strict=True))
    ]
    graph = _is_graph_export(block.labels)
    if graph:
        for column in columns[::2]:
            column.quantity = "time"  # its label may be edited or in any language
    headerless = not any(block.labels)
    assumed = "V" if graph or (headerless and _within_daq_range(columns, options)) else None
    table = Table(
        columns,
        lambda row: f"line {block.lines[row]}",
        part,
        facts(block.facts),
        notes,
        assumed,
        axes_in_volts=graph or headerless,
        split=True,
    )
    if headerless and assumed is None and not options.columns and not options.units:
        raise source.error(
            "columns have no header and are not within ±10 V: units unknown",
            "Give --columns time=0,force=1 --units force=N.",
            part,
        )
    clocks.onto_one_clock(source, table, options)
    reader = "mtestquattro" if _is_testing_machine(columns) else "csv"
    return recordings_of(source, reader, table, options)


def _is_graph_export(labels: list[str]) -> bool:
    """LabVIEW's exports, pairs of ``{x label} - {plot}``, ``{y label} - {plot}``, or ``time[0]``, ``Y[0]``."""
    if len(labels) % 2 or not labels:
        return False
    for first, second in zip(labels[::2], labels[1::2], strict=True):
        if first.startswith("time[") and second.startswith("Y["):
            continue
        a, b = first.partition(" - "), second.partition(" - ")
        if not (a[1] and b[1] and a[2] == b[2]):
            return False
    return True


def _within_daq_range(columns: list[Column], options: ReadOptions) -> bool:
    data = columns if options.fs is not None else columns[1:]
    return all(np.nanmax(np.abs(column.values), initial=0.0) <= _DAQ_RANGE for column in data)


def _is_testing_machine(columns: list[Column]) -> bool:
    """Force over position, with their units spelt out: what a testing machine writes."""
    words = {split_header(column.label)[0].strip().lower() for column in columns}
    found = {quantity_of(column.label, column.unit) for column in columns}
    return {"force", "position"} <= found and bool(words & {"load", "standardkraft", "obciążenie", "kraft", "force"})
