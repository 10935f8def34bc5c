"""What a picture of the documentation shows stands in its file: the command that makes it, and the text in it.

A test reads both, makes the text anew and holds it against the picture's, so that a picture which no longer shows what
comes out is found.
"""

from __future__ import annotations

import struct
import zlib
from html.parser import HTMLParser
from pathlib import Path

HEAD = b"\x89PNG\r\n\x1a\n"
COMMAND, SHOWS = "Command", "Shows"


def keep(path: Path, command: str, shows: str) -> None:
    """Write both into a PNG, as international text (PNG specification, section 11.3.3.4)."""
    ours = (COMMAND, SHOWS)
    chunks = [(kind, data) for kind, data in _chunks(path) if kind != b"iTXt" or _split(data)[0] not in ours]
    texts = [(b"iTXt", f"{key}\0\0\0\0\0{text}".encode()) for key, text in ((COMMAND, command), (SHOWS, shows))]
    found = [chunks[0], *texts, *chunks[1:]]
    body = (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in found
    )
    path.write_bytes(HEAD + b"".join(body))


def kept(path: Path) -> dict[str, str]:
    """Command and text of a picture; empty where nothing was kept."""
    plain = {k.decode(): v.decode("latin-1") for k, _, v in (d.partition(b"\0") for d in _texts(path, b"tEXt"))}
    return plain | dict(map(_split, _texts(path, b"iTXt")))


def _texts(path: Path, of: bytes) -> list[bytes]:
    return [data for kind, data in _chunks(path) if kind == of]


def _chunks(path: Path) -> list[tuple[bytes, bytes]]:
    data, at, found = path.read_bytes(), len(HEAD), []
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        found.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += length + 12
    return found


def _split(data: bytes) -> tuple[str, str]:
    key, _, rest = data.partition(b"\0")
    return key.decode(), rest[4:].decode()


class _Verdict(HTMLParser):
    """The text of a page's verdict, a line for each of its parts."""

    PARTS = ("p", "dt", "dd", "span", "li", "h3")
    SILENT = ("script", "noscript", "button", "style")

    def __init__(self) -> None:
        super().__init__()
        self.depth = self.silent = 0
        self.lines = [""]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if self.depth or dict(attrs).get("id") == "verdict":
            self.depth += tag == "div"
        self.silent += tag in self.SILENT
        if tag in self.PARTS:
            self.lines.append("")

    def handle_endtag(self, tag: str) -> None:
        self.depth -= bool(self.depth) and tag == "div"
        self.silent -= tag in self.SILENT

    def handle_data(self, data: str) -> None:
        if self.depth and not self.silent:
            self.lines[-1] += data


def first_screen(page: str) -> str:
    """What stands in the verdict of a page, as text."""
    parser = _Verdict()
    parser.feed(page)
    return "\n".join(" ".join(line.split()) for line in parser.lines if line.strip())
