"""Parquet and Feather, by pyarrow (the extra ``parquet``): tables whose columns have types."""

from __future__ import annotations

import io
from functools import partial
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.arrays.named import MOST_BYTES
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source, missing_library
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import heading_of
from ssmr_ident.readers.table.long_form import Words, in_own_columns

NAMES = ("parquet",)


def recognises(source: Source) -> bool:
    return source.kind in ("parquet", "feather")


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """The recording of a Parquet or Feather file.

    Raises
    ------
    InputError
        pyarrow is not installed; the file is damaged, holds too much, or no numbers.
    """
    try:
        import pyarrow
        from pyarrow import feather, parquet
    except ImportError as error:
        raise missing_library(source, f"a {source.kind} file", "pyarrow", "parquet") from error
    try:
        if source.kind == "parquet":
            file = parquet.ParquetFile(io.BytesIO(source.data))
            rows, columns = file.metadata.num_rows, file.metadata.num_columns
            if rows * columns * 8 > MOST_BYTES:
                raise source.error(f"unpacks to more than {MOST_BYTES // 2**20} MB", "Split the recording.")
            frame = file.read(use_threads=False)
        else:
            frame = feather.read_table(io.BytesIO(source.data), memory_map=False, use_threads=False)
        while any(pyarrow.types.is_struct(field.type) for field in frame.schema):
            frame = frame.flatten()
        made, words = _columns(source, frame, pyarrow)
    except (pyarrow.ArrowException, OSError, ValueError, TypeError, OverflowError, MemoryError) as error:
        raise source.error(
            f"is a {source.kind} file that is damaged ({str(error)[:100]})", "Write it again."
        ) from error
    if not made:
        raise source.error("has no columns of numbers", f"Columns: {', '.join(words) or 'none'}.")
    table = Table(made, lambda row: f"row {row + 1}", split=True, words=list(words))
    table.columns = in_own_columns(source, made, words, table)
    return recordings_of(source, "parquet", table, options)


def _columns(source: Source, frame: Any, pyarrow: Any) -> tuple[list[Column], dict[str, Words]]:
    """Columns of numbers and stamps, and the others."""
    made: list[Column] = []
    words: dict[str, Words] = {}
    for number, field in enumerate(frame.schema):
        kind, name = field.type, str(field.name)
        units = {k.decode().lower(): v.decode() for k, v in (field.metadata or {}).items()}
        unit = next((v for k, v in units.items() if k in ("unit", "units")), None)
        if pyarrow.types.is_timestamp(kind):
            whole = frame.column(number).cast(pyarrow.timestamp("ns")).to_numpy()
            whole = whole.astype("datetime64[ns]").astype(np.int64)
            seconds = (whole - whole[0]) * 1e-9 if len(whole) else np.empty(0)
            made.append(Column(name, "s", seconds, quantity="time", number=number))
        elif pyarrow.types.is_duration(kind):
            seconds = frame.column(number).cast(pyarrow.duration("ns")).to_numpy().astype(np.int64) * 1e-9
            made.append(Column(name, "s", seconds, quantity="time", number=number))
        elif name.startswith("__index_level_") and pyarrow.types.is_integer(kind):
            continue  # pandas counts the rows
        elif pyarrow.types.is_integer(kind) or pyarrow.types.is_floating(kind):
            heading = heading_of(name, unit, source.vocabulary)
            values = np.asarray(frame.column(number).to_numpy(), dtype=float)
            made.append(Column(heading.label, heading.unit, values, number=number))
        else:
            frame.column(number).validate(full=True)  # letters that are none are damage, whoever asks for them later
            words[name] = partial(_texts, frame.column(number))
    return made, words


def _texts(column: Any, rows: slice) -> list[str]:
    return ["" if cell is None else str(cell) for cell in column[rows].to_pylist()]
