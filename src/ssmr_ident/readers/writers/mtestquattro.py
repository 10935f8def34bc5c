"""Text like a testing machine's: time, position and load, with a row of units or units in the header."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ssmr_ident.core.atomic import write_bytes
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording
from ssmr_ident.core.units import find_unit
from ssmr_ident.readers.writers.printing import fixed

_HEADINGS = {"position": "Position", "force": "Load"}


def write_mtestquattro(
    path: str | Path,
    recording: Recording,
    *,
    style: str = "tab",
    position_unit: str = "mm",
    load_unit: str = "N",
    decimals: tuple[int, int, int] = (3, 4, 3),
    facts: Mapping[str, str] | None = None,
) -> Path:
    """Write position and force over time.

    Parameters
    ----------
    path : str or Path
    recording : Recording
        With channels ``position`` [m] and ``force`` [N].
    style : {"tab", "csv"}
        ``tab``: names row and units row, tab separated. ``csv``: facts above, units in the header, commas.
    position_unit, load_unit : str
    decimals : (int, int, int)
        Of time, position and load.
    facts : mapping or None
        Rows above a ``csv`` table, such as ``{"Procedure": "Rolling force"}``.

    Raises
    ------
    InputError
        When a channel or a unit is missing.
    """
    scales = {}
    for name, unit, si in (("position", position_unit, "m"), ("force", load_unit, "N")):
        conversion = find_unit(unit)
        if name not in recording or conversion is None or conversion.unit != si:
            raise InputError(
                str(path),
                f"a testing machine's log needs {name} in a unit of {si}",
                f"The recording has {', '.join(recording.names)}.",
            )
        scales[name] = conversion.factor
    columns = [
        fixed(recording.time, decimals[0]),
        fixed(recording["position"] / scales["position"], decimals[1]),
        fixed(recording["force"] / scales["force"], decimals[2]),
    ]
    if style == "tab":
        head, mark = ["Time\tPosition\tLoad", f"s\t{position_unit}\t{load_unit}"], "\t"
    elif style == "csv":
        rows = [f"{key},{value}" for key, value in (facts or {}).items()]
        head = [*rows, *([""] if rows else []), f"Time (s),Position ({position_unit}),Load ({load_unit})"]
        mark = ","
    else:
        raise ValueError(f"style must be 'tab' or 'csv'. Got {style!r} instead.")
    lines = head + [mark.join(cells) for cells in zip(*columns, strict=True)]
    return write_bytes(path, ("\r\n".join(lines) + "\r\n").encode())
