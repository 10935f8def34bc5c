"""LabVIEW measurement files, version 2, as the Express VI writes them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ssmr_ident.core.atomic import write_bytes
from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.writers.printing import fixed

_UNIT_LABELS = {"V": "Volts"}


def write_lvm(
    path: str | Path,
    recording: Recording,
    *,
    decimals: int = 6,
    decimal: str = ".",
    date: str = "2012/05/10",
    clock: str = "14:03:11.1234567890123456789",
    operator: str = "",
) -> Path:
    """Write one segment with one X column.

    Parameters
    ----------
    path : str or Path
    recording : Recording
        Channels are named by their labels.
    decimals : int
        LabVIEW's own default is 6.
    decimal : {".", ","}
    date, clock : str
        Fixed, so that the same recording gives the same bytes.
    """
    count = len(recording.channels)
    step = float(np.median(np.diff(recording.time))) if len(recording.time) > 1 else 0.0
    begin = float(recording.time[0]) if len(recording.time) else 0.0

    def row(tag: str, value: str) -> str:
        return "\t".join([tag, *[value] * count, ""])

    units = "\t".join(["Y_Unit_Label", *[_UNIT_LABELS.get(c.unit, c.unit) for c in recording.channels], ""])
    lines = [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Reader_Version\t2",
        "Separator\tTab",
        f"Decimal_Separator\t{decimal}",
        "Multi_Headings\tNo",
        "X_Columns\tOne",
        "Time_Pref\tRelative",
        f"Operator\t{operator}",
        f"Date\t{date}",
        f"Time\t{clock}",
        "***End_of_Header***\t",
        "\t",
        f"Channels\t{count}" + "\t" * count,
        row("Samples", str(len(recording.time))),
        row("Date", date),
        row("Time", clock),
        units,
        row("X_Dimension", "Time"),
        row("X0", f"{begin:.16E}".replace(".", decimal)),
        row("Delta_X", f"{step:.6f}".replace(".", decimal)),
        "***End_of_Header***" + "\t" * (count + 1),
        "\t".join(["X_Value", *[c.label or c.name for c in recording.channels], "Comment"]),
    ]
    time_decimals = max(decimals, 6)
    columns = [
        fixed(recording.time, time_decimals, decimal),
        *(fixed(channel.samples, decimals, decimal) for channel in recording.channels),
    ]
    lines += ["\t".join(cells) for cells in zip(*columns, strict=True)]
    return write_bytes(path, ("\r\n".join(lines) + "\r\n").encode("cp1252", errors="replace"))
