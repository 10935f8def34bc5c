"""Tables in long form: a row is one sample of one sensor, and a column of words says of which.

Brokers, databases and robots write ``time, sensor, value`` or ``timestamp, topic, x, y, z``. Every sensor becomes
channels of its own, at its own times. A column of words that say what went on (a state, a label) splits nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import heading_of
from ssmr_ident.readers.table.vocabulary import Vocabulary, words_of

MOST_NAMES = 64  # sensors that a table may hold
_LOOK = 64  # consecutive rows that show whether names alternate
_FEWEST = 3  # samples that a sensor has
_SHARE = 0.1
"""Choice: share of stamps that repeat or fall from which on rows are no consecutive samples."""

Words = Callable[[slice], Sequence[str]]
"""Cells of a column of words, by rows."""


def in_own_columns(source: Source, columns: list[Column], words: dict[str, Words], table: Table) -> list[Column]:
    """A column for every sensor and quantity, where the rows are samples of several sensors in turn.

    Parameters
    ----------
    columns : list of Column
        Of numbers, of one length.
    words : dict of str to Words
        Columns of words by their names.
    """
    known = source.vocabulary
    times = [c for c in columns if c.clock or heading_of(c.label, c.unit, known).quantity in ("time", "date")]
    count = len(columns[0].values) if columns else 0
    if not times or len(times) == len(columns) or count < 2 * _FEWEST:
        return columns
    numbered = {c.label: _numbers(c) for c in columns if _called(c.label, known) and _counts_few(c)}
    if not words and not numbered:
        return columns
    mixed, even = _mixed(times), _even(times)
    candidates: dict[str, np.ndarray] = {}
    for name, cells in {**words, **numbered}.items():
        if heading_of(name, None, known).quantity or _says_unit(name, known):
            continue
        told = name in words and _called(name, known)
        begin = (count - _LOOK) // 2 if count > _LOOK else 0
        if not told and not mixed and (even or not _alternate(cells(slice(begin, begin + _LOOK)))):
            continue
        all_cells = np.array(cells(slice(0, count)), dtype=object)
        if 1 < len(set(all_cells.tolist())) <= MOST_NAMES:
            candidates[name] = all_cells
    names = _telling(candidates, times, known)
    if not names:
        return columns
    keys = _together([candidates[name] for name in names])
    rest = [c for c in columns if not any(c is t for t in times) and c.label not in candidates]
    values = [c for c in rest if not heading_of(c.label, c.unit, known).role] or rest
    made = _split(source, values, keys, words, known)
    if not made:
        return columns
    table.words[:] = [w for w in table.words if w not in candidates and not (_says_unit(w, known) and w in words)]
    sensors = list(dict.fromkeys(keys.tolist()))
    table.inform(
        f"every row is a sample of the sensor that column {' and '.join(names)} names: channels of their own for "
        f"{', '.join(map(str, sensors[:8]))}{f' and {len(sensors) - 8} more' if len(sensors) > 8 else ''}"
    )
    whole = [*times, *made]
    for number, column in enumerate(whole):
        column.number = number
    return whole


def _telling(candidates: dict[str, np.ndarray], times: list[Column], known: Vocabulary) -> list[str]:
    """The fewest columns of words by which every sensor's stamps rise; empty when all together do not.

    Of two that say the same, the one whose words name quantities stays.
    """

    def enough(names: list[str]) -> bool:
        if not names:
            return False
        keys = _together([candidates[name] for name in names])
        distinct = set(keys.tolist())
        return 1 < len(distinct) <= MOST_NAMES and all(_ticks(times, keys == one) for one in distinct)

    def named(name: str) -> int:
        return sum(heading_of(str(one), None, known).quantity is not None for one in set(candidates[name].tolist()))

    kept = list(candidates)
    if not enough(kept):
        return []
    for name in sorted(candidates, key=named):
        fewer = [one for one in kept if one != name]
        if enough(fewer):
            kept = fewer
    return kept


def _together(columns: list[np.ndarray]) -> np.ndarray:
    """Words of several columns as one, (n,) object."""
    if len(columns) == 1:
        return columns[0]
    return np.array([".".join(map(str, row)) for row in zip(*columns, strict=True)], dtype=object)


def _split(
    source: Source, values: list[Column], keys: np.ndarray, words: dict[str, Words], known: Vocabulary
) -> list[Column]:
    """The columns of each sensor, with the rows that are its own."""
    units = [np.array(cells(slice(0, len(keys))), dtype=object) for w, cells in words.items() if _says_unit(w, known)]
    sensors = list(dict.fromkeys(keys.tolist()))
    own = {id(c): [s for s in sensors if np.isfinite(c.values[keys == s]).any()] for c in values}
    made: list[Column] = []
    for sensor in sensors:
        rows = np.flatnonzero(keys == sensor)
        mine = [c for c in values if sensor in own[id(c)]]
        said = {u[rows[0]] for u in units if len(set(u[rows].tolist())) == 1} - {""}
        for column in mine:
            if len(own[id(column)]) == 1:
                label, unit = column.label, column.unit  # a name that no other sensor has
            else:
                name = str(sensor) if len(mine) == 1 else f"{sensor}.{column.shown}"
                heading = heading_of(name, None, known)
                label, unit = heading.label, column.unit or _unit_of_values(column.label, known) or heading.unit
            made.append(replace(column, label=label, unit=next(iter(said), unit), rows=rows))
    return made


def _unit_of_values(label: str, known: Vocabulary) -> str | None:
    """The unit behind ``value_g``, a name that says nothing else."""
    word, _, unit = label.partition("_")
    return unit if known.has("modifiers", words_of(word)) and known.unit(unit) is not None else None


def _called(name: str, known: Vocabulary) -> bool:
    words = words_of(name)
    return known.has("series", words) or (len(words) > 1 and known.has("series", words[-2:]))


def _says_unit(name: str, known: Vocabulary) -> bool:
    return known.has("units_said", words_of(name))


def _counts_few(column: Column) -> bool:
    """Whole numbers of which few differ: the number of a channel."""
    some = column.values[:1000]
    return bool(np.isfinite(column.values).all()) and bool((some == np.round(some)).all()) and (
        1 < len(np.unique(column.values)) <= MOST_NAMES
    )  # fmt: skip


def _numbers(column: Column) -> Words:
    return lambda rows: [f"{column.label} {v:g}" for v in column.values[rows]]


def _mixed(times: list[Column]) -> bool:
    """True where stamps repeat or fall too often for consecutive samples, or begin again."""
    steps = np.diff(times[0].values)
    return bool(np.mean(steps <= 0) > _SHARE) or bool((steps < 0).any())


def _even(times: list[Column]) -> bool:
    """True for rows that follow each other evenly: samples of one logger, whatever changes in a column of words."""
    steps = np.diff(times[0].values)
    typical = float(np.median(steps))
    return bool(np.mean(np.abs(steps - typical) > 0.05 * abs(typical)) <= _SHARE)


def _alternate(cells: Sequence[str]) -> bool:
    """True for names that change with every second row at least, and come again."""
    changes = sum(a != b for a, b in zip(cells[1:], cells[:-1], strict=True))
    return 2 * changes > len(cells) and len(set(cells)) <= len(cells) / _FEWEST


def _ticks(times: list[Column], mine: np.ndarray) -> bool:
    """True where the stamps of one sensor rise."""
    steps = np.diff(times[0].values[mine])
    return len(steps) + 1 >= _FEWEST and bool(np.mean(steps <= 0) <= _SHARE)
