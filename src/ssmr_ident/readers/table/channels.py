"""Columns to channels: units to SI, names in this package's words."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.errors import did_you_mean
from ssmr_ident.core.recording import Channel, Note
from ssmr_ident.core.units import QUANTITY_OF_UNIT, find_unit
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import quantity_of

SI_UNIT = {quantity: unit for unit, quantity in QUANTITY_OF_UNIT.items()}
SI_UNIT |= {"ax": "m/s^2", "ay": "m/s^2", "az": "m/s^2", "wx": "rad/s", "wy": "rad/s", "wz": "rad/s"}
SI_UNIT |= {"acceleration_2": "m/s^2", "position_reference": "m"}
_EXAMPLES = {"N": "N, kN, lbf or gf", "m": "mm or in", "m/s^2": "m/s^2 or g", "rad": "deg"}


def apply_units(source: Source, columns: list[Column], options: ReadOptions) -> None:
    """Units that the user gave win over the file's.

    Raises
    ------
    InputError
        An unknown unit, or no column of that name.
    """
    if options.fs is not None:
        for column in columns:
            if quantity_of(column.label, column.unit) == "time" and column.quantity is None:
                column.quantity = "time"
    known = {}
    for column in columns:
        names = (column.label.lower(), column.quantity or quantity_of(column.label, column.unit) or "")
        known[id(column)] = names
    for wanted, unit in options.units.items():
        if find_unit(unit) is None:
            raise source.error(
                f"unit {unit!r} of --units {wanted}={unit} is not known",
                "Units are written as in N, lbf, mm, in, s, ms, V, m/s^2, g.",
            )
        matches = [c for c in columns if wanted.lower() in known[id(c)]]
        matches = matches or [c for c in columns if any(n.startswith(wanted.lower()) for n in known[id(c)] if n)]
        if not matches:
            raise source.error(
                f"has no column {wanted!r} for --units", did_you_mean(wanted, [column.label for column in columns])
            )
        for column in matches:
            column.unit = unit


def channels_of(
    source: Source, data: list[Column], rows: np.ndarray | None, table: Table, notes: list[Note]
) -> list[Channel]:
    """Channels in SI with their names; notes for every conversion.

    Raises
    ------
    InputError
        A quantity without a unit, or with a unit of something else.
    """
    channels: list[Channel] = []
    assumed = []
    for column in data:
        quantity = column.quantity or quantity_of(column.label, column.unit)
        conversion = find_unit(column.unit) if column.unit else None
        label = column.label
        values = column.values if rows is None else column.values[rows]
        if column.unit is None and table.assumed_unit is not None and quantity in (None, "ax", "ay", "az"):
            assumed.append(label or f"column {len(channels) + 2}")
            unit = table.assumed_unit
        elif column.unit is None and quantity is not None:
            raise source.error(f"unit of {label} unknown", _given(label, "N, mm, V or g"), table.part)
        elif conversion is None:
            unit = column.unit or ""
            why = f"unit {unit!r} is not known" if unit else "states no unit"
            if quantity is not None:
                raise source.error(f"unit {unit!r} of {label} is not known", _given(label, "N, mm or V"), table.part)
            notes.append(Note("warning", f"{label or 'a column'}: {why}; numbers kept as they are"))
        else:
            unit = conversion.unit
            expected = SI_UNIT.get(quantity or "", unit)
            if unit not in (expected, "V"):
                raise source.error(
                    f"{label} is in {column.unit}, which is no unit of {quantity}",
                    _given(label, _EXAMPLES.get(expected, expected)),
                    table.part,
                )
            if conversion.changes:
                values = values * conversion.factor + conversion.offset
                shift = f" + {conversion.offset:g}" if conversion.offset else ""
                level = "warning" if column.unit in ("lb", "lbs", "in", "kgf", "psi", "ksi") else "info"
                notes.append(Note(level, f"{label}: {column.unit} × {conversion.factor:.8g}{shift} = {unit}"))
        channels.append(Channel(quantity or label or f"column {len(channels) + 2}", values, unit, label))
    if assumed:
        notes.append(
            Note(
                "warning",
                f"{', '.join(assumed)}: no unit in the file, taken as {table.assumed_unit}; --units changes that",
            )
        )
    return _named(channels, table, notes)


def _given(label: str, such_as: str) -> str:
    """How a unit is told: on the command line, or where a session lists the recording."""
    return f"Give --units {label}=…, such as {such_as}; in session.yaml, units: {{{label}: …}} beside the file."


def _named(channels: list[Channel], table: Table, notes: list[Note]) -> list[Channel]:
    """Names that differ; three voltages of a data-acquisition log are the axes x, y, z."""
    volts = [channel for channel in channels if channel.unit == "V"]
    if table.axes_in_volts and len(channels) == len(volts) == 3 and not {"ax", "ay", "az"} & {c.name for c in channels}:
        notes.append(
            Note(
                "info",
                "three voltage channels: "
                + ", ".join(f"{a} = {c.label}" for a, c in zip(("ax", "ay", "az"), volts, strict=True)),
            )
        )
        channels = [
            Channel(axis, c.samples, c.unit, c.label) for axis, c in zip(("ax", "ay", "az"), volts, strict=True)
        ]
    seen: dict[str, int] = {}
    result = []
    for channel in channels:
        seen[channel.name] = seen.get(channel.name, 0) + 1
        name = channel.name if seen[channel.name] == 1 else f"{channel.name}_{seen[channel.name]}"
        result.append(Channel(name, channel.samples, channel.unit, channel.label))
    return result
