"""ADMET's native XML (.mtwData, .mtxData): ``<Sample TIME= POSN= LOAD=>``.

The only hard evidence is a public reader at a synchrotron: TIME in ms, POSN in m, LOAD in units of 10 N. The
factor 10 may be that rig's own, so it is an option and its default is a warning.
"""

from __future__ import annotations

from xml.parsers import expat

import numpy as np

from ssmr_ident.core.recording import Note, Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.text.numbers import number

NAMES = ("mtestquattro",)
MAX_XML = 100 * 2**20  # bytes
_LOAD_SCALE = 10.0  # N per unit
_UNITS = {"TIME": "ms", "POSN": "m", "LOAD": "N"}


def recognises(source: Source) -> bool:
    return source.kind == "xml"


class _Refused(Exception):
    pass


class _Samples:
    """Collects the attributes of Sample elements while expat streams over the file."""

    def __init__(self) -> None:
        self.rows: list[dict[str, str]] = []
        self.lines: list[int] = []
        self.groups: list[int] = []
        self.group = 0
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self.start
        self.parser.StartDoctypeDeclHandler = self.doctype
        self.parser.EntityDeclHandler = self.doctype

    def start(self, name: str, attributes: dict[str, str]) -> None:
        if name.rsplit(":", 1)[-1] == "Sample":
            self.rows.append(attributes)
            self.lines.append(self.parser.CurrentLineNumber)
            self.groups.append(self.group)
        else:
            self.group += 1  # samples below another element are another specimen

    def doctype(self, *_: object) -> None:
        raise _Refused


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of an ADMET XML file.

    Raises
    ------
    InputError
        Broken XML, a document type definition, samples without TIME, POSN or LOAD.
    """
    if len(source.data) > MAX_XML:
        raise source.error(f"XML of more than {MAX_XML // 2**20} MB", "Export the samples as text.")
    samples = _Samples()
    try:
        samples.parser.Parse(source.data, True)
    except _Refused as error:
        raise source.error(
            "holds a document type definition or entities, which a log never needs",
            "Export the file again.",
            f"line {samples.parser.CurrentLineNumber}",
        ) from error
    except (expat.ExpatError, ValueError, LookupError) as error:
        line = getattr(error, "lineno", samples.parser.CurrentLineNumber)
        raise source.error(f"XML is damaged ({str(error)[:80]})", "Copy it again.", f"line {line}") from error
    if not samples.rows:
        raise source.error("is XML without <Sample> elements", "ADMET's .mtwData or .mtxData is expected.")
    numbers = sorted(set(samples.groups))
    recordings: list[Recording] = []
    for count, group in enumerate(numbers, start=1):
        chosen = [i for i, g in enumerate(samples.groups) if g == group]
        part = f"sample group {count} of {len(numbers)}" if len(numbers) > 1 else ""
        recordings += _recording(
            source, [samples.rows[i] for i in chosen], [samples.lines[i] for i in chosen], part, options
        )
    return recordings


def _recording(
    source: Source, rows: list[dict[str, str]], lines: list[int], part: str, options: ReadOptions
) -> list[Recording]:
    keys = list(rows[0])
    for key in ("TIME", "LOAD"):
        missing = next((i for i, row in enumerate(rows) if key not in row), None)
        if missing is not None:
            raise source.error(f"<Sample> without {key}", "Export the test again.", f"line {lines[missing]}")
    columns = []
    notes: list[Note] = []
    for key in keys:
        values = np.array(
            [_value(source, row.get(key, "nan"), key, line) for row, line in zip(rows, lines, strict=True)]
        )
        if key == "LOAD":
            scale = options.load_scale
            level = "info"
            if scale is None:
                scale, level = _LOAD_SCALE, "warning"
            notes.append(
                Note(
                    level,
                    f"LOAD × {scale:g} = N"
                    + (
                        ""
                        if level == "info"
                        else " (of one known rig; check against a known load, --load-scale changes it)"
                    ),
                )
            )
            values = values * scale
        columns.append(Column(key, _UNITS.get(key), values))
    table = Table(columns, lambda row: f"line {lines[row]}", part, {}, notes, split=True)
    return recordings_of(source, "mtestquattro", table, options)


def _value(source: Source, text: str, key: str, line: int) -> float:
    try:
        return number(text.strip())
    except ValueError:
        raise source.error(f"{key} is no number: {text[:40]!r}", "Mend the sample.", f"line {line}") from None
