"""Universal files, dataset 58, by pyuff (the extra ``uff``): what modal analysers exchange."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source, missing_library
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table, facts

NAMES = ("uff",)
_TIME = 17  # code of an abscissa of time
_RESPONSES = (0, 1)  # codes of a function of time: unknown, time response
_DIRECTIONS = {1: "+X", 2: "+Y", 3: "+Z", 4: "+RX", 5: "+RY", 6: "+RZ"}
_DIRECTIONS |= {-code: "-" + name[1:] for code, name in _DIRECTIONS.items()}
# Codes of ordinates: what is measured, its SI unit, and which factor of dataset 164 scales it
_ORDINATES = {
    8: ("Displacement", "m", "length"), 9: ("Force", "N", "force"), 11: ("Velocity", "m/s", "length"),
    12: ("Acceleration", "m/s^2", "length"), 13: ("Force", "N", "force"),
}  # fmt: skip


def recognises(source: Source) -> bool:
    """Text whose first line is the mark of a dataset."""
    lines = source.data[:200].split(b"\n", 2)
    return (
        source.kind == "text" and lines[0].rstrip() == b"    -1" and lines[1:2] != [] and lines[1].strip()[:1].isdigit()
    )


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """Recordings of a universal file: responses over time, one channel per node and direction.

    Raises
    ------
    InputError
        pyuff is not installed; the file is damaged, or holds no function of time.
    """
    try:
        import pyuff
    except ImportError as error:
        raise missing_library(source, "a universal file (UFF, dataset 58)", "pyuff", "uff") from error
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "log.uff")  # what was hashed is what is read
        copy.write_bytes(source.data)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                file = pyuff.UFF(str(copy))
                kinds = np.atleast_1d(file.get_set_types()).astype(int).tolist()
                sets = {k: file.read_sets(k) for k, kind in enumerate(kinds) if kind in (58, 164)}
        except Exception as error:  # pyuff reports damage by whatever its parsing stumbles over
            reason = f"{type(error).__name__}: {str(error)[:100]}"
            raise source.error(f"is a universal file that is damaged ({reason})", "Export it again.") from error
    scales: dict[str, Any] = next((one for one in sets.values() if one.get("type") == 164), {})
    records: list[list[Column]] = []
    left = 0
    for one in sets.values():
        if one.get("type") != 58:
            continue
        column = _column(one, scales)
        if column is None:
            left += 1
            continue
        # the same node and direction again is another record
        record = next((r for r in records if all(c.label != column.label for c in r)), None)
        if record is None:
            records.append([column])
        else:
            column.number = len(record)
            record.append(column)
    if not records:
        raise source.error(
            "is a universal file without responses over time", "Export dataset 58 with time as abscissa."
        )
    if left:
        source.inform(f"{left} function(s) that are no response over time left out")
    recordings: list[Recording] = []
    for number, record in enumerate(records, start=1):
        part = f"record {number} of {len(records)}" if len(records) > 1 else ""
        about = {str(k): str(v) for k, v in sets.items() if isinstance(v, str)}
        table = Table(record, lambda row: f"sample {row + 1}", part, facts(about))
        recordings += recordings_of(source, "uff", table, options)
    return recordings


def _column(one: dict[str, Any], scales: dict[str, Any]) -> Column | None:
    """A function of time as a column with its own start and step."""
    values = np.asarray(one.get("data", ()))
    if one.get("func_type") not in _RESPONSES or one.get("abscissa_spec_data_type") not in (_TIME, 0):
        return None
    if values.ndim != 1 or values.dtype.kind not in "fiu" or len(values) < 2:
        return None
    step = float(one.get("abscissa_inc") or 0.0)
    times = np.asarray(one.get("x", ()), dtype=float)
    if not one.get("abscissa_spacing", 1) and len(times) == len(values):
        step = float(times[-1] - times[0]) / (len(times) - 1)
    if not 0 < step < float("inf"):
        return None
    code = int(one.get("ordinate_spec_data_type") or 0)
    name, unit, factor = _ORDINATES.get(code, ("", "", ""))
    written = _said(one.get("ordinate_axis_units_lab"))
    label = _said(one.get("ordinate_axis_lab")) or name or "response"
    direction = _DIRECTIONS.get(int(one.get("rsp_dir") or 0), "")
    values = values.astype(float)
    if not written and unit and scales.get(factor):
        values = values / float(scales[factor])  # dataset 164: SI times the factor is what stands in the file
        written = unit
    place = f"{one.get('rsp_node')}:{direction}" if direction else f"{one.get('rsp_node')}"
    return Column(f"{label} {place}", written or None, values, start=float(one.get("abscissa_min") or 0.0), step=step)


def _said(text: Any) -> str:
    said = str(text or "").strip()
    return "" if said.upper() == "NONE" else said
