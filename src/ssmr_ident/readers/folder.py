"""Which files of a folder are logs: their names say so, for a folder holds other files too."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from ssmr_ident.core.errors import InputError

LOG_EXTENSIONS = frozenset(
    {
        *(".xlsx", ".xlsm", ".lvm", ".tdms", ".csv", ".txt", ".dat", ".asc", ".tsv", ".log", ".mtwdata", ".mtxdata"),
        *(".mat", ".h5", ".hdf5", ".parquet", ".feather", ".jsonl", ".ndjson", ".npz", ".npy", ".uff", ".unv"),
        *(".wav", ".zip", ".bag", ".mcap", ".db3"),
    }
)
_PACKED = frozenset({".gz", ".bz2", ".xz"})  # behind a log's extension
_HEAD = 65536  # bytes of a .json that are looked at
_ARRAY = re.compile(rb"""(?:\[|\{)(?:\s*(?:"[\d.]{1,25}"\s*:\s*)?-?\d[\d.eE+-]{0,30}\s*,){8}""")  # so many are samples


def logs_in(paths: Iterable[Path], *, below: bool = False) -> tuple[list[Path], list[InputError]]:
    """Files as named, and the logs in folders that are named.

    Parameters
    ----------
    paths : iterable of Path
    below : bool
        Whether a folder without logs of its own stands for those in the folders within it. Beside logs, folders hold
        what speaks of them: a phone's properties, results.

    Returns
    -------
    files : list of Path
    errors : list of InputError
        Folders without logs.
    """
    files: list[Path] = []
    errors: list[InputError] = []
    for path in paths:
        try:
            if not path.is_dir():
                files.append(path)
                continue
            found = _below(path) if below else _of(path)
            within = [] if below or found else [folder for folder in _folders(path) if _below(folder)]
        except OSError as error:
            shown = str(error.filename or path)
            errors.append(InputError(shown[:200], f"cannot be read ({error.strerror})", "Check the name."))
            continue
        if not found:
            kinds = ", ".join(sorted(LOG_EXTENSIONS))
            mend = f"Name a folder in it: {', '.join(map(str, within[:3]))}." if within else f"Logs end in {kinds}."
            errors.append(InputError(str(path), "is a folder without logs", mend))
        files += found
    return files, errors


def _shown(entry: Path) -> bool:
    return not entry.name.startswith(("~$", "."))


def _of(folder: Path) -> list[Path]:
    return sorted(e for e in folder.iterdir() if _shown(e) and _is_log(e) and e.is_file())


def _is_log(entry: Path) -> bool:
    """True for a log's extension; a ``.json`` may be settings, properties or results, so its head is asked as well."""
    extension = entry.suffix.lower()
    if extension in _PACKED:
        return Path(entry.stem).suffix.lower() in LOG_EXTENSIONS
    if extension != ".json":
        return extension in LOG_EXTENSIONS
    try:
        with entry.open("rb") as file:
            head = file.read(_HEAD)
    except OSError:
        return False
    rows = re.match(rb"[^{}\[\]]*\[\s*\{[^{}]*\d", head) is not None
    return b'"schema"' not in head and (rows or _ARRAY.search(head) is not None)


def _folders(folder: Path) -> list[Path]:
    """Folders in a folder; links are not followed, for they may lead back."""
    return sorted(e for e in folder.iterdir() if _shown(e) and e.is_dir() and not e.is_symlink())


def _below(folder: Path) -> list[Path]:
    return _of(folder) or [log for inner in _folders(folder) for log in _below(inner)]
