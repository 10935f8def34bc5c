"""A file as bytes: its SHA-256, what kind of content it holds, and what is refused at the door."""

from __future__ import annotations

import hashlib
import io
import threading
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Note, Provenance
from ssmr_ident.core.whole_file import read_whole
from ssmr_ident.readers.table.vocabulary import Vocabulary, vocabulary_for

MAX_BYTES = 2**30  # a log of 20 s is 1 MB; an hour of three axes at 1 kHz as text is 150 MB
_BESIDE = 2**20  # bytes from which on a thread pays

_OLE2 = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_LFS = b"version https://git-lfs"
_MARKS = {b"PAR1": "parquet", b"ARROW1": "feather", b"FEA1": "feather", b"#ROSBAG V2.0": "rosbag1",
          b"\x89MCAP0\r\n": "mcap", b"SQLite format 3": "db3", b"\x93NUMPY": "npy",
          b"\x1f\x8b\x08": "gzip", b"BZh": "bzip2", b"\xfd7zXZ\x00": "xz"}  # fmt: skip


class Digest:
    """SHA-256 of bytes; of many bytes, worked out beside the parsing (hashlib lets other threads run)."""

    def __init__(self, data: bytes) -> None:
        self._hash = hashlib.sha256()
        self._thread = threading.Thread(target=self._hash.update, args=(data,))
        if len(data) > _BESIDE:
            self._thread.start()
        else:
            self._hash.update(data)

    def hex(self) -> str:
        if self._thread.ident is not None:
            self._thread.join()
        return self._hash.hexdigest()


@dataclass(frozen=True)
class Source:
    """The bytes of one file.

    Parameters
    ----------
    path : Path
    data : bytes
    kind : str
        ``workbook``, ``tdms``, ``xml``, ``text``, ``zip``, ``npz``, ``mat``, ``hdf5``, ``parquet``, ``feather``,
        ``wav``, ``rosbag1``, ``mcap``, ``db3``, ``gzip``, ``bzip2`` or ``xz``.
    shown : str
        What messages call it, where that is not the path: a member of a zip.
    notes : list of Note
        Collected while the file is opened, passed on to its recordings.
    """

    path: Path
    data: bytes
    kind: str
    digest: Digest
    notes: list[Note] = field(default_factory=list)
    shown: str = ""

    @property
    def name(self) -> str:
        return self.shown or str(self.path)

    @property
    def vocabulary(self) -> Vocabulary:
        """What columns are called: the shipped words and those of a ``vocabulary.yaml`` beside the log."""
        return vocabulary_for(self.path.parent)

    def provenance(self, reader: str, part: str = "") -> Provenance:
        return Provenance(self.name, self.digest.hex(), reader, part)

    def error(self, problem: str, mend: str = "", place: str = "") -> InputError:
        """An error at a place in this file."""
        # what a library says of damage, or a name in the file, may hold line ends; an error is one line
        where, problem, mend = (" ".join(text.split()) for text in (place, problem, mend))
        return InputError(f"{self.name}:{where}" if where else self.name, problem, mend)

    def warn(self, text: str, where: str = "") -> None:
        self.notes.append(Note("warning", text, where))

    def inform(self, text: str, where: str = "") -> None:
        self.notes.append(Note("info", text, where))


def source_of(path: Path, data: bytes, digest: Digest, shown: str) -> Source:
    """Bytes that stand within a file, as a source of their own.

    Raises
    ------
    InputError
        Their content is no log.
    """
    return Source(path, data, _kind(Path(shown.rsplit("/", 1)[-1]), data), digest, shown=shown)


def missing_library(source: Source, what: str, library: str, extra: str) -> InputError:
    """A format whose library is not installed."""
    return source.error(f"is {what}, which needs {library}", f'Run: pip install "ssmr_ident[{extra}]"')


def open_source(path: str | Path) -> Source:
    """Read a file and say what its bytes are.

    Raises
    ------
    InputError
        Not there, a folder, empty, too large, or a content that is no log.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise InputError(str(path), "is a folder, not a log", "Name a file in it.")
        data = read_whole(path, MAX_BYTES, "Split the recording.")
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(str(path), f"cannot be read ({reason})", "Check the name and the permissions.") from error
    kind = _kind(path, data)
    source = Source(path, data, kind, Digest(data))
    _compare_with_extension(source)
    return source


def _kind(path: Path, data: bytes) -> str:
    where = str(path)
    if not data:
        raise InputError(where, "file is empty (0 bytes): no channels, no data", "Copy it again.")
    # a lock file is the user's name behind its length, filled up with blanks
    if path.name.startswith("~$") or (len(data) == 165 and 0 < data[0] < 55 and data.endswith(b" " * 20)):
        raise InputError(where, "is Excel's lock file, not the workbook", "Name the file without '~$'.")
    head = data[:1024]
    if head.startswith(b"PK"):
        return _kind_of_zip(where, data)
    for mark, kind in _MARKS.items():
        if head.startswith(mark):
            return kind
    if head.startswith(b"RIFF") and head[8:12] == b"WAVE":
        return "wav"
    if b"\x89HDF\r\n\x1a\n" in (data[:8], data[512:520]):
        return "hdf5"
    if len(data) > 128 and head.startswith(b"MATLAB") and data[126:128] in (b"IM", b"MI"):
        return "mat"
    if head[257:262] == b"ustar":
        raise InputError(where, "is a tar archive, which is not read", "Unpack it and name the logs in it.")
    if head.startswith(_OLE2):
        raise InputError(where, "is a password-protected workbook or an old .xls", "Save it as unprotected .xlsx.")
    if head.startswith(_LFS):
        raise InputError(where, "is a git-lfs pointer, not the data", "Run: git lfs pull")
    if head.startswith(b"TDSm"):
        return "tdms"
    if head.startswith(b"TDSh"):
        raise InputError(where, "is a TDMS index, not the data", "Open the .tdms file beside it.")
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    if text[:1] == b"<":
        lowered = text.lower()
        if lowered.startswith((b"<!doctype html", b"<html", b"<table", b"<head", b"<body", b"<meta", b"<script")):
            raise InputError(where, "is an HTML page, not a log", "Export the data itself, as .xlsx or text.")
        return "xml"
    if head.startswith((b"\x01\x00\x00\x00", b"\xd7\xcd\xc6\x9a", b"BM", b"\x89PNG", b"\xff\xd8\xff", b"%PDF")):
        raise InputError(
            where,
            "is a picture, not data",
            "In LabVIEW use 'Export Data To Excel', not 'Export Simplified Image'.",
        )
    return "text"


_NO_LOGS = {
    "content.xml": ("an OpenDocument file (.ods)", "Save it as .xlsx or .csv."),
    "xl/workbook.bin": ("a binary workbook (.xlsb)", "Save it as .xlsx."),
    "word/document.xml": ("a Word document", "Export the data itself, as text or .xlsx."),
    "ppt/presentation.xml": ("a presentation", "Export the data itself, as text or .xlsx."),
    "Index/Document.iwa": ("a document of Apple's Numbers or Pages", "Export it as .xlsx or .csv."),
}
"""Documents that are zips as workbooks are, by a part of theirs."""


def _kind_of_zip(where: str, data: bytes) -> str:
    """A workbook has a part of that name; NumPy's archives hold arrays; what holds tables is a zip of logs."""
    try:
        names = zipfile.ZipFile(io.BytesIO(data)).namelist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError, OverflowError, EOFError, OSError):
        return "workbook"  # damaged: what reads workbooks says so
    for part, (what, mend) in _NO_LOGS.items():
        if part in names:
            raise InputError(where, f"is {what}, which is not read", mend)
    if any("workbook." in name or name.startswith("[Content_Types]") for name in names):
        return "workbook"
    if names and all(name.endswith(".npy") for name in names):
        return "npz"
    logs = (".csv", ".txt", ".tsv", ".dat", ".json", ".jsonl", ".lvm")
    return "zip" if any(name.lower().endswith(logs) for name in names) else "workbook"


def _compare_with_extension(source: Source) -> None:
    extension = source.path.suffix.lower()
    if source.kind == "workbook" and extension not in (".xlsx", ".xlsm"):
        source.warn(f"content is an .xlsx workbook, the name says {extension or 'nothing'}")
    if source.kind == "text" and extension in (".xlsx", ".xls", ".xlsm"):
        source.warn("content is text, not a workbook")
    if source.kind == "text" and extension == ".tdms":
        raise source.error("is not a TDMS file (it does not begin with TDSm)", "Copy the .tdms again.")
