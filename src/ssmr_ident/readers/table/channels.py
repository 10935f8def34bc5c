"""Columns to channels: units to SI, names in this package's words; what cannot be known is asked with a best guess."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.recording import Channel, Note
from ssmr_ident.core.units import OF_A_GOAL
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import SI_UNIT
from ssmr_ident.readers.table.vocabulary import Vocabulary, words_of

STANDARD_GRAVITY = 9.80665  # m/s^2
_EXAMPLES = {
    "N": "N, kN, lbf or gf", "m": "m, mm or in", "m/s^2": "m/s^2 or g", "rad": "rad or deg", "rad/s": "rad/s or deg/s",
    "m/s": "m/s or mm/s", "N m": "N m", "1": "1 or %", "Pa": "Pa or MPa",
}  # fmt: skip
# Lengths that gravity has in what accelerometers count: in units, and in counts per g of cheap converters
_GRAVITIES = {"m/s^2": STANDARD_GRAVITY, "g": 1.0, "mg": 1e3, "mm/s^2": 1e3 * STANDARD_GRAVITY, "cm/s^2": 980.665}
_COUNTS = (16384.0, 8192.0, 4096.0, 2048.0, 1024.0, 256.0)
_AMBIGUOUS = ("g", "mg", "G")  # of gravity to some, grams to others
_NEAR = 0.04
"""Choice: share of its length by which a mean may miss gravity; tilted sensors keep the length, moving ones nearly."""
_SUPPLY = (0.0, 5.0)  # V; what a sensor on a common supply gives never leaves it
_UNSIGNED = 0.3  # V; a resting sensor stands well above zero


@dataclass(frozen=True)
class Guess:
    """What unitless columns look like: unit, and why."""

    unit: str
    why: str


def channels_of(source: Source, data: list[Column], table: Table, seen: str) -> list[Channel]:
    """Channels in SI with their names; notes for every conversion.

    Parameters
    ----------
    data : list of Column
    seen : str
        What has been understood of the log, for a question about the rest.

    Raises
    ------
    InputError
        A quantity without a unit, or with a unit of something else.
    """
    data = _without_empty(source, data, table)
    _name_by_unit(source, data)
    guess = _gravity(source, data)
    volts = table.assumed_unit == "V" or (not table.words and _look_like_volts(data))
    _ask_for_units(source, data, table, guess, volts and table.assumed_unit == "V", seen)
    channels: list[Channel] = []
    assumed: list[str] = []
    unknown: list[Column] = []
    for column in data:
        quantity = column.quantity
        if column.unit is None and volts and quantity in (None, "ax", "ay", "az"):
            assumed.append(column.shown)
            column.unit = "V"
        conversion = source.vocabulary.unit(column.unit) if column.unit else None
        values, unit = column.values, column.unit or ""
        if conversion is None:
            if unit:
                table.warn(f"{column.shown}: unit {unit!r} is not known; numbers kept as they are")
            else:
                unknown.append(column)
        else:
            unit = conversion.unit
            if conversion.changes:
                values = values * conversion.factor + conversion.offset
                shift = f" + {conversion.offset:g}" if conversion.offset else ""
                level = "warning" if column.unit in ("lb", "lbs", "pounds", "in", "kgf", "psi", "ksi") else "info"
                text = f"{column.shown}: {column.unit} × {conversion.factor:.8g}{shift} = {unit}"
                table.notes.append(Note(level, text))
        channels.append(Channel(quantity or column.shown, values, unit, column.label or column.shown))
    if assumed:
        why = "" if table.assumed_unit else ", as they stay within 0 and 5 like a sensor's supply"
        table.warn(f"{', '.join(assumed)}: no unit in the file, taken as V{why}; --units changes that")
    if unknown:
        _tell_unknown(table, unknown, len(unknown) == len(data))
    return _named(channels, table)


def _without_empty(source: Source, data: list[Column], table: Table) -> list[Column]:
    full = [c for c in data if np.isfinite(c.values).any()]
    empty = [c for c in data if not np.isfinite(c.values).any()]
    asked = next((c for c in empty if c.given), None)
    if asked is not None or not full:
        shown = (asked or empty[0]).shown
        raise source.error(
            f"column {shown} has no numbers", "Export it again, or leave it out with --columns.", table.part
        )
    if empty:
        table.inform(f"column(s) without a number left out: {', '.join(c.shown for c in empty)}")
    return full


def _name_by_unit(source: Source, data: list[Column]) -> None:
    """``X (g)`` is an axis: a letter names what its unit says."""
    for column in data:
        conversion = source.vocabulary.unit(column.unit) if column.unit and column.quantity is None else None
        letter = {"m/s^2": "a", "rad/s": "w"}.get(conversion.unit) if conversion else None
        axis = _axis(column, source.vocabulary)
        if letter and axis:
            column.quantity = letter + axis


def _vector(data: list[Column], known: Vocabulary) -> list[Column]:
    """Three columns without a unit that may be the axes of one sensor: named x, y, z, or without names at all."""
    bare = [c for c in data if c.unit is None]
    axes = [c for c in bare if c.quantity in ("ax", "ay", "az")]
    letters = [c for c in bare if c.quantity is None and _axis(c, known)]
    for found in (axes, letters):
        if len(found) == 3:
            return found
    unnamed = [c for c in data if not c.label]
    return unnamed if len(unnamed) == 3 and len(data) == 3 and unnamed == [c for c in bare if not c.given] else []


def _axis(column: Column, known: Vocabulary) -> str:
    """The letter of a header that holds one and else words that say nothing, such as ``x-axis``; empty for others."""
    words = [w for w in words_of(column.label) if not known.has("modifiers", (w,))]
    numbers = all(word.isdigit() for word in words[:-1])  # before it: y 3 is the third column of y
    return words[-1] if numbers and words[-1:] in (["x"], ["y"], ["z"]) else ""


def _gravity(source: Source, data: list[Column]) -> tuple[list[Column], Guess | None]:
    """Columns whose mean is as long as gravity, with the unit in which it is."""
    columns = _vector(data, source.vocabulary)
    if not columns:
        return [], None
    means = [float(np.mean(c.values[np.isfinite(c.values)])) for c in columns]
    length = float(np.linalg.norm(means))
    largest = columns[int(np.argmax(np.abs(means)))]
    what = f"the mean of {largest.shown} is {means[int(np.argmax(np.abs(means)))]:.4g}"
    if abs(length - abs(max(means, key=abs))) > 0.02 * length:
        what += f", of the three together {length:.4g} long"
    for unit, gravity in _GRAVITIES.items():
        if abs(length - gravity) < _NEAR * gravity:
            return columns, Guess(unit, f"{what}, as gravity is in {unit}: {unit}?")
    for count in _COUNTS:
        if abs(length - count) < _NEAR * count:
            return columns, Guess("", f"{what}, as gravity is in counts of {count:g} per g: divide, or --units …=mg?")
    name = source.path.stem.lower()
    for word, unit in (("gyro", "rad/s"), ("acc", "m/s^2")):
        if word in name:
            return columns, Guess(unit, f"the file's name says {word}: {unit}?")
    return columns, None


def _look_like_volts(data: list[Column]) -> bool:
    """True where no column has a name or a unit and all stay within a sensor's supply, well above zero."""
    if any(c.label or c.unit or c.given for c in data):
        return False
    finite = [c.values[np.isfinite(c.values)] for c in data]
    return all(v.min() > _UNSIGNED and v.max() <= _SUPPLY[1] for v in finite)


def _ask_for_units(
    source: Source, data: list[Column], table: Table, guess: tuple[list[Column], Guess | None], daq: bool, seen: str
) -> None:
    """Stop where a quantity is known and its unit is not, with the best guess and what else was understood."""
    vector, why = guess
    # no word in the file says what is in it, and nothing looks like something
    nameless = (
        not any(c.label or c.unit or c.given for c in data)
        and not daq
        and (bool(table.words) or not _look_like_volts(data))
    )
    asked = []
    for column in data:
        conversion = source.vocabulary.unit(column.unit) if column.unit else None
        expected = SI_UNIT.get(column.quantity or "")
        if column.unit is None:
            volts = daq and column.quantity in (None, "ax", "ay", "az")
            if nameless or (not volts and (expected or (any(column is c for c in vector) and (column.label or why)))):
                asked.append(column)
        elif conversion is None and column.quantity is not None:
            raise source.error(
                f"unit {column.unit!r} of {column.shown} is not known", _mend([column], "N, mm or V"), table.part
            )
        elif column.quantity == "position_reference" and conversion is not None and conversion.unit in OF_A_GOAL:
            continue
        elif conversion is not None and expected and conversion.unit not in (expected, "V"):
            if column.unit not in _AMBIGUOUS and not column.given:
                table.warn(
                    f"{column.shown} is in {column.unit}, which is no unit of {column.quantity}: "
                    f"taken by its unit, under its own name"
                )
                column.quantity = None
                continue
            raise source.error(
                f"{column.shown} is in {column.unit}, which is no unit of {column.quantity}",
                _mend([column], _EXAMPLES.get(expected, expected))
                + f" If it is another quantity: channels: {{QUANTITY: {column.shown}}} beside the file.",
                table.part,
            )
    if not asked:
        return
    shown = ", ".join(c.shown for c in asked)
    reason = f"; {why.why}" if why is not None else ""
    units = [(why.unit if why and any(c is v for v in vector) else "") or "…" for c in asked]
    open_ones = [c for c, unit in zip(asked, units, strict=True) if unit == "…"]
    examples = sorted({_EXAMPLES.get(SI_UNIT.get(c.quantity or "", ""), "N, mm, V or g") for c in open_ones})
    such = f"such as {'; '.join(examples)}" if open_ones else ""
    clock = next((c.number for c in table.columns if not any(c is one for one in data)), None)
    raise source.error(f"unit of {shown} unknown{reason} ({seen})", _mend(asked, such, units, clock), table.part)


def _mend(columns: list[Column], such_as: str, units: list[str] | None = None, clock: int | None = None) -> str:
    """How a unit is told: on the command line, or where a session lists the recording.

    Parameters
    ----------
    clock : int or None
        Number of a time column without a name.
    """
    such = f", {such_as}" if such_as else ""
    units = units or ["…"] * len(columns)
    if not any(c.label for c in columns):
        names = ("ax", "ay", "az") if len(columns) == 3 else ("force", "acceleration", "position")
        named = dict(zip(names, columns, strict=False))
        numbers = {**({} if clock is None else {"time": clock}), **{name: c.number for name, c in named.items()}}
        pairs = ",".join(f"{name}={number}" for name, number in numbers.items())
        examples = "is an example" if len(named) == 1 else "are examples"
        said = "" if len(columns) == 3 else f" What they are only you know: {' and '.join(named)} {examples}."
        return f"Give --columns {pairs} --units {','.join(map('='.join, zip(named, units, strict=False)))}{such}.{said}"
    labels = [c.label for c in columns]
    shown = [str(c.number) if labels.count(c.label) > 1 else c.shown for c in columns]  # a name that stands twice
    pairs = ",".join(map("=".join, zip(shown, units, strict=True)))
    keys = ", ".join(map(": ".join, zip(shown, units, strict=True)))
    return f"Give --units {pairs}{such}; in session.yaml, units: {{{keys}}} beside the file."


def _tell_unknown(table: Table, unknown: list[Column], all_of_them: bool) -> None:
    """What a column is and in which unit is a question where no channel is known; among known ones it is a remark."""
    more = f" and {len(unknown) - 8} more" if len(unknown) > 8 else ""
    shown = ", ".join(c.shown for c in unknown[:8]) + more
    text = f"{shown}: no unit in the file and no quantity that is known by name; the numbers are kept as they are"
    if all_of_them:
        which = unknown[0].label or unknown[0].number
        table.warn(f"{text}. Say what they are, for example --columns force={which} --units force=N")
    else:
        table.inform(text)


def _named(channels: list[Channel], table: Table) -> list[Channel]:
    """Names that differ; three voltages of a data-acquisition log are the axes x, y, z."""
    volts = [channel for channel in channels if channel.unit == "V"]
    if table.axes_in_volts and len(channels) == len(volts) == 3 and not {"ax", "ay", "az"} & {c.name for c in channels}:
        pairs = list(zip(("ax", "ay", "az"), volts, strict=True))
        table.notes.append(Note("info", "three voltage channels: " + ", ".join(f"{a} = {c.label}" for a, c in pairs)))
        channels = [replace(c, name=axis) for axis, c in pairs]
    seen: dict[str, int] = {}
    taken = {channel.name for channel in channels}
    result = []
    for channel in channels:
        seen[channel.name] = seen.get(channel.name, 0) + 1
        name = channel.name
        while seen[channel.name] > 1 and (name := f"{channel.name}_{seen[channel.name]}") in taken:
            seen[channel.name] += 1
        result.append(replace(channel, name=name))
    return result
