"""Rows beyond ``Samples`` in a log without X column: one long record, or several records below one header?

``Multi_Headings No`` lets LabVIEW write one header and append packet after packet of ``Samples`` rows. A running
acquisition makes them one record; a triggered one makes each packet a record of its own, and without an X column
no stamp tells. The rows tell: in one record the step over a packet's end is one step among its neighbours, so its
rank among n of them is uniform, p = 1/(n + 1) for the largest. Steps over the ends of all packets and channels are
put together (Bonferroni over channels, Fisher 1925 over packet ends); below p = 0.01 the packets are records.
With an X column nothing is split here: a restart of X says it, and rows count, whatever ``Samples`` says.
"""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.recording import Note
from ssmr_ident.readers.table.columns import Column

_NEIGHBOURS = 500  # steps on each side; p of the largest is 1/1001 then
_LEVEL = 0.01


def split(columns: list[Column], samples: int, rate: float) -> tuple[list[slice], list[Note]]:
    """Pieces of the rows that are records of their own.

    Parameters
    ----------
    columns : list of Column
        Without a time column.
    samples : int
        What the header says one packet has; 0 when it says nothing.
    rate : float [Hz]
        For the note only.
    """
    count = len(columns[0].values) if columns else 0
    whole = [slice(0, count)]
    if samples < 2 or count <= samples:
        return whole, []
    ends = range(samples, count, samples)
    chances = [_chance(columns, end, samples) for end in ends]
    together = _fisher(chances)
    evidence = f"the step over row {samples} is among its neighbours with p = {together:.2g}"
    if together >= _LEVEL:
        return whole, [Note("warning", f"{count} rows, Samples says {samples}; {evidence}: read as one record")]
    pieces = [slice(a, min(a + samples, count)) for a in range(0, count, samples)]
    if pieces[-1].stop - pieces[-1].start < 2:
        pieces.pop()
    seconds = f", {samples / rate:.4g} s each" if rate else ""
    return pieces, [
        Note(
            "warning",
            f"{count} rows below one header that says Samples {samples}: read as "
            f"{len(pieces)} records{seconds} ({evidence}); time begins anew in each",
        )
    ]


def _fisher(chances: list[float]) -> float:
    """Fisher's combined chance: of chi2 with an even count of degrees of freedom, which has a finite sum."""
    half = -sum(math.log(chance) for chance in chances)
    term = total = 1.0
    for k in range(1, len(chances)):
        term *= half / k
        total += term
    return min(1.0, math.exp(math.log(total) - half))


def _chance(columns: list[Column], end: int, samples: int) -> float:
    """Chance of so large a step over a packet's end, if it were a step like its neighbours."""
    reach = min(_NEIGHBOURS, samples - 1)
    best = 1.0
    used = 0
    for column in columns:
        steps = np.abs(np.diff(column.values[max(0, end - reach) : end + reach]))
        position = end - 1 - max(0, end - reach)
        if position >= len(steps) or not np.isfinite(steps[position]):
            continue
        used += 1
        others = np.delete(steps, position)
        larger = int((others >= steps[position]).sum())
        best = min(best, (larger + 1) / (len(others) + 1))
    return min(1.0, best * max(used, 1))


def rounded_step(printed: str, step: float) -> Note | None:
    """A note when a step was printed with so few digits that another, rounder rate prints the same."""
    mantissa, _, exponent = printed.strip().lower().replace(",", ".").partition("e")
    decimals = len(mantissa.partition(".")[2])
    half = 0.5 * 10.0 ** (-decimals + (int(exponent) if exponent.lstrip("+-").isdigit() else 0))
    if half >= step or abs(round(1 / step) * step - 1) < 1e-9:
        return None
    low, high = 1 / (step + half), 1 / (step - half)
    if high - low > 0.2 / step:
        return None
    rounder = _roundest(low, high)
    if rounder is None:
        return None
    return Note(
        "warning",
        f"Delta_X {printed.strip()} is rounded: 1/Delta_X = {1 / step:.6g} Hz is used, {rounder:g} Hz "
        f"prints the same (anything from {low:.6g} to {high:.6g} Hz does); --fs {rounder:g} takes that",
    )


def _roundest(low: float, high: float) -> float | None:
    """A power of two, or the integer with the fewest digits that are not zero."""
    power = 2.0 ** math.floor(math.log2(high))
    if power >= low:
        return power
    whole = range(math.ceil(low), min(math.floor(high), math.ceil(low) + 100_000) + 1)
    return float(min(whole, key=lambda n: (len(str(n).rstrip("0")), n))) if len(whole) else None
