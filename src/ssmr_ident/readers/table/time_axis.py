"""The time axis: rows to keep, parts where time begins again, an even grid where stamps are coarse, and gaps."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.recording import Note

GAP_FACTOR = 1.5  # a step this long lost at least half a sample
TICK_FACTOR = 1e-9  # relative rounding of doubles in a long stamp
_RARE = 0.01
"""Choice: share of steps up to which wide or doubled ones are lost or repeated samples; more are the clock's way."""
_COARSE = 0.2
"""Choice: step of the stamps over the sampling step from which on stamps are too coarse to be the samples' times."""
_FEW = 3  # wide steps that any log may have lost samples in
_FEWEST = 16  # steps that can show a pattern


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


def check(
    stamps: np.ndarray,
    place: Callable[[int], str],
    *,
    split: bool,
    repeats: Callable[[np.ndarray], np.ndarray] | None = None,
    stamps_are: str = "auto",
) -> TimeAxis:
    """Find restarts, drop repeated rows, make coarse stamps even.

    Parameters
    ----------
    stamps : (n,) float [s]
        Finite.
    place : function of int to str
        Names a row of the table for the user (``line 12``, ``row 21``).
    split : bool
        Whether a step back begins another part (text logs of several specimens) or is an error.
    repeats : function of (m,) int to (m,) bool
        Which of these rows hold the same numbers as the row before; None where nobody can say.
    stamps_are : {"auto", "even", "logged"}
        As in ``ReadOptions.stamps``.

    Raises
    ------
    TimeProblem
        Time runs backwards and ``split`` is False, or stands still in many rows.
    """
    axis = TimeAxis(stamps)
    increasing = len(stamps) < 2 or bool((stamps[1:] > stamps[:-1]).all())
    if increasing and stamps_are == "logged":
        return axis
    if not increasing:
        axis.rows, axis.restarts = _in_order(stamps, place, split, axis.notes)
    kept = stamps if axis.rows is None else stamps[axis.rows]
    rows = np.arange(len(stamps)) if axis.rows is None else axis.rows
    edges = [0, *axis.restarts, len(kept)]
    times: list[np.ndarray] = []
    chosen: list[np.ndarray] = []
    restarts: list[int] = []
    for a, b in itertools.pairwise(edges):
        restarts.append(sum(len(part) for part in chosen))
        time, mine = _part(kept[a:b], rows[a:b], place, repeats, stamps_are, axis.notes)
        times.append(time)
        chosen.append(mine)
    if len(times) == 1 and times[0] is kept and axis.rows is None:
        return axis
    axis.time, axis.rows = np.concatenate(times), np.concatenate(chosen)
    axis.restarts = restarts[1:]
    if len(axis.rows) == len(stamps):
        axis.rows = None
    return axis


def _in_order(
    stamps: np.ndarray, place: Callable[[int], str], split: bool, notes: list[Note]
) -> tuple[np.ndarray, list[int]]:
    """Rows without damaged stamps, and where among them time steps back for good."""
    keep = np.ones(len(stamps), dtype=bool)
    restarts: list[int] = []
    backward = np.flatnonzero(np.diff(stamps) < 0) + 1
    if split and len(backward) > max(3, _RARE * len(stamps)):
        return _shuffled(stamps, backward, place, notes)
    damaged = []
    for row in backward.tolist():
        if row + 1 < len(stamps) and row > 1 and stamps[row - 2] < stamps[row - 1] < stamps[row + 1] and split:
            damaged.append(row)  # one stamp falls back and the next goes on as if nothing had been
        elif row + 1 < len(stamps) and row > 1 and stamps[row - 2] < stamps[row] < stamps[row + 1] and split:
            damaged.append(row - 1)  # one stamp jumps ahead, and time goes on below it
        elif split:
            restarts.append(row)
        else:
            raise TimeProblem(
                row,
                f"time decreases from {stamps[row - 1]:.6g} to {stamps[row]:.6g} s: two recordings in one table",
                "Keep one of them per file or sheet.",
            )
    if damaged:
        keep[damaged] = False
        notes.append(
            Note(
                "warning",
                f"{len(damaged)} row(s) with a stamp out of order left out: {stamps[damaged[0]]:.6g} s",
                place(damaged[0]),
            )
        )
    kept = np.flatnonzero(keep)
    for row in restarts:
        text = f"time steps back from {stamps[row - 1]:.6g} to {stamps[row]:.6g} s: another part begins"
        notes.append(Note("info", text, place(row)))
    return kept, [int(np.searchsorted(kept, row)) for row in restarts]


def _shuffled(
    stamps: np.ndarray, backward: np.ndarray, place: Callable[[int], str], notes: list[Note]
) -> tuple[np.ndarray, list[int]]:
    """Many small steps back are a clock that trembles, no parts: rows keep their order and the stamps become even."""
    count = len(stamps)
    even = np.polynomial.Polynomial.fit(np.arange(count), stamps, 1)(np.arange(count))
    slope = float(even[-1] - even[0]) / (count - 1)
    spread = float(np.abs(stamps - even).max())
    if slope <= 0 or spread > 20 * slope:
        row = int(backward[0])
        raise TimeProblem(
            row,
            f"time decreases {len(backward)} times, first from {stamps[row - 1]:.6g} to {stamps[row]:.6g} s",
            "Give --fs for samples at a known rate, or --columns time=… for another clock.",
        )
    return np.arange(count), []


def _part(
    stamps: np.ndarray,
    rows: np.ndarray,
    place: Callable[[int], str],
    repeats: Callable[[np.ndarray], np.ndarray] | None,
    stamps_are: str,
    notes: list[Note],
) -> tuple[np.ndarray, np.ndarray]:
    """One part: repeated rows left out, coarse stamps made even."""
    steps = np.diff(stamps)
    doubled = np.flatnonzero(steps == 0) + 1
    if len(doubled):
        few = len(doubled) <= max(1, _RARE * len(stamps))
        # a machine's first row often stands there twice, whatever it holds
        same = doubled if repeats is None else doubled[repeats(rows[doubled]) | (few & (doubled == 1))]
        if repeats is None and len(same) > max(1, _RARE * len(stamps)):
            raise TimeProblem(
                int(rows[doubled[0]]),
                f"time stands still in {len(doubled)} of {len(stamps)} rows: coarser than the sampling",
                "Give --fs.",
            )
        if len(same) and len(same) <= max(1, _RARE * len(stamps)):
            notes.append(
                Note(
                    "warning",
                    f"{len(same)} row(s) repeat the time of the row before, dropped (t = {stamps[same[0]]:.6g} s)",
                    place(int(rows[same[0]])),
                )
            )
            keep = np.ones(len(stamps), dtype=bool)
            keep[same] = False
            stamps, rows = stamps[keep], rows[keep]
            steps = np.diff(stamps)
    if len(stamps) < 3:
        if len(stamps) == 2 and stamps[1] <= stamps[0]:
            raise TimeProblem(int(rows[1]), f"time stands still at {stamps[1]:.6g} s", "Give --fs.")
        return stamps, rows
    if 0 < (steps == 0).sum() <= max(1, _RARE * len(stamps)) and stamps_are != "even":
        stamps = _between(stamps, np.flatnonzero(steps == 0) + 1, rows, place, notes)
        steps = np.diff(stamps)
    why = "as --stamps even says" if stamps_are == "even" else _why_even(stamps, steps)
    if why and (stamps_are != "logged" or bool((steps <= 0).any())):
        return _even(stamps, why, notes), rows
    if bool((steps <= 0).any()):
        row = int(np.flatnonzero(steps <= 0)[0]) + 1
        raise TimeProblem(int(rows[row]), f"time stands still at {stamps[row]:.6g} s", "Give --fs, or --stamps even.")
    return stamps, rows


def _between(
    stamps: np.ndarray, doubled: np.ndarray, rows: np.ndarray, place: Callable[[int], str], notes: list[Note]
) -> np.ndarray:
    """Samples that bear the stamp of the one before, halfway to the one behind."""
    following = np.r_[stamps[1:], 2 * stamps[-1] - stamps[-2]]
    moved = stamps.copy()
    moved[doubled] = 0.5 * (stamps[doubled - 1] + following[doubled])
    notes.append(
        Note(
            "warning",
            f"{len(doubled)} sample(s) bear the time of the one before (the first at {stamps[doubled[0]]:.6g} s); "
            "they are put halfway to the next",
            place(int(rows[doubled[0]])),
        )
    )
    return moved


def _line(stamps: np.ndarray) -> tuple[float, float, float]:
    """Start and step of the even grid nearest to the stamps, and how far they stand off it at most."""
    index = np.arange(len(stamps)) - (len(stamps) - 1) / 2
    step = float(index @ (stamps - stamps.mean()) / (index @ index))
    start = float(stamps.mean()) - step * (len(stamps) - 1) / 2
    return start, step, float(np.abs(stamps - start - step * np.arange(len(stamps))).max())


def _why_even(stamps: np.ndarray, steps: np.ndarray) -> str:
    """Why the stamps are not the samples' own times; empty when they may well be."""
    mean = float(stamps[-1] - stamps[0]) / len(steps)
    least = float(steps.min())
    if len(steps) < _FEWEST or mean <= 0 or float(steps.max()) - least <= 1e-6 * mean:
        return ""
    typical = float(np.median(steps[:: max(1, len(steps) // 10_000)]))
    wide = np.flatnonzero(steps > GAP_FACTOR * max(typical, 0.0) * (1 + TICK_FACTOR))
    still = int((steps <= 0).sum()) if least <= 0 else 0
    tick = _tick(steps if len(wide) > max(_FEW, _RARE * len(steps)) else np.delete(steps, wide), mean)
    coarse = tick > 0
    if len(wide) <= max(_FEW, _RARE * len(steps)) and not still and not coarse:
        return ""
    _, step, off = _line(stamps)
    if step <= 0 or (coarse and not still and len(wide) <= max(_FEW, _RARE * len(steps)) and off > 1.05 * tick):
        return ""
    between = np.diff(np.r_[0, wide + 1]) if len(wide) else np.array([1])
    burst = float(np.median(between))
    longest = float(between.max()) if len(wide) else float(np.diff(np.flatnonzero(np.r_[True, steps > 0, True])).max())
    if off > (max(longest, 2.0) + 1.0) * step or (longest > 4 * max(burst, 2.0) and not coarse):
        return ""
    if coarse and len(wide) <= max(_FEW, _RARE * len(steps)) and not still:
        return f"stamps are whole steps of {tick:.4g} s, too coarse for the sampling"
    if still:
        return f"{still} of {len(stamps)} stamps repeat the one before: the clock is coarser than the sampling"
    return (
        f"stamps come in bursts of {burst:.0f} (steps of {typical:.4g} s, then {float(np.median(steps[wide])):.4g} s)"
    )


def _tick(steps: np.ndarray, mean: float) -> float:
    """The unit in which stamps count, where it is coarse and their steps differ by whole ones; 0 otherwise."""
    some = np.sort(steps[:10_000])
    kinds = some[np.r_[True, np.diff(some) > 0.02 * mean]]  # steps that differ by more than printing rounds
    if not 1 < len(kinds) <= 12:
        return 0.0
    tick = float(np.diff(kinds).min())
    if kinds[0] > 0:
        tick = min(tick, float(kinds[0]))
    counts = kinds / tick if tick > 0 else kinds
    whole = bool((np.abs(counts - np.round(counts)) < 0.05).all())
    return tick if tick >= _COARSE * mean and whole else 0.0


def _even(stamps: np.ndarray, why: str, notes: list[Note]) -> np.ndarray:
    start, step, off = _line(stamps)
    if step <= 0:
        raise TimeProblem(0, "time does not rise", "Give --fs.")
    notes.append(
        Note(
            "warning",
            f"{why}; the samples are put on an even grid of {1 / step:.6g} Hz by regression over all stamps, which "
            f"stand up to {off:.3g} s off it. Whether the samples themselves are even the file cannot tell; "
            "--stamps logged keeps the stamps",
        )
    )
    return start + step * np.arange(len(stamps))


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
