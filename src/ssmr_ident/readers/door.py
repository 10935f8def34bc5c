"""The loading dock's door: which reader takes a file. The content decides, never the file's name."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Protocol

import numpy as np

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.admet import mtwdata
from ssmr_ident.readers.apart import KINDS, read_apart
from ssmr_ident.readers.archive import reader as archive
from ssmr_ident.readers.frames import reader as frames
from ssmr_ident.readers.hdf5 import reader as hdf5
from ssmr_ident.readers.json import reader as json
from ssmr_ident.readers.lvm import reader as lvm
from ssmr_ident.readers.mat import reader as mat
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.reach import refuse_out_of_reach
from ssmr_ident.readers.ros import reader as ros
from ssmr_ident.readers.source import Source, open_source
from ssmr_ident.readers.tdms import reader as tdms
from ssmr_ident.readers.text import delimited
from ssmr_ident.readers.uff import reader as uff
from ssmr_ident.readers.wav import reader as wav
from ssmr_ident.readers.xlsx import labview_xlsx

ENTRY_POINT = "ssmr_ident.readers"
"""Group under which a package of a lab's own names its readers."""


class Reader(Protocol):
    """What a reader's module, or any object in its place, offers."""

    @property
    def NAMES(self) -> tuple[str, ...]:
        """What ``--reader`` and session.yaml call it."""

    def recognises(self, source: Source) -> bool:
        """Whether the content is this reader's; it must say no to every other format's files."""

    def read(self, source: Source, options: ReadOptions) -> list[Recording]:
        """The recordings in it."""


class _Archive:
    """Zips with logs in them, as phone apps export, single logs packed by gzip, bzip2 or xz, and NumPy's arrays."""

    NAMES = archive.NAMES

    def recognises(self, source: Source) -> bool:
        return archive.recognises(source)

    def read(self, source: Source, options: ReadOptions) -> list[Recording]:
        return archive.read_with(source, options, _read_source)


# Asked in this order; the last takes any text.
FORMATS: tuple[Reader, ...] = (
    labview_xlsx, lvm, tdms, mtwdata, mat, hdf5, frames, wav, ros, _Archive(), uff, json, delimited,
)  # fmt: skip
READERS = tuple(sorted({name for reader in FORMATS for name in reader.NAMES}))


@cache
def installed() -> tuple[Reader, ...]:
    """Readers that other packages bring; they are asked first."""
    return tuple(point.load() for point in entry_points(group=ENTRY_POINT))


def formats() -> Sequence[Reader]:
    """All readers, in the order in which they are asked."""
    return (*installed(), *FORMATS)


def read(path: str | Path, options: ReadOptions = ReadOptions()) -> tuple[Recording, ...]:  # noqa: B008 - frozen
    """Every recording in a file.

    Parameters
    ----------
    path : str or Path
    options : ReadOptions

    Returns
    -------
    tuple of Recording
        One, or several for files with several specimens, segments or groups.

    Raises
    ------
    InputError
        Whatever is wrong with the file, with the place in it and the mend.
    """
    source = open_source(path)
    recordings = tuple(_read_source(source, options))
    refuse_out_of_reach(source, recordings)
    if options.sample is not None:
        if options.sample > len(recordings):
            raise source.error(
                f"holds {len(recordings)} recording(s); number {options.sample} is not there", "They count from 1."
            )
        return (recordings[options.sample - 1],)
    return recordings


def _read_source(source: Source, options: ReadOptions) -> list[Recording]:
    reader = reader_for(source, options)
    if source.kind in KINDS:
        return read_apart(source, options)
    with np.errstate(over="ignore", invalid="ignore"):  # a damaged sample may be any number: refuse_out_of_reach tells
        return list(reader.read(source, options))


def read_one(path: str | Path, options: ReadOptions = ReadOptions()) -> Recording:  # noqa: B008 - frozen
    """The recording in a file that holds one, or the one that ``options.sample`` names.

    Raises
    ------
    InputError
        Also when the file holds several and none was chosen.
    """
    recordings = read(path, options)
    if len(recordings) != 1:
        parts = "; ".join(
            f"{i}: {r.provenance.part or 'whole file'}, {len(r.time)} samples"
            for i, r in enumerate(recordings[:4], start=1)
        )
        more = f" and {len(recordings) - 4} more" if len(recordings) > 4 else ""
        raise InputError(
            str(path),
            f"holds {len(recordings)} recordings ({parts}{more}), one is expected",
            "Choose with sample: 1 (or --sample 1), or put them in files of their own.",
        )
    return recordings[0]


def reader_for(source: Source, options: ReadOptions) -> Reader:
    """The reader that takes a file.

    Raises
    ------
    InputError
        None does, or not the one that ``options`` names.
    """
    known = formats()
    taken = next((reader for reader in known if reader.recognises(source)), None)
    names = sorted({name for reader in known for name in reader.NAMES})
    if options.reader is not None and source.shown == "":
        if options.reader not in names:
            raise source.error(f"reader {options.reader!r} is not known", did_you_mean(options.reader, names))
        for reader in known:
            if options.reader in reader.NAMES and reader.recognises(source):
                return reader
        looks = f"it looks like {taken.NAMES[0]}" if taken else f"it is {source.kind}"
        raise source.error(f"is not what reader {options.reader!r} reads; {looks}", "Leave the reader out.")
    if taken is None:
        raise source.error(f"is {source.kind} that no reader takes", f"Readers: {', '.join(names)}.")
    return taken
