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
from ssmr_ident.readers.text.stamps import is_stamp, seconds_of

MOST_BYTES = 400 * 2**20  # of all arrays of a file together, unpacked
_WIDEST = 64  # columns that an array of two dimensions may have
_UNIT_KEYS = ("units", "unit", "unit_string", "einheit", "einheiten")
_OWN_NAME_KEYS = ("name", "signalname", "signal_name", "channelname", "channel_name", "label", "title")
_FACTORS = ("scale_factor", "add_offset")  # of the conventions for climate and forecast data, which netCDF files follow
_OTHER_FACTORS = (
    "scale",
    "gain",
    "factor",
    "sensitivity",
    "slope",
    "multiplier",
    "calibration",
    "conversion",
    "offset",
)
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
    """The fields of a record array, or the array itself; what is said of all fields in turn goes to each its own."""
    names = values.dtype.names
    if names is None:
        return [NamedArray(path, values, attributes)]
    measured = [name for name in names if not is_time_name(name, shipped())]
    units = _texts(attributes, _UNIT_KEYS)
    units = [unit.strip() for unit in re.split(r"[,;|]", units[0])] if len(units) == 1 else units
    owners = next((some for some in (list(names), measured) if len(some) == len(units)), [])
    own = dict(zip(owners, units, strict=False))
    common = {key: value for key, value in attributes.items() if str(key).lower() not in _UNIT_KEYS}
    said = {name: common | ({"unit": own[name]} if name in own else {}) for name in names}
    return [NamedArray((*path, name), np.ascontiguousarray(values[name]), said[name]) for name in names]


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
    _name_clocks([column for _, made, _ in columns for column in made])
    if not columns:
        raise source.error(
            "holds no arrays of numbers", f"Names in it: {', '.join(sign.join(a.path) for a in arrays[:8]) or 'none'}."
        )
    recordings: list[Recording] = []
    roots = _roots([(group, made) for group, made, _ in columns], known, sign)
    rates = _rates_of_groups(arrays, known)
    for root in roots:
        members = [(g, m, a) for g, m, a in columns if g[: len(root)] == root]
        part = sign.join(root) if len(roots) > 1 else ""
        recordings += _of_group(source, reader, members, _facts(arrays, root, sign), part, options, rates)
    return recordings


def _columns(source: Source, array: NamedArray, arrays: list[NamedArray], sign: str) -> list[Column]:
    """Columns of an array: one, or as many as its second dimension has."""
    values = np.asarray(array.values)
    if values.ndim == 1 and values.dtype.kind in "OSU" and len(values) > 1 and is_stamp(_text(values[0])):
        seconds = seconds_of([_text(v).encode() for v in values.tolist()]).seconds
        return [Column(sign.join(array.path), None, seconds, True, "time")]
    if values.ndim == 0 or values.dtype.kind in "OSUVc":
        return []
    values = values.squeeze() if values.ndim > 1 else values
    if values.ndim == 0 or values.ndim > 2 or values.shape[0] < 2:
        return []
    if values.ndim == 2 and values.shape[0] <= _WIDEST < values.shape[1]:
        values = values.T
    if values.ndim == 2 and values.shape[1] > _WIDEST:
        return []
    clock = dated = values.dtype.kind == "M"
    if values.dtype.kind in "Mm":
        whole = values.astype("datetime64[ns]" if clock else "timedelta64[ns]").astype(np.int64)
        values = (whole - whole.ravel()[0] * clock) * 1e-9
    label = _own_name(array, arrays) or sign.join(array.path)
    values = _scaled(source, array, values, label)
    units = _texts(array.attributes, _UNIT_KEYS) or _sibling_units(array, arrays)
    if values.ndim == 1:
        unit = units[0] if units else None
        clock = clock or (len(array.path) > 1 and array.path[-1] == "t" and unit is None)
        kind = "time" if clock else None
        return [Column(label, "s" if dated else unit or None, values.astype(float), quantity=kind)]
    count = values.shape[1]
    units = units or [u for u in [heading_of(label, None, source.vocabulary).unit] if u]
    names = _texts(array.attributes, _NAME_KEYS) or _sibling_names(array, arrays, count)
    if len(names) != count:
        names = [f"{label} {k + 1}" if label else "" for k in range(count)]
    each = units if len(units) == count else units[:1] * count if units else [""] * count
    return [
        Column(name, unit or None, np.ascontiguousarray(values[:, k], dtype=float))
        for k, (name, unit) in enumerate(zip(names, each, strict=True))
    ]


def _name_clocks(columns: list[Column]) -> None:
    """``AI_time_1`` is the clock of ``AI_1`` where it rises: the same words, but for the one that says time."""
    words = {words_of(column.label) for column in columns}
    for column in columns:
        mine = words_of(column.label)
        beside = tuple(word for word in mine if word != "time")
        if len(beside) < len(mine) and beside in words and bool((np.diff(column.values) > 0).all()):
            column.quantity = "time"


def _scaled(source: Source, array: NamedArray, values: np.ndarray, label: str) -> np.ndarray:
    """Values with the factor and offset that a convention defines; other words for factors are told, not applied."""
    said = {str(k).lower(): np.asarray(v).ravel() for k, v in array.attributes.items()}
    numbers = {k: float(v[0]) for k, v in said.items() if v.size == 1 and v.dtype.kind in "fiu"}
    others = [f"{k} = {v:g}" for k, v in numbers.items() if k in _OTHER_FACTORS and v not in (0.0, 1.0)]
    if others:
        source.warn(
            f"{label}: {', '.join(others)} stands beside the numbers and is not applied: scale them if it should be"
        )
    factor, offset = numbers.get(_FACTORS[0], 1.0), numbers.get(_FACTORS[1], 0.0)
    if values.dtype.kind not in "fiu" or (factor == 1.0 and offset == 0.0):
        return values
    source.inform(f"{label}: × {factor:g} + {offset:g}, as its scale_factor and add_offset say")
    scaled: np.ndarray = values * factor + offset
    return scaled


def _own_name(array: NamedArray, arrays: list[NamedArray]) -> str:
    """The name that stands beside the only array of a struct, or in the header that belongs to it; empty for none."""
    name = array.path[-1]
    header = (*array.group, f"{name[:-5]}_Header") if name.endswith("_Data") else None  # as catman exports to MATLAB
    alone = [o for o in arrays if o.group == array.group and _length(o) > 1 and not is_time_name(o.path[-1], shipped())]
    if is_time_name(name, shipped()):
        return ""
    for one in arrays:
        values = np.atleast_1d(np.asarray(one.values, dtype=object)).ravel()
        if one.path[-1].lower() not in _OWN_NAME_KEYS or len(values) != 1 or not isinstance(values[0], (str, bytes)):
            continue
        if one.group == header or (len(alone) == 1 and array.group and one.group == array.group):
            return _text(values[0])
    return ""


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
    name = array.path[-1]
    if name.endswith("_Data"):
        header = NamedArray((*array.group, f"{name[:-5]}_Header", name), array.values)
        return _siblings(header, arrays, _UNIT_KEYS)
    for one in arrays:  # a struct of units, whose fields are called as the arrays are
        if (
            len(one.path) > 1
            and one.path[:-2] == array.group
            and one.path[-1] == name
            and one.path[-2].lower() in _UNIT_KEYS
        ):
            return [_text(one.values)] if isinstance(one.values, str) else []
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


def _is_time(column: Column, known: Vocabulary) -> bool:
    return (column.quantity or heading_of(column.label, column.unit, known).quantity) == "time"


def _roots(columns: list[tuple[tuple[str, ...], list[Column]]], known: Vocabulary, sign: str) -> list[tuple[str, ...]]:
    """Groups that are a recording each: those with a time of their own, or brothers with arrays of the same names."""
    timed = {group for group, made in columns for c in made if _is_time(c, known)}
    if timed:
        # what has no time in its own group or above it belongs to the nearest group above that has one
        roots = {next((g[:k] for k in range(len(g), -1, -1) if g[:k] in timed), None) for g, _ in columns}
        if None not in roots:
            return sorted(r for r in roots if r is not None)
        return sorted(timed) if len(timed) > 1 and () not in timed else [()]
    tops = {group[:1] for group, _ in columns}
    shapes = {
        top: sorted((g[1:], c.label.rsplit(sign, 1)[-1]) for g, made in columns for c in made if g[:1] == top)
        for top in tops
    }
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
    rates: Mapping[tuple[str, ...], float],
) -> list[Recording]:
    """One recording: arrays as long as the time, and arrays of other lengths that state a rate of their own."""
    known = source.vocabulary
    own = {g: next((rates[g[:k]] for k in range(len(g), -1, -1) if g[:k] in rates), 0.0) for g, _, _ in members}
    several = len(set(own.values())) > 1
    told = {id(c): _rate(a, known) or (own[g] if several else 0.0) for g, made, a in members for c in made}
    columns = [c for _, made, _ in members for c in made]
    times = [c for c in columns if _is_time(c, known)]
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


def _rates_of_groups(arrays: list[NamedArray], known: Vocabulary) -> dict[tuple[str, ...], float]:
    """Sampling rates that groups state [Hz]."""
    found: dict[tuple[str, ...], float] = {}
    for array in arrays:
        values = np.asarray(array.values)
        rate = rate_from({array.path[-1]: _text(values.ravel()[0])}, known) if values.size == 1 else None
        if rate:
            found.setdefault(array.group, rate[0])
    return found


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
