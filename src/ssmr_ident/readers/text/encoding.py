"""From bytes to text whose numbers are plain ASCII: byte-order marks, UTF-16, Windows code pages, NULs."""

from __future__ import annotations

import codecs
from dataclasses import dataclass

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.vocabulary import words_of

_CODE_PAGES = ("cp1252", "cp1250", "cp1251", "cp1253", "cp1254", "shift_jis", "gb18030", "euc_kr")
"""Of Western, Central and Eastern Europe, Greece, Turkey, Japan, China, Korea; the first where no word says which."""
_OF_TWO_BYTES = ("shift_jis", "gb18030", "euc_kr")
_MINUS = "\u2212".encode()  # as typesetters print it
_HEAD = 16384  # bytes in which words are looked for


@dataclass(frozen=True)
class Text:
    """A log as bytes of an ASCII-compatible encoding.

    Parameters
    ----------
    data : bytes
        Lines end with ``\\n`` or ``\\r\\n``.
    encoding : str
        To decode header lines with.
    """

    data: bytes
    encoding: str

    def decode(self, line: bytes) -> str:
        return line.decode(self.encoding, errors="replace").rstrip("\r")


def text_of(source: Source) -> Text:
    """The text of a file.

    Notes
    -----
    UTF-8 with or without mark, then UTF-16 by its mark or its NULs, then the code page in which most words of the
    vocabulary appear, cp1252 where none does.
    """
    data = source.data
    encoding = "utf-8"
    if data.startswith(codecs.BOM_UTF8):
        data = data[3:]
    elif data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        data, encoding = _from_utf16(source, data, "utf-16"), "utf-8"
        source.inform("text is UTF-16")
    elif _looks_like_utf16(data):
        order = "utf-16-le" if data[1] == 0 else "utf-16-be"
        data = _from_utf16(source, data, order)
        source.inform("text is UTF-16 without a byte-order mark")
    if b"\0" in data:
        data = _without_nuls(source, data)
    if b"\n" not in data[:65536] and b"\r" in data and b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    if not data.isascii():
        try:
            data.decode("utf-8")
        except UnicodeDecodeError:
            encoding = max(_CODE_PAGES, key=lambda page: _words_known(source, data[:_HEAD], page))
            source.inform(f"text is not UTF-8; read as {encoding}")
            if encoding in _OF_TWO_BYTES:  # a second byte may be a delimiter's
                data, encoding = data.decode(encoding, errors="replace").encode(), "utf-8"
        if encoding == "utf-8":
            data = data.replace(_MINUS, b"-")
    return Text(data, encoding)


def _words_known(source: Source, head: bytes, page: str) -> int:
    """How many words beyond ASCII of a text in a code page the vocabulary has."""
    lines = head.decode(page, errors="replace").split("\n")[:200]
    words = {w for line in lines if not line.isascii() for w in words_of(line)}
    known = {w for phrase in source.vocabulary.phrases for w in phrase} | {
        w for (w, *_) in source.vocabulary.words["counters"]
    }
    return sum(not w.isascii() and (w in known or w.endswith(tuple(source.vocabulary.endings))) for w in words)


def _looks_like_utf16(data: bytes) -> bool:
    """ASCII text in UTF-16 has a NUL in every second byte."""
    head = data[:256]
    if len(head) < 8:
        return False
    return head[0::2].count(0) > 0.8 * len(head) / 2 or head[1::2].count(0) > 0.8 * len(head) / 2


def _from_utf16(source: Source, data: bytes, encoding: str) -> bytes:
    if len(data) % 2:
        source.warn("the last character is cut in half; dropped")
        data = data[:-1]
    return data.decode(encoding, errors="replace").lstrip("\ufeff").encode("utf-8", errors="replace")


def _without_nuls(source: Source, data: bytes) -> bytes:
    kept = data.rstrip(b"\0")
    tail = len(data) - len(kept)
    if tail:
        source.warn(f"{tail} NUL bytes at the end dropped (power lost while writing?); last samples may be missing")
    inside = kept.count(b"\0")
    if inside > 0.1 * max(len(kept), 1) or not kept:
        raise source.error("is binary, not a text log", "Export the log as text, .lvm, .tdms or .xlsx.")
    if inside:
        source.warn(f"{inside} NUL bytes inside the text dropped")
        kept = kept.replace(b"\0", b"")
    return kept
