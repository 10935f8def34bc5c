"""Workbooks from LabVIEW: three sheets z, y, x of time and volts (the thesis), or one sheet with all columns."""

from __future__ import annotations

import re

import numpy as np

from ssmr_ident.core.recording import Channel, Note, Recording
from ssmr_ident.core.units import find_unit
from ssmr_ident.readers.health import warnings_of
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table import time_axis
from ssmr_ident.readers.table.columns import Column, Table
from ssmr_ident.readers.table.headings import split_header
from ssmr_ident.readers.table.stamp_units import clock_of
from ssmr_ident.readers.xlsx.sheet_axes import axes_of
from ssmr_ident.readers.xlsx.sheet_numbers import SheetNumbers, numbers_of
from ssmr_ident.readers.xlsx.value_sheets import read_values, value_sheets
from ssmr_ident.readers.xlsx.workbook import Sheet, open_sheets, what_is_in

NAMES = ("labview-xlsx",)
_SUPPLY = (0.0, 5.0)  # V, the sensor's supply; it cannot leave it
_DAQ_RANGE = 10.0  # V
_SLOWEST = 0.02  # s: 50 Hz; the band of interest ends there, so no axis was sampled more slowly


def recognises(source: Source) -> bool:
    return source.kind == "workbook"


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of a workbook.

    Raises
    ------
    InputError
        Sheets that do not say which axis they are, axes that do not fit together, cells that are no numbers.
    """
    sheets = open_sheets(source)
    wide = value_sheets(source, sheets, options)
    if wide:
        return read_values(source, sheets, wide, options)
    axes = axes_of(source, sheets, options)
    numbers = {axis: _axis_numbers(source, sheet, axis, options) for axis, sheet in axes.items()}
    return [_recording(source, axes, numbers, options)]


def _axis_numbers(source: Source, sheet: Sheet, axis: str, options: ReadOptions) -> SheetNumbers:
    found = numbers_of(source, sheet, f"axis {axis}", options)
    width = found.values.shape[1]
    if width == 1:
        if options.fs is None:
            below = int(found.rows[0]) - 1
            beside = what_is_in(source, sheet.name, below, found.first_column + 1)
            if "never calculated" in beside:
                raise source.error(
                    f"formulas were never calculated ({beside})",
                    "Open the workbook in Excel and save it.",
                    sheet.name,
                )
            raise source.error(
                f"time column missing in sheet {sheet.name} (axis {axis})", "Give --fs 1000 to accept volts only."
            )
        found.values = np.column_stack([np.arange(len(found.values)) / options.fs, found.values[:, 0]])
        found.notes.append(Note("info", f"time from --fs {options.fs:g} Hz", sheet.name))
        return found
    if width > 2:
        raise source.error(
            f"sheet {sheet.name} (axis {axis}) has {width} columns of numbers; time and volts are expected",
            "Delete the others, or split the sheet.",
        )
    stamps = found.values[:, 0]
    if options.fs is not None:
        stamps = np.arange(len(stamps)) / options.fs
        found.notes.append(
            Note("info", f"time from --fs {options.fs:g} Hz; the sheet's column is not used", sheet.name)
        )
    elif options.time_unit is not None:
        conversion = find_unit(options.time_unit)
        if conversion is None or conversion.unit != "s":
            raise source.error(f"--time-unit {options.time_unit} is no unit of time", "Give s, ms or us.")
        stamps = stamps * conversion.factor
    clock = clock_of(source, Column("time", "s", stamps, found.dated), ReadOptions(), Table([], str))
    found.values[:, 0] = clock.seconds
    found.notes += [Note("info", text, sheet.name) for text in clock.notes]
    if found.dated and options.fs is None:
        _check_date_resolution(source, sheet, found)
    return found


def _check_date_resolution(source: Source, sheet: Sheet, found: SheetNumbers) -> None:
    """Date cells are read to the millisecond: steps must be longer than twice what the rounding moves them."""
    stamps = found.values[:, 0]
    if len(stamps) < 3:
        return
    grid = np.linspace(stamps[0], stamps[-1], len(stamps))
    step = (stamps[-1] - stamps[0]) / (len(stamps) - 1)
    if step <= 0 or (np.abs(stamps - grid).max() > step / 4 and np.median(np.diff(stamps)) < 0.004):
        raise source.error(
            f"sheet {sheet.name}: date-time cells resolve 1 ms, too coarse for steps of {step:.3g} s",
            "Give --fs, or export relative time.",
        )


def _recording(
    source: Source, axes: dict[str, Sheet], numbers: dict[str, SheetNumbers], options: ReadOptions
) -> Recording:
    notes: list[Note] = []
    steps = {}
    for axis, found in numbers.items():
        notes += found.notes
        steps[axis] = float(np.median(np.diff(found.values[:, 0]))) if len(found.values) > 1 else 0.0
    for axis, found in numbers.items():
        _check_axis(source, axes[axis], found, steps[axis], min(steps.values()), options, notes)
    order: list[str] = [axis for axis in ("x", "y", "z", "ax", "ay", "az") if axis in numbers]
    time, values = _on_one_grid(source, axes, numbers, order, options, notes)
    _check_volts(source, axes, order, values, options, notes)
    _refuse_equal_sheets(source, axes, order, time, values, notes)
    channels = []
    for axis in order:
        label, _ = split_header(numbers[axis].labels[-1])
        name = "a" + axis.removeprefix("a")
        channels.append(Channel(name, np.ascontiguousarray(values[axis]), "V", label or axes[axis].name))
    _compare_with_name(source, time, notes)
    part = ", ".join(f"{c.name} = sheet {axes[a].name}" for a, c in zip(order, channels, strict=True))
    return Recording(
        np.ascontiguousarray(time),
        tuple(channels),
        source.provenance("labview-xlsx", part),
        (*source.notes, *notes, *warnings_of(tuple(channels))),
        {},
    )


def _compare_with_name(source: Source, time: np.ndarray, notes: list[Note]) -> None:
    """The thesis' names say how long a run was: ``v0-w90-t20-…`` is 20 s."""
    match = re.search(r"-t(\d+)(?:-|$)", source.path.stem)
    length = float(time[-1] - time[0]) + float(time[1] - time[0])
    if match and abs(length - int(match[1])) > 0.02 * int(match[1]):
        notes.append(
            Note(
                "warning",
                f"holds {length:.4g} s, its name says {match[1]} s; a graph export holds what was visible",
            )
        )


def _check_axis(
    source: Source,
    sheet: Sheet,
    found: SheetNumbers,
    step: float,
    finest: float,
    options: ReadOptions,
    notes: list[Note],
) -> None:
    def place(row: int) -> str:
        return f"{sheet.name}, row {found.rows[row]}"

    stamps = found.values[:, 0]
    try:
        axis = time_axis.check(stamps, place, split=False)
    except time_axis.TimeProblem as error:
        raise source.error(error.problem, error.mend, place(error.row)) from error
    if axis.rows is not None:
        found.values, found.rows = found.values[axis.rows], found.rows[axis.rows]
    notes += axis.notes
    if options.fs is None and options.time_unit is None and step > _SLOWEST:
        expected = f"{finest:g} s as in the other sheets" if finest < step else "0.001 s or so"
        raise source.error(
            f"sheet {sheet.name}: dt = {step:g} s, expected {expected}",
            "Is the column in ms (--time-unit ms) or a sample count (--fs 1000)?",
        )
    notes += time_axis.gaps(found.values[:, 0], place)


def _on_one_grid(
    source: Source,
    axes: dict[str, Sheet],
    numbers: dict[str, SheetNumbers],
    order: list[str],
    options: ReadOptions,
    notes: list[Note],
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    lengths = {axis: len(numbers[axis].values) for axis in order}
    first = numbers[order[0]].values[:, 0]
    tolerance = 0.25 * float(np.median(np.diff(first)))
    same = len(set(lengths.values())) == 1 and all(
        np.abs(numbers[axis].values[:, 0] - first).max() <= tolerance for axis in order[1:]
    )
    if same:
        return first, {axis: numbers[axis].values[:, 1] for axis in order}
    counts = ", ".join(f"{axis} {count}" for axis, count in lengths.items())
    reason = "; ".join(note.text for note in notes if "missing after" in note.text)
    if not options.trim:
        what = f"{counts} samples" if len(set(lengths.values())) > 1 else "the same count of samples at different times"
        raise source.error(
            f"axes differ: {what}" + (f" ({reason})" if reason else ""),
            "Keep what all have with --trim, or export the axes again.",
        )
    ticks = {axis: np.round(numbers[axis].values[:, 0] / (4 * tolerance)).astype(np.int64) for axis in order}
    common = ticks[order[0]]
    for axis in order[1:]:
        common = np.intersect1d(common, ticks[axis])
    if len(common) < 2:
        raise source.error("axes have no samples at the same times", "Export the axes of one recording.")
    rows = {axis: np.searchsorted(ticks[axis], common) for axis in order}
    notes.append(Note("warning", f"axes differ ({counts} samples); trimmed to the {len(common)} that all have"))
    return numbers[order[0]].values[rows[order[0]], 0], {a: numbers[a].values[rows[a], 1] for a in order}


def _check_volts(
    source: Source,
    axes: dict[str, Sheet],
    order: list[str],
    values: dict[str, np.ndarray],
    options: ReadOptions,
    notes: list[Note],
) -> None:
    for axis in order:
        given = next((unit for key, unit in options.units.items() if key.lower().removeprefix("a") == axis[-1]), None)
        if given is not None:
            conversion = find_unit(given)
            if conversion is None or conversion.unit != "V":
                raise source.error(f"unit {given!r} for axis {axis} is no voltage", "Give V or mV.")
            values[axis] = values[axis] * conversion.factor
            notes.append(Note("info", f"a{axis[-1]}: {given} × {conversion.factor:g} = V"))
        low, high = float(np.nanmin(values[axis])), float(np.nanmax(values[axis]))
        extreme = high if abs(high) >= abs(low) else low
        if abs(extreme) > _DAQ_RANGE:
            raise source.error(
                f"volts outside 0…5 V (extreme {extreme:g}), as if in mV",
                f"If so: --units a{axis[-1]}=mV.",
                f"sheet {axes[axis].name}",
            )
        if low < _SUPPLY[0] or high > _SUPPLY[1]:
            notes.append(Note("warning", f"volts outside the sensor's 0…5 V ({low:g} to {high:g})", axes[axis].name))


def _refuse_equal_sheets(
    source: Source,
    axes: dict[str, Sheet],
    order: list[str],
    time: np.ndarray,
    values: dict[str, np.ndarray],
    notes: list[Note],
) -> None:
    """Two measured axes never agree in every sample; a straight line holds no noise that could tell."""
    for i, first in enumerate(order):
        for second in order[i + 1 :]:
            if not np.array_equal(values[first], values[second]):
                continue
            line = np.polynomial.Polynomial.fit(time, values[first], 1)
            bend = float(np.abs(values[first] - line(time)).max())
            text = f"sheets {axes[first].name} and {axes[second].name} are identical"
            if bend > 1e-9 * max(1.0, float(np.abs(values[first]).max())):
                raise source.error(text, "The same axis was pasted twice; export the other one.")
            notes.append(Note("warning", f"{text} (a straight line: no sensor, or no noise?)"))
