"""Which files of a folder are logs: their names say so, for a folder holds other files too."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ssmr_ident.core.errors import InputError

LOG_EXTENSIONS = frozenset(
    {
        *(".xlsx", ".xlsm", ".lvm", ".tdms", ".csv", ".txt", ".dat", ".asc", ".tsv", ".mtwdata", ".mtxdata"),
        *(".mat", ".h5", ".hdf5", ".parquet", ".feather", ".jsonl", ".ndjson", ".npz", ".uff", ".unv", ".wav", ".zip"),
        *(".bag", ".mcap", ".db3"),
    }
)


def logs_in(paths: Iterable[Path]) -> tuple[list[Path], list[InputError]]:
    """Files as named, and the logs in folders that are named.

    Returns
    -------
    files : list of Path
    errors : list of InputError
        Folders without logs.
    """
    files: list[Path] = []
    errors: list[InputError] = []
    for path in paths:
        if not path.is_dir():
            files.append(path)
            continue
        found = sorted(
            entry
            for entry in path.iterdir()
            if entry.suffix.lower() in LOG_EXTENSIONS and not entry.name.startswith(("~$", ".")) and entry.is_file()
        )
        if not found:
            kinds = ", ".join(sorted(LOG_EXTENSIONS))
            errors.append(InputError(str(path), "is a folder without logs", f"Logs end in {kinds}."))
        files += found
    return files, errors
