"""Which worksheet is which axis: as the user says, by the sheets' names, or by position (z, y, x)."""

from __future__ import annotations

from ssmr_ident.core.errors import did_you_mean
from ssmr_ident.readers.options import ReadOptions, numbered
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.xlsx.workbook import Sheet

# xlsread(file, 4 - i): Excel puts a new sheet before the active one, so x, written first, ends up last
BY_POSITION = ("z", "y", "x")


def is_filled(sheet: Sheet) -> bool:
    """True when any cell holds something."""
    return any(cell != "" for row in sheet.rows for cell in row)


def axes_of(source: Source, sheets: list[Sheet], options: ReadOptions) -> dict[str, Sheet]:
    """Sheet of each axis: as the user says, by their names, or by position.

    Raises
    ------
    InputError
        When neither tells which sheet is which axis.
    """
    if options.sheets:
        return {axis: _wanted(source, sheets, axis, which) for axis, which in options.sheets.items()}
    named = {sheet.name.strip().lower().removeprefix("a"): sheet for sheet in reversed(sheets)}
    hidden = [sheet for sheet in sheets if sheet.hidden]
    if {"x", "y", "z"} <= named.keys():
        axes = {axis: named[axis] for axis in ("x", "y", "z")}
        used = {id(sheet) for sheet in axes.values()}
        for sheet in sheets:
            if id(sheet) not in used:
                level = source.warn if sheet.hidden else source.inform
                level(
                    f"sheet {sheet.name} is {'hidden and was ' if sheet.hidden else ''}ignored; the sheets named "
                    "x, y, z are the axes",
                    sheet.name,
                )
        order = [sheet.name.strip().lower().removeprefix("a") for sheet in sheets if id(sheet) in used]
        if tuple(order) != BY_POSITION:
            source.warn(
                f"sheets are named in the order {', '.join(order)}, not z, y, x as by position; the names were followed"
            )
        return axes
    names = ", ".join(sheet.name for sheet in sheets)
    if len(sheets) < 3:
        raise source.error(
            f"3 worksheets needed (z,y,x), found {len(sheets)}: {names}",
            "Export the missing axes, or name sheets with --sheets x=1.",
        )
    if len(sheets) > 3:
        visible = [sheet for sheet in sheets if not sheet.hidden and is_filled(sheet)]
        if len(visible) != 3:
            raise source.error(
                f"3 worksheets needed (z,y,x), found {len(sheets)}: {names}",
                "Say which is which: --sheets x=4,y=3,z=2.",
            )
        left = [sheet.name for sheet in sheets if sheet not in visible]
        source.warn(f"hidden or empty sheets ignored: {', '.join(left)}")
        sheets, hidden = visible, []
    for sheet in hidden:
        source.warn(f"sheet {sheet.name} is hidden and was counted", sheet.name)
    for position, sheet in enumerate(sheets):
        name = sheet.name.strip().lower().removeprefix("a")
        if name in ("x", "y", "z") and name != BY_POSITION[position]:
            raise source.error(
                f"sheet {position + 1} is named {sheet.name}, by position it would be {BY_POSITION[position]}",
                "Say which is which: --sheets x=3,y=2,z=1.",
            )
    source.inform(
        "axes by position: "
        + ", ".join(
            f"sheet {i} {s.name} = {a}" for i, (a, s) in enumerate(zip(BY_POSITION, sheets, strict=True), start=1)
        )
    )
    return dict(zip(BY_POSITION, sheets, strict=True))


def _wanted(source: Source, sheets: list[Sheet], axis: str, which: int | str) -> Sheet:
    if axis.removeprefix("a") not in ("x", "y", "z"):
        raise source.error(f"--sheets names axis {axis!r}; axes are x, y, z", "Write --sheets x=3,y=2,z=1.")
    number = numbered(which)
    if number is not None:
        if 1 <= number <= len(sheets):
            return sheets[number - 1]
        raise source.error(f"has {len(sheets)} worksheets; sheet {which} for {axis} is not there", "They count from 1.")
    found = [sheet for sheet in sheets if sheet.name == which]
    if not found:
        raise source.error(
            f"has no sheet {which!r} for {axis}", did_you_mean(str(which), [sheet.name for sheet in sheets])
        )
    return found[0]
