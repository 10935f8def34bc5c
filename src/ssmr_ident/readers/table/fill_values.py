"""Numbers that stand for no number: loggers and exports write -9999 or 9.9E37 where nothing was measured."""

from __future__ import annotations

import numpy as np

from ssmr_ident.readers.table.columns import Column, Table

_FILLS = np.array([-999.0, -999.25, -9999.0, -99999.0, -999999.0, 9999.0, 99999.0, 999999.0, -32768.0, 32767.0,
                   1e30, -1e30, 9.9e37, 9.91e37, 9.969209968386869e36])  # fmt: skip
"""By convention: rows of nines, the ends of 16 bits, LabVIEW's and netCDF's blanks, an instrument's overload."""
_FAR = 3.0
"""Choice: how many times the range of all others a fill value stands away from them; a measured number is nearer."""


def without_fill_values(columns: list[Column], table: Table) -> None:
    """Put NaN where such a number stands far from all others, and say so."""
    for column in columns:
        if column.clock or column.quantity in ("time", "date"):
            continue
        for extreme in _extremes(column.values):
            if not np.isclose(_FILLS, extreme, rtol=1e-6, atol=0).any():
                continue
            fills = column.values == extreme
            others = column.values[~fills & np.isfinite(column.values)]
            if len(others) < 2 or fills.sum() > len(others):
                continue
            low, high = float(others.min()), float(others.max())
            if high > low and min(abs(extreme - low), abs(extreme - high)) > _FAR * (high - low):
                column.values = np.where(fills, np.nan, column.values)
                table.warn(
                    f"{int(fills.sum())} value(s) of {column.shown} are {extreme:g}, far from all others "
                    f"({low:.4g} to {high:.4g}): taken as no number"
                )


def _extremes(values: np.ndarray) -> tuple[float, ...]:
    if not len(values):
        return ()
    low, high = float(values.min()), float(values.max())
    if not (np.isfinite(low) and np.isfinite(high)):
        finite = values[np.isfinite(values)]
        return (float(finite.min()), float(finite.max())) if len(finite) else ()
    return low, high
