"""The thesis' workbook: three sheets z, y, x of time and volts, byte for byte the same for the same recording.

Written as the few parts that Office Open XML (ISO/IEC 29500) asks for, with fixed dates: libraries put the clock
into a workbook, and then the same seed gives another SHA-256 every time.
"""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np

from ssmr_ident.core.atomic import write_bytes
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording

_ORDER = ("az", "ay", "ax")  # the sheets' order, see readers/labview_xlsx.py
_EPOCH = (1980, 1, 1, 0, 0, 0)
_MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_RELATIONS = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_XML = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'


def write_labview_xlsx(
    path: str | Path,
    recording: Recording,
    *,
    header: str = "graph",
    decimals: int = 6,
    sheet_names: tuple[str, str, str] = ("Sheet1", "Sheet2", "Sheet3"),
    date: str = "2012/05/10",
    clock: str = "14:03:11.12",
) -> Path:
    """Write three axes in volts.

    Parameters
    ----------
    path : str or Path
    recording : Recording
        With channels ``ax``, ``ay``, ``az`` [V].
    header : {"graph", "segment", "none"}
        ``graph``: the text row of LabVIEW's graph export. ``segment``: the ten rows of an LVM segment header,
        which make the thesis' ``11:end`` begin at t = 0. ``none``: numbers from A1 on.
    decimals : int
        Values are rounded to this many decimals, as a log prints them.
    sheet_names : tuple of str
        For z, y, x in this order.

    Raises
    ------
    InputError
        When an axis is missing or not in volts.
    """
    for name in _ORDER:
        if name not in recording or recording.channel(name).unit != "V":
            raise InputError(
                str(path),
                f"a LabVIEW workbook holds ax, ay, az in volts; {name} is not among them",
                f"The recording has {', '.join(f'{c.name} [{c.unit}]' for c in recording.channels)}.",
            )
    if header not in ("graph", "segment", "none"):
        raise ValueError(f"header must be 'graph', 'segment' or 'none'. Got {header!r} instead.")
    parts = _frame(sheet_names)
    for number, name in enumerate(_ORDER, start=1):
        rows = _header_rows(header, recording, name, date, clock)
        parts[f"xl/worksheets/sheet{number}.xml"] = _sheet(rows, recording.time, recording[name], decimals)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for part, text in parts.items():
            entry = zipfile.ZipInfo(part, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o600 << 16
            archive.writestr(entry, text, compresslevel=6)
    return write_bytes(path, buffer.getvalue())


def _header_rows(header: str, recording: Recording, name: str, date: str, clock: str) -> list[list[str | float]]:
    if header == "none":
        return []
    if header == "graph":
        return [["Time - Plot 0", "Amplitude - Plot 0"]]
    step = float(np.median(np.diff(recording.time))) if len(recording.time) > 1 else 0.0
    return [
        ["Channels", 1.0],
        ["Samples", float(len(recording.time))],
        ["Date", date],
        ["Time", clock],
        ["Y_Unit_Label", "Volts"],
        ["X_Dimension", "Time"],
        ["X0", float(recording.time[0])],
        ["Delta_X", step],
        ["***End_of_Header***"],
        ["X_Value", recording.channel(name).label or name, "Comment"],
    ]


def _cell(column: int, row: int, value: str | float) -> str:
    reference = f"{chr(65 + column)}{row}"
    if isinstance(value, str):
        return f'<c r="{reference}" t="inlineStr"><is><t>{escape(value)}</t></is></c>'
    return f'<c r="{reference}"><v>{value!r}</v></c>' if np.isfinite(value) else ""


def _sheet(header: list[list[str | float]], time: np.ndarray, volts: np.ndarray, decimals: int) -> str:
    lines = [f'{_XML}<worksheet xmlns="{_MAIN}"><sheetData>']
    for row, cells in enumerate(header, start=1):
        lines.append(f'<row r="{row}">' + "".join(_cell(i, row, cell) for i, cell in enumerate(cells)) + "</row>")
    rounded_time = np.round(time, 9).tolist()
    rounded = np.round(volts, decimals).tolist()
    for row, (t, v) in enumerate(zip(rounded_time, rounded, strict=True), start=len(header) + 1):
        lines.append(f'<row r="{row}">{_cell(0, row, t)}{_cell(1, row, v)}</row>')
    lines.append("</sheetData></worksheet>")
    return "".join(lines)


def _frame(names: tuple[str, str, str]) -> dict[str, str]:
    """The parts of a workbook around its sheets."""
    sheets = "".join(
        f'<sheet name="{escape(n, {chr(34): "&quot;"})}" sheetId="{i}" r:id="rId{i}"/>'
        for i, n in enumerate(names, start=1)
    )
    relations = "".join(
        f'<Relationship Id="rId{i}" Type="{_RELATIONS}/worksheet" Target="worksheets/sheet{i}.xml"/>' for i in (1, 2, 3)
    )
    content = "application/vnd.openxmlformats-officedocument.spreadsheetml."
    overrides = f'<Override PartName="/xl/workbook.xml" ContentType="{content}sheet.main+xml"/>' + "".join(
        f'<Override PartName="/xl/worksheets/sheet{i}.xml" ContentType="{content}worksheet+xml"/>' for i in (1, 2, 3)
    )
    overrides += f'<Override PartName="/xl/styles.xml" ContentType="{content}styles+xml"/>'
    relations += f'<Relationship Id="rId4" Type="{_RELATIONS}/styles" Target="styles.xml"/>'
    return {
        "[Content_Types].xml": f'{_XML}<Types xmlns="{_PACKAGE}/content-types"><Default Extension="rels" '
        f'ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="xml" '
        f'ContentType="application/xml"/>{overrides}</Types>',
        "_rels/.rels": f"{_XML}"
        f'<Relationships xmlns="{_PACKAGE}/relationships"><Relationship Id="rId1" Type='
        f'"{_RELATIONS}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f"{_XML}"
        f'<workbook xmlns="{_MAIN}" xmlns:r="{_RELATIONS}"><sheets>{sheets}</sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f"{_XML}"
        f'<Relationships xmlns="{_PACKAGE}/relationships">{relations}</Relationships>',
        "xl/styles.xml": f"{_XML}"
        f'<styleSheet xmlns="{_MAIN}"><fonts count="1"><font/></fonts><fills count="2"><fill>'
        '<patternFill patternType="none"/></fill><fill><patternFill patternType="gray125"/></fill></fills>'
        '<borders count="1"><border/></borders><cellStyleXfs count="1"><xf/></cellStyleXfs><cellXfs count="1">'
        '<xf/></cellXfs><cellStyles count="1"><cellStyle name="Normal" xfId="0" builtinId="0"/></cellStyles>'
        "</styleSheet>",
    }
