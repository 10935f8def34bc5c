"""HDF5, by h5py (the extra ``hdf5``): groups, arrays and their attributes; MATLAB 7.3 among it."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.arrays.named import MOST_BYTES, NamedArray, fields_of, recordings_of_arrays
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source, missing_library

NAMES = ("hdf5",)
_MOST_ARRAYS = 2000
_DEEPEST = 20


def recognises(source: Source) -> bool:
    return source.kind == "hdf5"


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of an HDF5 file.

    Raises
    ------
    InputError
        h5py is not installed; the file is damaged, holds too much, or no numbers.
    """
    try:
        import h5py
    except ImportError as error:
        raise missing_library(source, "an HDF5 file (or MATLAB 7.3)", "h5py", "hdf5") from error
    arrays: list[NamedArray] = []
    try:
        with h5py.File(io.BytesIO(source.data), "r") as file:
            _walk(source, file, (), arrays, [MOST_BYTES], set(), h5py)
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, OverflowError, MemoryError, SystemError) as error:
        # h5py passes on whatever the HDF5 library finds wrong
        raise source.error(f"is an HDF5 file that is damaged ({str(error)[:100]})", "Copy it again.") from error
    return recordings_of_arrays(source, "hdf5", arrays, options, "/")


def _walk(
    source: Source,
    group: Any,
    path: tuple[str, ...],
    arrays: list[NamedArray],
    budget: list[int],
    seen: set[int],
    h5py: Any,
) -> None:
    """Arrays of a group; links to elsewhere are not followed, and nothing is read that would not fit."""
    address = int(h5py.h5o.get_info(group.id).addr)
    if address in seen:
        return  # a group may stand in itself by another name
    seen.add(address)
    for name, value in group.attrs.items():
        if np.asarray(value).size == 1:
            arrays.append(NamedArray((*path, str(name)), np.asarray(value).ravel()[0]))
    for name in group:
        if name.startswith("#") or len(arrays) > _MOST_ARRAYS or len(path) > _DEEPEST:
            continue  # MATLAB's own bookkeeping, or a tree without end
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            source.inform(f"{'/'.join((*path, name))} is a link to elsewhere; not followed")
            continue
        item = group[name]
        if isinstance(item, h5py.Group):
            _walk(source, item, (*path, name), arrays, budget, seen, h5py)
        elif isinstance(item, h5py.Dataset) and item.shape is not None:
            value = _values(source, item, budget, h5py)
            if value is not None:
                arrays += fields_of((*path, name), np.asarray(value), dict(item.attrs))


def _values(source: Source, item: Any, budget: list[int], h5py: Any) -> Any:
    if item.is_virtual or item.external:
        source.inform(f"{item.name} lies in another file; not followed")
        return None
    kind = item.dtype.kind
    if kind not in "fiub" and h5py.check_string_dtype(item.dtype) is None and item.dtype.names is None:
        return None
    budget[0] -= item.size * max(item.dtype.itemsize, 8)
    if budget[0] < 0:
        raise source.error(f"unpacks to more than {MOST_BYTES // 2**20} MB", "Split the recording.")
    value = item[()]
    if item.attrs.get("MATLAB_class") in (b"char", "char") and kind in "ui":
        return "".join(map(chr, np.asarray(value).ravel().tolist()[:400]))
    return value
