"""Plain CSV: ``time [s],force [N],…``."""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.core.atomic import write_bytes
from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.writers.printing import fixed, shortest


def write_csv(path: str | Path, recording: Recording, *, decimals: int | None = None) -> Path:
    """Write time and channels in SI, one row per sample.

    Parameters
    ----------
    path : str or Path
    recording : Recording
    decimals : int or None
        Count of decimals; None prints what reads back to the same double.
    """
    header = ["time [s]"] + [
        f"{_quoted(c.label or c.name)} [{c.unit}]" if c.unit else _quoted(c.label or c.name) for c in recording.channels
    ]
    columns = [recording.time, *(channel.samples for channel in recording.channels)]
    texts = [shortest(column) if decimals is None else fixed(column, decimals) for column in columns]
    lines = [",".join(header), *(",".join(row) for row in zip(*texts, strict=True))]
    return write_bytes(path, ("\n".join(lines) + "\n").encode())


def _quoted(label: str) -> str:
    """A label in one cell: a comma would begin another one."""
    return label.replace(",", " ").replace('"', "'").replace("\n", " ")
