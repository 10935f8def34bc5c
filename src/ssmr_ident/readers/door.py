"""The loading dock's door: which reader takes a file. The content decides, never the file's name."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.admet import mtwdata
from ssmr_ident.readers.lvm import reader as lvm
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source, open_source
from ssmr_ident.readers.tdms import reader as tdms
from ssmr_ident.readers.text import delimited
from ssmr_ident.readers.xlsx import labview_xlsx

# Asked in this order; the last takes any text.
FORMATS: tuple[ModuleType, ...] = (labview_xlsx, lvm, tdms, mtwdata, delimited)
READERS = tuple(sorted({name for module in FORMATS for name in module.NAMES}))


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
    module = _reader_for(source, options)
    recordings = tuple(module.read(source, options))
    if options.sample is not None:
        if options.sample > len(recordings):
            raise source.error(
                f"holds {len(recordings)} recording(s); number {options.sample} is not there", "They count from 1."
            )
        return (recordings[options.sample - 1],)
    return recordings


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


def _reader_for(source: Source, options: ReadOptions) -> ModuleType:
    if options.reader is not None:
        if options.reader not in READERS:
            raise source.error(f"reader {options.reader!r} is not known", did_you_mean(options.reader, READERS))
        candidates = [module for module in FORMATS if options.reader in module.NAMES]
        for module in candidates:
            if module.recognises(source):
                return module
        taken = next((module for module in FORMATS if module.recognises(source)), None)
        looks = f"it looks like {taken.NAMES[0]}" if taken else f"it is {source.kind}"
        raise source.error(f"is not what reader {options.reader!r} reads; {looks}", "Leave the reader out.")
    for module in FORMATS:
        if module.recognises(source):
            return module
    raise source.error(f"is {source.kind} that no reader takes", f"Readers: {', '.join(READERS)}.")
