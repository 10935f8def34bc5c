"""Readers against what they stand on, side by side in one run.

A workbook of 3 x 20,011 x 2 numbers: bare python-calamine to lists against a Recording (hash, checks, arrays).
A force log of a million rows, without a column of text and with one: pandas.read_csv with its C engine against a
Recording.

Run: python benchmarks/bench_readers.py [repeats]
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
from python_calamine import CalamineWorkbook

from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.readers import read_one
from ssmr_ident.readers.writers import write_labview_xlsx

SHEET_ROWS = 20_011
LOG_ROWS = 1_000_000


def make_workbook(path: Path) -> None:
    """Full double precision, as a graph export has it: longer cells than a rounded log."""
    noise = np.random.default_rng(1).standard_normal((3, SHEET_ROWS))
    channels = tuple(Channel(n, 2.6 + 0.3 * v, "V") for n, v in zip(("ax", "ay", "az"), noise, strict=True))
    recording = Recording(np.arange(SHEET_ROWS) * 1e-3, channels, Provenance("", "", "made"))
    write_labview_xlsx(path, recording, header="graph", decimals=15)


def make_log(path: Path, state: str = "") -> None:
    """Time, position and load as a testing machine prints them, and a word in every row where one is given."""
    rng = np.random.default_rng(2)
    load = np.cumsum(rng.standard_normal(LOG_ROWS)) * 0.05
    rows = zip(range(LOG_ROWS), load.tolist(), strict=True)
    named, word = (",state", f",{state}") if state else ("", "")
    lines = [f"Time (s){named},Position (mm),Load (N)"]
    lines += [f"{k * 1e-3:.3f}{word},{k * 5e-4:.4f},{f:.3f}" for k, f in rows]
    path.write_text("\n".join(lines) + "\n")


def bare_calamine(path: Path) -> list:
    book = CalamineWorkbook.from_path(path)
    return [book.get_sheet_by_name(name).to_python(skip_empty_area=False) for name in book.sheet_names]


def side_by_side(name: str, reference: Callable, ours: Callable, repeats: int, limit: float) -> bool:
    """Alternate the two, so that a busy machine slows both; compare medians."""
    reference(), ours()  # files into the cache, compiled code into memory
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(repeats):
        for work, spent in zip((reference, ours), times, strict=True):
            begin = time.perf_counter()
            work()
            spent.append(time.perf_counter() - begin)
    a, b = (statistics.median(spent) for spent in times)
    print(
        f"{name}: reference {a * 1e3:.0f} ms [{min(times[0]) * 1e3:.0f}-{max(times[0]) * 1e3:.0f}], "
        f"ours {b * 1e3:.0f} ms [{min(times[1]) * 1e3:.0f}-{max(times[1]) * 1e3:.0f}], "
        f"ratio {b / a:.2f} (at most {limit:g})"
    )
    return b / a <= limit


def main() -> int:
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 9
    with tempfile.TemporaryDirectory() as folder:
        book, log = Path(folder, "book.xlsx"), Path(folder, "log.csv")
        make_workbook(book)
        make_log(log)
        print(f"book {book.stat().st_size / 1e6:.2f} MB, log {log.stat().st_size / 1e6:.1f} MB, median of {repeats}")
        good = side_by_side(
            "workbook: calamine to lists / Recording",
            lambda: bare_calamine(book),
            lambda: read_one(book),
            repeats,
            1.3,
        )
        good &= side_by_side(
            "log: pandas.read_csv / Recording",
            lambda: pd.read_csv(log, engine="c"),
            lambda: read_one(log),
            repeats,
            1.0,
        )
        make_log(log, "run")
        good &= side_by_side(
            "log with a column of text: pandas.read_csv / Recording",
            lambda: pd.read_csv(log, engine="c"),
            lambda: read_one(log),
            repeats,
            1.5,
        )
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
