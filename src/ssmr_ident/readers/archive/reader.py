"""Zips with logs in them, as phone apps export: every table with a time is read, the others are named; packed logs."""

from __future__ import annotations

import bz2
import gzip
import io
import lzma
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import PurePosixPath

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.arrays.named import MOST_BYTES, NamedArray, fields_of, name_parts, recordings_of_arrays
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source, source_of

NAMES = ("zip", "npz", "npy", "gzip", "bzip2", "xz")
_UNPACKED: dict[str, Callable[[io.BytesIO], gzip.GzipFile | bz2.BZ2File | lzma.LZMAFile]] = {
    "gzip": lambda data: gzip.GzipFile(fileobj=data),
    "bzip2": bz2.BZ2File,
    "xz": lzma.LZMAFile,
}
_MOST_MEMBERS = 200
_TABLES = (".csv", ".txt", ".tsv", ".dat", ".json", ".jsonl", ".lvm")


def recognises(source: Source) -> bool:
    return source.kind in NAMES


def read_with(
    source: Source, options: ReadOptions, read_source: Callable[[Source, ReadOptions], list[Recording]]
) -> list[Recording]:
    """Recordings of the logs in a zip.

    Parameters
    ----------
    read_source : function of Source and ReadOptions
        Reads one member as it would read a file.

    Raises
    ------
    InputError
        Damaged, unpacks to too much, or no member is a log.
    """
    if source.kind in _UNPACKED:
        return _of_packed(source, options, read_source)
    if source.kind == "npy":
        return _arrays(source, [(".npy", source.data)], options)
    members = _members(source)
    if source.kind == "npz":
        return _arrays(source, members, options)
    recordings: list[Recording] = []
    left: list[str] = []
    first: InputError | None = None
    # a log stands in the zip's root more often than deeper: what is beside it in folders speaks of it
    for name, data in members:
        member = source_of(source.path, data, source.digest, f"{source.path}:{name}")
        try:
            found = read_source(member, options)
        except InputError as error:
            left.append(name)
            asked = "unit" in error.problem or ("sampling rate" not in error.problem and "/" not in name)
            first = error if asked and first is None else first
            continue
        for recording in found:
            part = f"{name}, {recording.provenance.part}".rstrip(", ")
            provenance = replace(recording.provenance, file=str(source.path), part=part)
            recordings.append(replace(recording, provenance=provenance))
    if not recordings:
        if first is not None:
            raise first
        names = ", ".join(name for name, _ in members[:8]) or "nothing"
        raise source.error("is a zip without a log that can be read", f"It holds {names}; unpack it and name the log.")
    if left:
        note = f"in the zip left out, as no logs: {', '.join(left)}"
        source.inform(note)
        recordings = [replace(r, notes=(*r.notes, source.notes[-1])) for r in recordings]
    return recordings


def _of_packed(
    source: Source, options: ReadOptions, read_source: Callable[[Source, ReadOptions], list[Recording]]
) -> list[Recording]:
    """Recordings of one packed log, as of the log itself."""
    opened, size = _UNPACKED[source.kind], 0
    try:
        with opened(io.BytesIO(source.data)) as stream:  # measured before anything of it is kept
            while size <= MOST_BYTES and (part := stream.read(2**20)):
                size += len(part)
        if size > MOST_BYTES:
            raise source.error(f"unpacks to more than {MOST_BYTES // 2**20} MB", "Split the recording.")
        with opened(io.BytesIO(source.data)) as stream:
            data = stream.read()
    except (OSError, EOFError, zlib.error, lzma.LZMAError, ValueError) as error:
        raise source.error(f"{source.kind} is damaged ({str(error)[:80]})", "Copy it again.") from error
    packed = source_of(source.path, data, source.digest, source.name)
    if packed.kind in _UNPACKED:
        raise source.error(f"is {packed.kind} within {source.kind}", "Unpack it once and name what comes out.")
    packed.inform(f"unpacked from {source.kind}")
    return read_source(packed, options)


def _members(source: Source) -> list[tuple[str, bytes]]:
    """Names and bytes of the members that may be logs, unpacked within the limit."""
    budget, found = MOST_BYTES, []
    try:
        with zipfile.ZipFile(io.BytesIO(source.data)) as archive:
            for member in archive.infolist()[:_MOST_MEMBERS]:
                name = member.filename
                suffix = PurePosixPath(name).suffix.lower()
                if member.is_dir() or suffix not in (*_TABLES, ".npy") or "__MACOSX" in name:
                    continue
                with archive.open(member) as stream:
                    data = stream.read(budget + 1)
                budget -= len(data)
                if budget < 0:
                    raise source.error(f"unpacks to more than {MOST_BYTES // 2**20} MB", "Split the recording.")
                found.append((name, data))
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError, ValueError, OSError) as error:
        raise source.error(f"zip is damaged ({str(error)[:80]})", "Copy it again.") from error
    return found


def _arrays(source: Source, members: list[tuple[str, bytes]], options: ReadOptions) -> list[Recording]:
    """NumPy's archive of arrays; objects in it are refused, for they could be anything."""
    arrays: list[NamedArray] = []
    for name, data in members:
        if not name.endswith(".npy"):
            continue
        try:
            value = np.load(io.BytesIO(data), allow_pickle=False)
        except Exception as error:  # numpy reports damage by whatever its parsing stumbles over
            raise source.error(f"array {name} cannot be read ({str(error)[:80]})", "Save plain numbers.") from error
        arrays += fields_of(name_parts(name[:-4]), value, {})
    return recordings_of_arrays(source, source.kind, arrays, options)
