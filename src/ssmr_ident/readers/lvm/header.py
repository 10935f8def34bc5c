"""Headers of LabVIEW measurement files: tagged rows in any order, ended by ``***End_of_Header***``."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.text.encoding import Text
from ssmr_ident.readers.text.numbers import Dialect

MAGIC = "LabVIEW Measurement"
END = "***End_of_Header***"
_SEGMENT_TAGS = {
    "Channels",
    "Samples",
    "Y_Unit_Label",
    "X_Dimension",
    "X0",
    "Delta_X",
    "Y_Dimension",
    "X_Unit_Label",
    "Test_Name",
    "Test_Numbers",
    "Test_Series",
    "UUT_Name",
    "UUT_S/N",
    "UUT_M/N",
    "Notes",
    "Date",
    "Time",
}
_FILE_TAGS = {
    "Writer_Version",
    "Reader_Version",
    "Separator",
    "Decimal_Separator",
    "Multi_Headings",
    "X_Columns",
    "Time_Pref",
    "Operator",
    "Project",
    "Description",
}
_LONGEST_HEADER = 2000  # lines


@dataclass
class Header:
    """Tags of a file header or of a segment header.

    Parameters
    ----------
    tags : dict
        Cells by tag, without the tag itself.
    lines : dict
        Line number by tag.
    """

    tags: dict[str, list[str]] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)

    def first(self, tag: str, default: str = "") -> str:
        cells = self.tags.get(tag, [])
        return next((cell for cell in cells if cell), default)

    def per_channel(self, tag: str, count: int, step: int) -> list[str]:
        """Cells of a tag for each channel; ``step`` is 2 when every channel has an X column."""
        cells = self.tags.get(tag, [])[::step]
        return [*cells[:count], *[""] * (count - len(cells))]


def separator_of(source: Source, lines: list[str]) -> tuple[str, str]:
    """The separator that the header rows really use, and the one that they declare.

    Excel re-saves with ``;`` and leaves the declaration as it was.
    """
    used = declared = ""
    for line in lines[:60]:
        match = re.match(r"(\w+)([\t;,])(.*)", line)
        if match and match[1] in _FILE_TAGS | _SEGMENT_TAGS:
            used = used or match[2]
            if match[1] == "Separator":
                declared = match[3].strip(" \t;,")
    if not used:
        raise source.error("header rows have no separator", "Export the .lvm again.", "line 1")
    return used, declared


class Lines:
    """Lines of a text with their numbers and byte positions, read one by one."""

    def __init__(self, text: Text, dialect: Dialect, position: int = 0, number: int = 1) -> None:
        self.text, self.dialect, self.position, self.number = text, dialect, position, number

    @property
    def ended(self) -> bool:
        return self.position >= len(self.text.data)

    def peek(self) -> tuple[str, int]:
        """The next line and the byte after it."""
        data = self.text.data
        newline = data.find(b"\n", self.position)
        stop = len(data) if newline < 0 else newline
        return self.text.decode(data[self.position : min(stop, self.position + 1_000_000)]), stop + 1

    def take(self) -> str:
        line, self.position = self.peek()
        self.number += 1
        return line

    def skip_blank(self) -> None:
        while not self.ended and not self.dialect.cells(self.peek()[0]):
            self.take()


def read_header(source: Source, lines: Lines) -> Header:
    """Tags up to the end mark; special blocks are passed over with a note.

    Raises
    ------
    InputError
        When the end mark does not come.
    """
    header = Header()
    begin = lines.number
    while not lines.ended and lines.number - begin < _LONGEST_HEADER:
        number = lines.number
        line = lines.take()
        if line.startswith("***Start_Special"):
            _special(source, lines, number)
            continue
        if line.startswith(END):
            return header
        cells = lines.dialect.cells(line)
        if not cells or cells[0] == MAGIC:
            continue
        if cells[0] == "X_Value" or lines.dialect.cells(line)[0][:1].isdigit():
            break
        header.tags[cells[0]] = cells[1:]
        header.lines[cells[0]] = number
    raise source.error(
        f"header end not found: no {END} after line {begin}", "Export the .lvm again.", f"line {lines.number - 1}"
    )


def _special(source: Source, lines: Lines, begin: int) -> None:
    while not lines.ended:
        if lines.take().startswith("***End_Special"):
            source.inform("special block passed over", f"lines {begin}-{lines.number - 1}")
            return
    raise source.error("***Start_Special*** has no ***End_Special***", "Export the .lvm again.", f"line {begin}")


def is_segment_start(cells: list[str]) -> bool:
    return bool(cells) and (cells[0] in _SEGMENT_TAGS or cells[0].startswith(("***Start_Special", END)))
