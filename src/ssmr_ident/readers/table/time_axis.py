"""The time axis: from stamps in any unit to increasing seconds, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.recording import Note

MIDNIGHT = 86400.0
SECONDS_1904 = 2.0e9  # a LabVIEW stamp after 1967; no recording lasts 63 years
GAP_FACTOR = 1.5  # a step this long lost at least half a sample
TICK_FACTOR = 1e-9  # relative rounding of doubles in a long stamp


@dataclass
class TimeAxis:
    """Time in seconds, which rows of the table are kept, and what was noticed.

    Parameters
    ----------
    time : (n,) float [s]
    rows : (n,) int or None
        Kept rows of the table; None for all.
    restarts : list of int
        Kept-row indices where time begins again (another sample).
    """

    time: np.ndarray
    rows: np.ndarray | None = None
    restarts: list[int] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)


class TimeProblem(Exception):
    """The time column cannot be used; carries the row, for whoever knows the place in the file."""

    def __init__(self, row: int, problem: str, mend: str) -> None:
        super().__init__(problem)
        self.row, self.problem, self.mend = row, problem, mend


def elapsed(stamps: np.ndarray, *, clock: bool = False) -> tuple[np.ndarray, list[Note]]:
    """Absolute stamps (clock times, dates, seconds since 1904) to seconds since the first one.

    Parameters
    ----------
    stamps : (n,) float [s]
    clock : bool
        True for clock times, which begin again at midnight.
    """
    notes: list[Note] = []
    if clock and len(stamps):
        drops = np.flatnonzero(np.diff(stamps) < -MIDNIGHT / 2)
        if len(drops) and stamps.max() < MIDNIGHT + 1:
            stamps = stamps.copy()
            for drop in drops:
                stamps[drop + 1 :] += MIDNIGHT
            notes.append(Note("info", "clock times run over midnight; carried on"))
    if clock or (len(stamps) and np.nanmin(stamps) > SECONDS_1904):
        kind = "clock times" if clock else "absolute seconds (LabVIEW counts from 1904)"
        resolution = np.spacing(np.nanmax(np.abs(stamps))) if len(stamps) else 0.0
        stamps = stamps - stamps[0]
        notes.append(
            Note(
                "info",
                f"time: {kind} became seconds since the first sample "
                f"(resolution of the stamp {max(resolution, 1e-9):.1g} s)",
            )
        )
    return stamps, notes


def check(stamps: np.ndarray, place: Callable[[int], str], *, split: bool) -> TimeAxis:
    """Drop doubled stamps, find restarts and gaps.

    Parameters
    ----------
    stamps : (n,) float [s]
        Finite.
    place : function of int to str
        Names a row of the table for the user (``line 12``, ``row 21``).
    split : bool
        Whether a restart begins another sample (text logs of several specimens) or is an error.

    Raises
    ------
    TimeProblem
        Time runs backwards without a restart, or its stamps are too coarse.
    """
    axis = TimeAxis(stamps)
    if len(stamps) < 2 or bool((stamps[1:] > stamps[:-1]).all()):
        return axis
    steps = np.diff(stamps)
    restarts = _restarts(stamps, steps, place, split)
    keep = np.ones(len(stamps), dtype=bool)
    keep[1:][steps == 0] = False
    doubled = np.flatnonzero(~keep)
    if len(doubled) > max(1, 0.01 * len(stamps)):
        raise TimeProblem(
            int(doubled[0]),
            f"time stands still in {len(doubled)} of {len(stamps)} rows: its resolution is coarser than the sampling",
            "Give --fs.",
        )
    if len(doubled):
        axis.notes.append(
            Note(
                "warning",
                f"{len(doubled)} row(s) repeat the time of the row before, dropped (t = {stamps[doubled[0]]:.6g} s)",
                place(int(doubled[0])),
            )
        )
    axis.rows = np.flatnonzero(keep)
    axis.time = stamps[keep]
    axis.restarts = [int(np.searchsorted(axis.rows, start)) for start in restarts]
    return axis


def _restarts(stamps: np.ndarray, steps: np.ndarray, place: Callable[[int], str], split: bool) -> list[int]:
    """Rows where time falls back to where the sample began."""
    backward = np.flatnonzero(steps < 0) + 1
    begin = 0
    found = []
    for row in backward:
        typical = float(np.median(steps[begin : row - 1])) if row - begin > 1 else 0.0
        near_start = stamps[row] <= stamps[begin] + 2 * abs(typical) + 1e-12
        # one row that falls back and whose successor goes on is a damaged stamp, not another sample
        goes_on = row + 1 >= len(stamps) or stamps[row + 1] < stamps[row - 1]
        if not (split and near_start and goes_on):
            raise TimeProblem(
                int(row),
                f"time decreases from {stamps[row - 1]:.6g} to {stamps[row]:.6g} s: two recordings in one table",
                "Keep one of them per file or sheet.",
            )
        found.append(int(row))
        begin = int(row)
    return found


def gaps(time: np.ndarray, place: Callable[[int], str]) -> list[Note]:
    """Warnings for missing samples, the first three by name.

    Parameters
    ----------
    time : (n,) float [s]
        Increasing.
    """
    if len(time) < 4:
        return []
    steps = np.diff(time)
    typical = float(np.median(steps[:: max(1, len(steps) // 10_000)]))  # ten thousand steps tell as well as all
    wide = np.flatnonzero(steps > GAP_FACTOR * typical * (1 + TICK_FACTOR))
    # logs with a rate of their own per phase are no logs with holes: half the steps must agree
    if not len(wide) or np.mean(np.abs(steps - typical) <= 0.25 * typical) < 0.5:
        return []
    notes = []
    for row in wide[:3]:
        lost = round(float(steps[row] / typical)) - 1
        missing = f"{lost} samples missing" if lost > 0 else "a step too long"
        notes.append(
            Note(
                "warning",
                f"{missing} after t = {time[row]:.6g} s: time jumps to {time[row + 1]:.6g} s",
                place(int(row + 1)),
            )
        )
    if len(wide) > 3:
        notes.append(Note("warning", f"{len(wide)} gaps in time altogether; the first three are named"))
    return notes
