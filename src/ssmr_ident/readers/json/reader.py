"""JSON: an object a line as brokers and microcontrollers write, a list of objects, or named arrays."""

from __future__ import annotations

import json
from collections import Counter
from functools import partial
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.arrays.named import NamedArray, recordings_of_arrays
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import heading_of
from ssmr_ident.readers.table.long_form import Words, in_own_columns
from ssmr_ident.readers.table.vocabulary import words_of
from ssmr_ident.readers.text.encoding import text_of
from ssmr_ident.readers.text.header_rows import rate_from
from ssmr_ident.readers.text.numbers import number
from ssmr_ident.readers.text.stamps import is_stamp, seconds_of

NAMES = ("json",)
_DEEPEST = 8
_EVENTS = 100  # objects among which those that are no samples may state a rate
_BATCH = 5  # samples in a list; three or four are a vector or a quaternion
_LONGEST_LINE = 100_000  # bytes of an object


def recognises(source: Source) -> bool:
    """Text that begins with an object or a list of objects and names something in quotes."""
    if source.kind != "text":
        return False
    head = source.data[:400].lstrip(b"\xef\xbb\xbf \t\r\n")
    return (head[:1] == b"{" and b'"' in head) or (head[:1] == b"[" and head[1:].lstrip()[:1] == b"{")


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of a JSON text.

    Raises
    ------
    InputError
        No JSON, or no samples in it.
    """
    text = text_of(source)
    lines = text.data.split(b"\n")
    first = [line for line in lines[:50] if line.strip()][:2]
    if len(first) == 2 and all(_object(line) is not None for line in first):
        return _of_lines(source, [(k, line) for k, line in enumerate(lines, start=1) if line.strip()], options)
    try:
        content = json.loads(text.data)
    except (ValueError, RecursionError) as error:
        raise source.error(f"is JSON that is damaged ({str(error)[:80]})", "Export it again.") from error
    if isinstance(content, list):
        return _of_objects(source, [(k, one) for k, one in enumerate(content, start=1)], "object", options)
    rows = (
        next((v for v in content.values() if _are_objects(v) and not _hold_arrays(v)), None)
        if isinstance(content, dict)
        else None
    )
    if rows is not None:
        return _of_objects(source, [(k, one) for k, one in enumerate(rows, start=1)], "object", options)
    arrays: list[NamedArray] = []
    _collect(arrays, (), content, 0)
    return recordings_of_arrays(source, "json", arrays, options)


def _are_objects(value: Any) -> bool:
    return isinstance(value, list) and len(value) > 2 and all(isinstance(v, dict) for v in value)


def _hold_arrays(objects: list[dict[str, Any]]) -> bool:
    """True for a channel an object, with its samples in a list, in place of a sample an object."""
    return any(isinstance(v, list) and len(v) > _DEEPEST for v in objects[0].values())


def _is_indexed(value: dict[str, Any]) -> bool:
    """True for numbers by a number or a stamp each: a column as pandas writes it."""
    if len(value) < _DEEPEST or not all(_is_number(v) or v is None for v in value.values()):
        return False
    first = next(iter(value))
    if is_stamp(first):
        return True
    return all(len(key) < 25 and key.replace(".", "", 1).isdigit() for key in value)


def _index(keys: list[str]) -> tuple[str, np.ndarray] | None:
    """Name and numbers of the index of such a column; None for one that counts."""
    if is_stamp(keys[0]):
        return "timestamp", seconds_of([key.encode() for key in keys]).seconds
    numbers = np.array([float(key) for key in keys])
    if np.array_equal(numbers, np.arange(len(numbers))):
        return None
    return ("timestamp" if 1e11 < numbers[0] < 1e19 else "index"), numbers  # dates become milli- to nanoseconds


def _object(line: bytes) -> dict[str, Any] | None:
    if len(line) > _LONGEST_LINE:
        return None
    try:
        content = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return content if isinstance(content, dict) else None


def _of_lines(source: Source, lines: list[tuple[int, bytes]], options: ReadOptions) -> list[Recording]:
    objects = [(k, _object(line)) for k, line in lines]
    broken = [k for k, one in objects if one is None]
    if broken:
        if len(broken) > max(3, 0.01 * len(lines)) and options.on_bad != "nan":
            raise source.error(
                f"{len(broken)} of {len(lines)} lines are no JSON objects",
                "Leave them out with --on-bad nan.",
                f"line {broken[0]}",
            )
        source.warn(f"{len(broken)} line(s) are no JSON objects and are left out", f"line {broken[0]}")
    return _of_objects(source, [(k, one) for k, one in objects if one is not None], "line", options)


def _of_objects(source: Source, objects: list[tuple[int, Any]], what: str, options: ReadOptions) -> list[Recording]:
    """Objects as rows: those with the names that most have; others are events among the samples."""
    objects, rate = _one_by_one(source, objects)
    flat = [(k, _flat(one)) for k, one in objects]
    most = Counter(frozenset(n for n, v in row.items() if _is_number(v)) for _, row in flat).most_common(1)
    if not most or not most[0][0]:
        raise source.error("is JSON without samples", "A log has the same names with numbers in every object.")
    wanted = most[0][0]
    rows = [(k, row) for k, row in flat if any(_is_number(row.get(name)) for name in wanted)]
    if len(rows) < len(flat):
        source.inform(f"{len(flat) - len(rows)} object(s) that are no samples left out")
        sampled = {k for k, _ in rows}
        facts = {n: str(v) for k, row in flat[:_EVENTS] if k not in sampled for n, v in row.items()}
        rate = rate or rate_from(facts, source.vocabulary)
    names = list(dict.fromkeys(name for _, row in rows for name in row))
    columns: list[Column] = []
    words: dict[str, Words] = {}
    for column, name in enumerate(names):
        cells = [row.get(name) for _, row in rows]
        texts = [c.encode()[:64] if isinstance(c, str) else b"" for c in cells]
        if any(isinstance(c, str) and is_stamp(c) for c in cells[:50]):
            columns.append(Column(name, None, seconds_of(texts).seconds, True, "time", number=column))
        elif any(_is_number(c) for c in cells):
            heading = heading_of(name, None, source.vocabulary)
            values = np.array([_number(c) for c in cells])
            columns.append(Column(heading.label, heading.unit, values, source=heading.source, number=column))
        else:
            words[name] = partial(_texts, cells)
    places = [k for k, _ in rows]
    table = Table(columns, lambda row: f"{what} {places[row]}", split=True, words=list(words))
    table.rate, table.rate_from = rate or (0.0, "")
    table.columns = in_own_columns(source, columns, words, table)
    return recordings_of(source, "json", table, options)


def _one_by_one(
    source: Source, objects: list[tuple[int, Any]]
) -> tuple[list[tuple[int, Any]], tuple[float, str] | None]:
    """Objects that hold some samples in lists as a sample each, and the rate that they state.

    Radios and brokers send samples in batches, under the stamp of the first; a batch's samples are even.
    """
    first = objects[0][1] if objects and isinstance(objects[0][1], dict) else {}
    lists = [name for name, v in first.items() if _are_samples(v)]
    whole = [(k, o) for k, o in objects if isinstance(o, dict) and lists and all(_are_samples(o.get(n)) for n in lists)]
    if not whole or len(whole) < 0.9 * len(objects):
        return objects, None
    stamps = [n for n, v in first.items() if _is_number(v) and _names_time(source, n)][:1]
    begins = np.array([_number(o.get(stamps[0])) if stamps else np.nan for _, o in whole])
    steps = np.diff(begins[np.isfinite(begins)])
    apart = float(np.median(steps)) if len(steps) else 0.0
    made: list[tuple[int, Any]] = []
    for (k, batch), begin in zip(whole, begins.tolist(), strict=True):
        count = min(len(batch[n]) for n in lists)
        for i in range(count):
            stamp = {"t": begin + apart * i / count} if apart > 0 else {}
            made.append((k, {**stamp, **{n: batch[n][i] for n in lists}}))
    source.inform(f"every object holds samples of {', '.join(lists)} in lists; they follow each other evenly")
    told = rate_from({str(n): str(v) for n, v in first.items() if _is_number(v)}, source.vocabulary)
    return made, None if apart > 0 else told


def _are_samples(value: Any) -> bool:
    return isinstance(value, list) and len(value) >= _BATCH and all(map(_is_number, value))


def _names_time(source: Source, name: str) -> bool:
    return (
        words_of(name) in (("t", "0"), ("t", "start")) or heading_of(name, None, source.vocabulary).quantity == "time"
    )


def _texts(cells: list[Any], rows: slice) -> list[str]:
    return ["" if cell is None else str(cell) for cell in cells[rows]]


def _flat(value: Any, prefix: str = "", depth: int = 0) -> dict[str, Any]:
    """Nested names as one, with dots; lists of a few numbers as numbered names."""
    found: dict[str, Any] = {}
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, one in list(pairs)[:200]:
        key = f"{prefix}.{name}" if prefix else str(name)
        if isinstance(one, (dict, list)) and depth < _DEEPEST:
            found |= _flat(one, key, depth + 1)
        else:
            found[key] = _as_number(one)
    return found


def _as_number(value: Any) -> Any:
    """A number that is kept as text, as a number; whatever else as it is."""
    if not isinstance(value, str) or not value[:1].isascii() or not value.lstrip("+-.")[:1].isdigit():
        return value
    try:
        return number(value)
    except ValueError:
        return value


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _number(value: Any) -> float:
    if not _is_number(value):
        return float("nan")
    try:
        return float(value)
    except OverflowError:  # a whole number of hundreds of digits
        return float("nan")


def _collect(arrays: list[NamedArray], path: tuple[str, ...], value: Any, depth: int) -> None:
    if isinstance(value, dict) and depth < _DEEPEST and path and _is_indexed(value):
        index = _index(list(value))
        if index is not None and not any(a.path == (*path[:-1], index[0]) for a in arrays):
            arrays.append(NamedArray((*path[:-1], index[0]), index[1]))
        arrays.append(NamedArray(path, np.array([_number(v) for v in value.values()])))
    elif isinstance(value, dict) and depth < _DEEPEST:
        for name, one in value.items():
            _collect(arrays, (*path, str(name)), one, depth + 1)
    elif isinstance(value, list) and value and path:
        if all(isinstance(v, str) for v in value):
            arrays.append(NamedArray(path, np.array(value, dtype=object)))
        elif all(_is_number(v) or v is None for v in value):
            arrays.append(NamedArray(path, np.array([_number(v) for v in value])))
        elif all(isinstance(v, list) and len(v) == len(value[0]) and all(map(_is_number, v)) for v in value):
            arrays.append(NamedArray(path, np.array([[_number(c) for c in v] for v in value])))
        elif depth < _DEEPEST and all(isinstance(v, dict) for v in value):
            for k, one in enumerate(value[:200], start=1):
                _collect(arrays, (*path, str(k)), one, depth + 1)
    elif path and (isinstance(value, str) or _is_number(value)):
        arrays.append(NamedArray(path, value if isinstance(value, str) else _number(value)))
