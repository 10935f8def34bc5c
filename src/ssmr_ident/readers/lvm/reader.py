"""LabVIEW measurement files (.lvm), versions 0.92 to 2, read after NI's specification (ni.com/tutorial/4139)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.recording import Note, Recording
from ssmr_ident.readers.lvm import packets
from ssmr_ident.readers.lvm.header import MAGIC, Header, Lines, is_segment_start, read_header, separator_of
from ssmr_ident.readers.lvm.rows import Rows, read_rows
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table, at_lines, facts
from ssmr_ident.readers.table.headings import split_header
from ssmr_ident.readers.text.encoding import Text, text_of
from ssmr_ident.readers.text.last_line import without_cut_line
from ssmr_ident.readers.text.numbers import Dialect, evidence_for_decimal, number

NAMES = ("lvm",)
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}


def recognises(source: Source) -> bool:
    """The first line says ``LabVIEW Measurement``, in any encoding."""
    head = source.data[:400].replace(b"\0", b"")
    return source.kind == "text" and MAGIC.encode() in head.split(b"\n", 1)[0] + head[:60]


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of an .lvm file: one per segment, per appended file, per packet of a triggered log.

    Raises
    ------
    InputError
        Header without an end, ambiguous separators, rows with too many cells, no data.
    """
    text = text_of(source)
    head = [text.decode(line) for line in text.data[:40_000].split(b"\n", 120)]
    used, declared = separator_of(source, head)
    if not declared:
        source.warn(f"Separator is empty; {'tab' if used == chr(9) else repr(used)} used", "header")
    elif _SEPARATORS.get(declared.lower(), declared) != used:
        source.warn(f"Separator says {declared}, the rows are separated by {used!r}; that is used", "header")
    text = without_cut_line(source, text, used)
    lines = Lines(text, Dialect(used))
    recordings: list[Recording] = []
    segments = 0
    file_header = read_header(source, lines)
    _refuse_double_comma(source, head, used)
    while True:
        lines.skip_blank()
        if lines.ended:
            break
        if lines.peek()[0].startswith(MAGIC):
            source.inform("a second file header: another file was appended", f"line {lines.number}")
            file_header = read_header(source, lines)
            continue
        segments += 1
        recordings += _segment(source, text, lines, file_header, segments, options)
    if not recordings:
        raise source.error("has a header and no data", "Export the .lvm again.")
    return recordings


def _refuse_double_comma(source: Source, head: list[str], separator: str) -> None:
    for number_of_line, line in enumerate(head, start=1):
        if separator == "," and line.rstrip("\r").startswith("Decimal_Separator,,"):
            raise source.error(
                "is ambiguous: comma as separator and as decimal sign",
                "Export with tab or semicolon as the separator.",
                f"line {number_of_line}",
            )


def _segment(
    source: Source, text: Text, lines: Lines, file_header: Header, number_of_segment: int, options: ReadOptions
) -> list[Recording]:
    header = Header()
    first = lines.number
    if is_segment_start(lines.dialect.cells(lines.peek()[0])):
        header = read_header(source, lines)
        lines.skip_blank()
    if lines.ended:
        source.warn("a segment header without data at the end", f"line {first}")
        return []
    names = _names(lines)
    step = 2 if names.count("X_Value") > 1 else 1
    _check_counts(source, header)
    decimal = options.decimal or _decimal(source, text, lines, file_header, bool(names))
    rows = read_rows(source, lines, decimal, len(names) or None, options)
    if not len(rows.values):
        raise source.error("no data below the header", "Export the .lvm again.", f"line {lines.number - 1}")
    labels = names or ["X_Value", *(f"Channel {k}" for k in range(1, rows.values.shape[1]))]
    return _recordings_of_segment(source, header, file_header, labels, rows, step, decimal, number_of_segment, options)


def _names(lines: Lines) -> list[str]:
    """Names row without its Comment column; empty when the data begin at once."""
    cells = lines.dialect.cells(lines.peek()[0])
    if not cells or cells[0] != "X_Value":
        return []
    lines.take()
    return cells[:-1] if cells[-1] == "Comment" else cells


def _check_counts(source: Source, header: Header) -> None:
    for tag in ("Channels", "Samples"):
        for cell in header.tags.get(tag, []):
            if (cell and not cell.isascii()) or (cell and not cell.isdigit()):
                raise source.error(
                    f"{tag} is not an integer: {cell[:40]!r}", "Mend the header row.", f"line {header.lines[tag]}"
                )


def _decimal(source: Source, text: Text, lines: Lines, file_header: Header, named: bool) -> str:
    """Decimal sign of the data: as declared, unless the data say otherwise; the header's Time does not count."""
    declared = file_header.first("Decimal_Separator")
    votes = set()
    chunk = text.data[lines.position : lines.position + 20_000].split(b"\n")[:200]
    for line in chunk:
        for cell in lines.dialect.cells(text.decode(line)):
            if cell[:1] in "+-0123456789" and cell.strip("+-0123456789.,eE") == "":
                votes.add(evidence_for_decimal(cell))
    votes.discard("")
    if len(votes) > 1:
        raise source.error(
            "has numbers with decimal points and with decimal commas",
            "Give --decimal . or ,",
            f"line {lines.number}",
        )
    seen = votes.pop() if votes else ""
    if seen and declared in (".", ",") and seen != declared:
        source.warn(f"Decimal_Separator says {declared!r}, the data have {seen!r}; that is used", "header")
    elif seen == "," and not declared:
        source.warn("decimal comma found, though no Decimal_Separator is declared", "header")
    return seen or (declared if declared in (".", ",") else ".")


def _recordings_of_segment(
    source: Source,
    header: Header,
    file_header: Header,
    labels: list[str],
    rows: Rows,
    step: int,
    decimal: str,
    segment: int,
    options: ReadOptions,
) -> list[Recording]:
    data = [index for index, label in enumerate(labels) if label != "X_Value"]
    units = header.per_channel("Y_Unit_Label", len(data), step)
    dimension = header.first("X_Dimension", "Time")
    if dimension.lower() not in ("time", ""):
        raise source.error(
            f"X_Dimension is {dimension}: not a log over time",
            "Export the time signal.",
            f"line {header.lines['X_Dimension']}",
        )
    columns = []
    for index, label in enumerate(labels):
        values = np.ascontiguousarray(rows.values[:, index])
        if label == "X_Value":
            columns.append(Column("X_Value", "s", values, quantity="time", number=index))
            continue
        name, unit = split_header(label)
        unit = units[data.index(index)] or unit
        columns.append(Column(name, unit, values, number=index))
        if name.lower() == "f" and unit == "g":
            source.warn("channel F bears the unit g, an acceleration's; if it is a force: --units F=N", "Y_Unit_Label")
    columns = _without_empty(source, columns)
    notes = [
        Note("info", f"{len(rows.values)} rows, decimal {'point' if decimal == '.' else 'comma'}"),
        *rows.notes,
    ]
    part = f"segment {segment}, lines {rows.lines[0]}-{rows.lines[-1]}"
    times = [column for column in columns if column.quantity == "time"]
    if len(times) < 2 and options.fs is None:
        _own_steps(source, header, columns, [labels[k] for k in data], decimal, step, bool(times))
    declared = [int(cell) for cell in header.per_channel("Samples", len(data), step) if cell]
    samples = max(declared, default=0)
    pieces = [slice(0, len(rows.values))]
    if not times:
        pieces, more = packets.split(columns, samples, options.fs or _rate(source, header, decimal))
        notes += more
    if samples and samples != len(rows.values) and len(pieces) == 1:
        notes.append(
            Note("warning", f"Samples says {samples}, the file holds {len(rows.values)} rows; the rows count", part)
        )
    keep = {
        k: v
        for k, v in (
            ("Operator", file_header.first("Operator")),
            ("Project", file_header.first("Project")),
            ("Description", file_header.first("Description")),
            ("Date", header.first("Date") or file_header.first("Date")),
            ("Time", header.first("Time") or file_header.first("Time")),
            ("Notes", header.first("Notes")),
        )
        if v
    }
    recordings = []
    for count, piece in enumerate(pieces, start=1):
        mine = [replace(c, values=c.values[piece] if not (c.step and times) else c.values) for c in columns]
        here = rows.lines[piece]
        label = part if len(pieces) == 1 else f"record {count} of {len(pieces)}, lines {here[0]}-{here[-1]}"
        piece_notes = list(notes)
        if not times and options.fs is None:
            piece_notes += _about_steps(header, mine)
        table = Table(
            mine,
            at_lines(here),
            label,
            facts(keep),
            piece_notes,
            "V",
            axes_in_volts=True,
            split=True,
        )
        recordings += recordings_of(source, "lvm", table, options)
    return recordings


def _without_empty(source: Source, columns: list[Column]) -> list[Column]:
    """X_Columns 'No' leaves the first cell of each row empty; channels with 0 samples are empty as well."""
    kept = []
    for column in columns:
        if np.isnan(column.values).all():
            if column.quantity != "time":
                source.warn(f"channel {column.label} holds no samples; left out")
        else:
            kept.append(column)
    return kept


def _rate(source: Source, header: Header, decimal: str) -> float:
    step = _number(source, header, "Delta_X", decimal)
    return 1.0 / step if step > 0 else 0.0


def _number(source: Source, header: Header, tag: str, decimal: str) -> float:
    return _cell(source, header, tag, header.first(tag), decimal)


def _cell(source: Source, header: Header, tag: str, cell: str, decimal: str) -> float:
    for sign in (decimal, ".", ","):
        try:
            value = number(cell, sign)
        except ValueError:
            continue
        if np.isfinite(value):
            return value
    if not cell:
        return 0.0
    raise source.error(
        f"{tag} is no number: {cell[:40]!r}",
        "Mend the header row, or give --fs.",
        f"line {header.lines.get(tag, 1)}",
    )


def _own_steps(
    source: Source, header: Header, columns: list[Column], names: list[str], decimal: str, step: int, timed: bool
) -> None:
    """Give columns the start and the step that the header states for them.

    With an X column that is done only where a channel's step is another one than the X column's: such a channel fills
    the first rows and is blank below, and the X beside its samples is not theirs.
    """
    steps = header.per_channel("Delta_X", len(names), step)
    starts = header.per_channel("X0", len(names), step)
    stamps = next((c.values for c in columns if c.quantity == "time"), None)
    shown = float(np.median(np.diff(stamps))) if stamps is not None and len(stamps) > 1 else 0.0
    data = [c for c in columns if c.quantity != "time"]
    order = {c.number: k for k, c in enumerate(c for c in columns if c.quantity != "time")}
    known = [_cell(source, header, "Delta_X", cell, decimal) for cell in steps]
    first = next((v for v in known if v > 0), 0.0)
    if not timed and first <= 0:
        raise source.error("has no X column and no Delta_X above zero", "Give --fs.")
    for column in data:
        place = [k for k, name in enumerate(names) if split_header(name)[0] == column.label]
        k = place[0] if place else order[column.number]
        own = known[k] if known[k] > 0 else first
        if timed and (own <= 0 or shown <= 0 or abs(own - shown) <= 0.2 * min(own, shown)):
            continue
        filled = np.flatnonzero(np.isfinite(column.values))
        column.step, column.start = own, _cell(source, header, "X0", starts[k], decimal)
        column.values = column.values[: int(filled[-1]) + 1 if len(filled) else 0]
        if timed:
            source.inform(
                f"channel {column.label}: {len(column.values)} samples with a Delta_X of its own, {own:g} s, in place "
                f"of the X column's {shown:g} s"
            )


def _about_steps(header: Header, columns: list[Column]) -> list[Note]:
    rates = sorted({1 / c.step for c in columns if c.step})
    notes = [Note("info", f"time from X0 and Delta_X: {', '.join(f'{rate:.6g} Hz' for rate in rates)}")]
    if len(rates) == 1:
        note = packets.rounded_step(header.first("Delta_X"), 1 / rates[0])
        notes += [note] if note is not None else []
    return notes
