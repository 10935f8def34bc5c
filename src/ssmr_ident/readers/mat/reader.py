"""MATLAB files of versions 4 to 7.2, by scipy; version 7.3 is HDF5 and is read as such."""

from __future__ import annotations

import io
import math
import warnings
import zlib
from typing import Any, Literal

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.arrays.named import MOST_BYTES, NamedArray, recordings_of_arrays
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source

NAMES = ("mat",)
_COMPRESSED, _MATRIX = 15, 14  # miCOMPRESSED, the type of a packed element, and miMATRIX
_OF_MEMBERS = (1, 2, 3)  # classes of arrays that hold arrays: cell, struct, object
_DEEPEST = 8  # structs in structs


def recognises(source: Source) -> bool:
    return source.kind == "mat"


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of a .mat file: named arrays, or structs with a field for each channel.

    Raises
    ------
    InputError
        Damaged, unpacks to too much, or holds no numbers.
    """
    from scipy.io import loadmat

    _check_size(source)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # names that are twice there, objects that scipy does not know
            content = loadmat(io.BytesIO(source.data), squeeze_me=True, struct_as_record=True)
    except Exception as error:  # scipy reports damage by whatever its parsing stumbles over
        reason = f"{type(error).__name__}: {str(error)[:100]}"
        raise source.error(f"is a MATLAB file that is damaged ({reason})", "Save it again in MATLAB.") from error
    arrays: list[NamedArray] = []
    for name, value in content.items():
        if not name.startswith("__"):
            _collect(arrays, (name,), value, 0)
    return recordings_of_arrays(source, "mat", arrays, options)


def _collect(arrays: list[NamedArray], path: tuple[str, ...], value: Any, depth: int) -> None:
    """Arrays of a value; fields of structs become names below it."""
    if isinstance(value, np.ndarray) and value.dtype.names and depth < _DEEPEST:
        if value.size != 1:
            for k, one in enumerate(value.ravel()[:200]):
                _collect(arrays, (*path, str(k + 1)), one, depth + 1)
            return
        value = value.ravel()[0]
    if isinstance(value, np.void) and value.dtype.names and depth < _DEEPEST:
        for name in value.dtype.names:
            _collect(arrays, (*path, name), value[name], depth + 1)
        return
    if isinstance(value, np.ndarray) and value.dtype == object and value.size and depth < _DEEPEST:
        if value.size == 1:
            _collect(arrays, path, value.ravel()[0], depth + 1)
            return
        if not all(isinstance(v, str) for v in value.ravel()):
            for k, one in enumerate(value.ravel()[:200]):  # a cell array: what its cells hold, by their numbers
                _collect(arrays, (*path, str(k + 1)), one, depth + 1)
            return
    if isinstance(value, (np.ndarray, np.generic, str, int, float)):
        arrays.append(NamedArray(path, value))


def _check_size(source: Source) -> None:
    """Unpack every element once against the limit: a few bytes can stand for gigabytes of zeros."""
    data, position, budget = source.data, 128, MOST_BYTES
    if data[:4] == b"MATL":
        order: Literal["little", "big"] = "little" if data[126:128] == b"IM" else "big"
        _check_counts(source, data[position:], order)
        while position + 8 <= len(data):
            kind = int.from_bytes(data[position : position + 4], order)
            length = int.from_bytes(data[position + 4 : position + 8], order)
            if kind == _COMPRESSED:
                size, first = _unpacked(data[position + 8 : position + 8 + length], budget)
                budget -= size
                _check_counts(source, first, order)
            if budget <= 0:
                raise source.error(f"unpacks to more than {MOST_BYTES // 2**20} MB", "Split the recording.")
            position += 8 + length


def _check_counts(source: Source, data: bytes, order: Literal["little", "big"], depth: int = 0) -> None:
    """That no cell or struct says that it has more members than bytes: scipy makes room for as many as are said."""
    position = 0
    while position + 8 <= len(data) and depth < _DEEPEST:
        head = int.from_bytes(data[position : position + 4], order)
        if head >> 16:  # a small element, in the place of its length
            position += 8
            continue
        length = int.from_bytes(data[position + 4 : position + 8], order)
        inside = data[position + 8 : position + 8 + length]
        if head == _MATRIX and len(inside) >= 24:
            sizes = int.from_bytes(inside[20:24], order)
            count = math.prod(int.from_bytes(inside[24 + k : 28 + k], order) for k in range(0, min(sizes, 64), 4))
            if int.from_bytes(inside[8:12], order) & 0xFF in _OF_MEMBERS and count > len(inside):
                raise source.error(
                    f"is a MATLAB file that is damaged (a cell or struct of {count} members in {len(inside)} bytes)",
                    "Save it again in MATLAB.",
                )
            _check_counts(source, inside, order, depth + 1)
        position += 8 + length + (-length % 8 if head != _COMPRESSED else 0)


def _unpacked(data: bytes, budget: int) -> tuple[int, bytes]:
    """Size of what is unpacked, and the begin of it."""
    size, machine, first = 0, zlib.decompressobj(), b""
    try:
        while data and size <= budget:
            part = machine.decompress(data, 2**22)
            first = first or part
            size += len(part)
            data = machine.unconsumed_tail
    except zlib.error:
        return size, first  # damage is reported by whoever reads the element
    return size, first
