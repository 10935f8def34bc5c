"""Named arrays with attributes, and how they make recordings: which belong together, which is time, what a rate says.

Files of scientific formats hold trees of arrays: groups, structs, nested objects. What stands in one group and is as
long as its time is one recording; several groups that are built alike are several recordings.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table, facts
from ssmr_ident.readers.table.headings import heading_of
from ssmr_ident.readers.table.vocabulary import Vocabulary, shipped, words_of
from ssmr_ident.readers.text.header_rows import rate_from

MOST_BYTES = 400 * 2**20  # of all arrays of a file together, unpacked
_WIDEST = 64  # columns that an array of two dimensions may have
_UNIT_KEYS = ("units", "unit", "unit_string", "einheit", "einheiten")
_NAME_KEYS = ("columns", "names", "labels", "channels", "channel_names", "axes", "fields")
_SEPARATORS = re.compile(r"[./]")


@dataclass
class NamedArray:
    """An array as a file has it.

    Parameters
    ----------
    path : tuple of str
        Groups and the name.
    values : (n,) or (n, k) of float, datetime64 or text; a number or a text alone
    attributes : mapping of str to Any
        What the file says of it.
    """

    path: tuple[str, ...]
    values: Any
    attributes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def group(self) -> tuple[str, ...]:
        return self.path[:-1]


def fields_of(path: tuple[str, ...], values: np.ndarray, attributes: Mapping[str, Any]) -> list[NamedArray]:
    """The fields of a record array, or the array itself."""
    if values.dtype.names is None:
        return [NamedArray(path, values, attributes)]
    return [NamedArray((*path, name), np.ascontiguousarray(values[name]), attributes) for name in values.dtype.names]


def recordings_of_arrays(
    source: Source, reader: str, arrays: list[NamedArray], options: ReadOptions, sign: str = "."
) -> list[Recording]:
    """Recordings of a tree of arrays.

    Parameters
    ----------
    sign : str
        Between groups and names, as the format writes it.

    Raises
    ------
    InputError
        No array of numbers, or whatever is wrong with their time and units.
    """
    known = source.vocabulary
    columns: list[tuple[tuple[str, ...], list[Column], Mapping[str, Any]]] = []
    for array in arrays:
        made = _columns(source, array, arrays, sign)
        if made:
            columns.append((array.group, made, array.attributes))
    if not columns:
        raise source.error(
            "holds no arrays of numbers", f"Names in it: {', '.join(sign.join(a.path) for a in arrays[:8]) or 'none'}."
        )
    recordings: list[Recording] = []
    roots = _roots([(group, made) for group, made, _ in columns], known)
    for root in roots:
        members = [(g, m, a) for g, m, a in columns if g[: len(root)] == root]
        part = sign.join(root) if len(roots) > 1 else ""
        recordings += _of_group(source, reader, members, _facts(arrays, root, sign), part, options)
    return recordings


def _columns(source: Source, array: NamedArray, arrays: list[NamedArray], sign: str) -> list[Column]:
    """Columns of an array: one, or as many as its second dimension has."""
    values = np.asarray(array.values)
    if values.ndim == 0 or values.dtype.kind in "OSUVc":
        return []
    values = values.squeeze() if values.ndim > 1 else values
    if values.ndim == 0 or values.ndim > 2 or values.shape[0] < 2:
        return []
    if values.ndim == 2 and values.shape[0] <= _WIDEST < values.shape[1]:
        values = values.T
    if values.ndim == 2 and values.shape[1] > _WIDEST:
        return []
    clock = values.dtype.kind == "M"
    if values.dtype.kind in "Mm":
        whole = values.astype("datetime64[ns]" if clock else "timedelta64[ns]").astype(np.int64)
        values = (whole - whole.ravel()[0] * clock) * 1e-9
    label = sign.join(array.path)
    units = _texts(array.attributes, _UNIT_KEYS) or _sibling_units(array, arrays)
    if values.ndim == 1:
        unit = units[0] if units else None
        return [Column(label, "s" if clock else unit or None, values.astype(float), quantity="time" if clock else None)]
    count = values.shape[1]
    names = _texts(array.attributes, _NAME_KEYS) or _sibling_names(array, arrays, count)
    if len(names) != count:
        names = [f"{label} {k + 1}" if label else "" for k in range(count)]
    each = units if len(units) == count else units[:1] * count if units else [""] * count
    return [
        Column(name, unit or None, np.ascontiguousarray(values[:, k], dtype=float))
        for k, (name, unit) in enumerate(zip(names, each, strict=True))
    ]


def _texts(attributes: Mapping[str, Any], keys: tuple[str, ...]) -> list[str]:
    for key, value in attributes.items():
        if str(key).lower() in keys:
            return [_text(v) for v in np.atleast_1d(np.asarray(value, dtype=object)).ravel().tolist()]
    return []


def _text(value: Any) -> str:
    return (value.decode("utf-8", errors="replace") if isinstance(value, bytes) else str(value)).strip()


def _siblings(array: NamedArray, arrays: list[NamedArray], keys: tuple[str, ...]) -> list[str]:
    """Texts of an array beside this one that is called ``units`` or ``names``."""
    for one in arrays:
        if one.group == array.group and one.path[-1].lower() in keys:
            values = np.atleast_1d(np.asarray(one.values, dtype=object)).ravel().tolist()
            if all(isinstance(v, (str, bytes)) for v in values):
                return [_text(v) for v in values]
    return []


def _sibling_units(array: NamedArray, arrays: list[NamedArray]) -> list[str]:
    """The unit at this array's place among the arrays of its group."""
    units = _siblings(array, arrays, _UNIT_KEYS)
    if len(units) == 1:  # one text for all: "N, m/s^2"
        units = [unit.strip() for unit in re.split(r"[,;|]", units[0])]
    alike = [one for one in arrays if one.group == array.group and _length(one) == _length(array) > 1]
    measured = [one for one in alike if not is_time_name(one.path[-1], shipped())]
    for ones in (alike, measured):
        if len(units) == len(ones):
            return next(([units[k]] for k, one in enumerate(ones) if one is array), [])
    return units if _width(array) == len(units) > 1 else []


def _sibling_names(array: NamedArray, arrays: list[NamedArray], count: int) -> list[str]:
    names = _siblings(array, arrays, _NAME_KEYS)
    return names if len(names) == count else []


def _length(array: NamedArray) -> int:
    values = np.asarray(array.values)
    return 0 if values.dtype.kind in "OSUV" or values.ndim == 0 else max(values.shape, default=0)


def _width(array: NamedArray) -> int:
    values = np.asarray(array.values)
    return min(values.shape) if values.ndim == 2 else 1


def _roots(columns: list[tuple[tuple[str, ...], list[Column]]], known: Vocabulary) -> list[tuple[str, ...]]:
    """Groups that are a recording each: those with a time of their own, or brothers that are built alike."""
    timed = {group for group, made in columns for c in made if heading_of(c.label, c.unit, known).quantity == "time"}
    if timed:
        # what has no time in its own group or above it belongs to the nearest group above that has one
        roots = {next((g[:k] for k in range(len(g), -1, -1) if g[:k] in timed), None) for g, _ in columns}
        if None not in roots:
            return sorted(r for r in roots if r is not None)
        return sorted(timed) if len(timed) > 1 and () not in timed else [()]
    tops = {group[:1] for group, _ in columns}
    shapes = {top: sorted(g[1:] for g, _ in columns if g[:1] == top) for top in tops}
    alike = len(tops) > 1 and () not in tops and len({str(shape) for shape in shapes.values()}) == 1
    return sorted(tops) if alike else [()]


def _facts(arrays: list[NamedArray], root: tuple[str, ...], sign: str) -> dict[str, str]:
    """Numbers and texts alone, and attributes of groups, that hold for a recording; the last path word is the key."""
    found: dict[str, str] = {}
    for array in arrays:
        if array.group not in (root, ()) and array.group[: len(root)] != root:
            continue
        values = np.asarray(array.values)
        if values.size == 1:
            found[array.path[-1]] = _text(values.ravel()[0])
    return found


def _of_group(
    source: Source,
    reader: str,
    members: list[tuple[tuple[str, ...], list[Column], Mapping[str, Any]]],
    found: dict[str, str],
    part: str,
    options: ReadOptions,
) -> list[Recording]:
    """One recording: arrays as long as the time, and arrays of other lengths that state a rate of their own."""
    known = source.vocabulary
    told = {id(c): _rate(attributes, known) for _, made, attributes in members for c in made}
    columns = [c for _, made, _ in members for c in made]
    times = [c for c in columns if heading_of(c.label, c.unit, known).quantity == "time"]
    lengths = [len(c.values) for c in times] or [len(c.values) for c in columns]
    length = max(set(lengths), key=lambda n: (lengths.count(n), n))
    kept, left = [], []
    for number, column in enumerate(columns):
        column.number = number
        rate = told[id(column)]
        if len(column.values) == length and (times or not rate):
            kept.append(column)
        elif rate and options.fs is None:
            column.step = 1.0 / rate
            kept.append(column)
        else:
            left.append(column.label)
    rate, fact = rate_from(found, known) or (0.0, "")
    if not times and rate and any(c.step for c in kept):
        for column in kept:
            column.step = column.step or 1.0 / rate
    table = Table(kept, lambda row: f"sample {row + 1}", part, facts(found), split=True, rate=rate, rate_from=fact)
    if left:
        table.inform(f"array(s) of another length than the time left out: {', '.join(left)}")
    return recordings_of(source, reader, table, options)


def _rate(attributes: Mapping[str, Any], known: Vocabulary) -> float:
    """A sampling rate among attributes [Hz], 0 for none."""
    texts = {str(k): _text(np.asarray(v).ravel()[0]) for k, v in attributes.items() if np.asarray(v).size == 1}
    found = rate_from(texts, known)
    return found[0] if found else 0.0


def name_parts(name: str) -> tuple[str, ...]:
    """A path as words between dots and slashes, for formats with flat names."""
    return tuple(part for part in _SEPARATORS.split(name) if part) or (name,)


def is_time_name(name: str, known: Vocabulary) -> bool:
    """True for what the vocabulary calls a time."""
    return heading_of(name, None, known).quantity == "time" or words_of(name)[-1:] == ("t",)
