"""Every format sample and every malformed one, against values and messages that were written down by hand.

Good samples are read a second time here by something else: a five-line split for text, openpyxl, lvmio, npTDMS.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import openpyxl
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import ReadOptions, read

SAMPLES = Path(__file__).resolve().parents[3] / "shared" / "spec" / "format-samples"
pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not SAMPLES.is_dir(), reason="no format samples beside the checkout"),
]


@dataclass(frozen=True)
class Layout:
    """Where the numbers of a text sample stand, as a person sees it in an editor."""

    reader: str
    skip: int
    channels: dict[str, tuple[int, float, str]]  # name -> column, factor to SI, unit
    delimiter: str = "\t"
    decimal: str = "."
    encoding: str = "ascii"
    rows: int | None = None
    time: int | float | None = 0  # column, or the step when there is none
    labels: tuple[str, ...] = ()
    record: int = 0
    records: int = 1
    offset: dict[str, float] = field(default_factory=dict)


XYZ = {"ax": (1, 1, "V"), "ay": (2, 1, "V"), "az": (3, 1, "V")}
UTM = {"position": (1, 1e-3, "m"), "force": (2, 1, "N")}
VOLTAGE = {"Voltage_0": (1, 1, "V")}
PLOT = "Amplitude - Plot 0"
TEXTS = {
    "graph_export_plot0.csv": [Layout("csv", 1, {PLOT: (1, 1, "V")}, ",")],
    "graph_export_two_plots.txt": [Layout("csv", 1, {PLOT: (1, 1, "V"), "Amplitude - Plot 1": (3, 1, "V")})],
    "graph_export_voltage_semicolon_comma.csv": [
        Layout("csv", 1, {"Amplitude - Voltage_1": (1, 1, "V")}, ";", ",")
    ],
    "instron_bluehill2_pl_cp1250.csv": [
        Layout("mtestquattro", 5, UTM, ";", ",", "cp1250", labels=("Przemieszczenie", "Obciążenie"))
    ],
    "instron_bluehill3.csv": [
        Layout("mtestquattro", 9, {**UTM, "strain": (3, 1, "1")}, ",", labels=("Extension", "Load", "Strain 1"))
    ],
    "lvm_comma_separator.lvm": [Layout("lvm", 23, {**VOLTAGE, "Voltage_1": (2, 1, "V")}, ",")],
    "lvm_cp1252_degree.lvm": [
        Layout("lvm", 23, {"Temp": (1, 1, "K")}, encoding="cp1252", offset={"Temp": 273.15})
    ],
    "lvm_headerless.lvm": [Layout("csv", 0, {"column 2": (1, 1, "V")})],
    "lvm_multi_x.lvm": [Layout("lvm", 23, {"ax": (1, 1, "V"), "ay": (3, 1, "V"), "az": (5, 1, "V")})],
    "lvm_no_x_decimal_comma.lvm": [
        Layout("lvm", 23, {**VOLTAGE, "Voltage_1": (2, 1, "V")}, decimal=",", time=0.001)
    ],
    "lvm_notes_comment.lvm": [Layout("lvm", 24, VOLTAGE)],
    "lvm_one_x_tab.lvm": [Layout("lvm", 23, XYZ, labels=("Voltage_0", "Voltage_1", "Voltage_2"))],
    "lvm_special_block.lvm": [Layout("lvm", 28, VOLTAGE)],
    "lvm_two_segments.lvm": [
        Layout("lvm", 23, VOLTAGE, rows=5, records=2),
        Layout("lvm", 39, VOLTAGE, rows=5, record=1, records=2),
    ],
    "lvm_utf16_bom.lvm": [Layout("lvm", 23, VOLTAGE, encoding="utf-16")],
    "lvm_v092_no_decimal_line.lvm": [Layout("lvm", 22, VOLTAGE)],
    "mtestquattro_guess_comma.csv": [Layout("mtestquattro", 7, UTM, ",", labels=("Position", "Load"))],
    "mtestquattro_guess_two_samples.csv": [
        Layout("mtestquattro", 2, UTM, ",", rows=4, records=2),
        Layout("mtestquattro", 9, UTM, ",", rows=4, record=1, records=2),
    ],
    "mtestquattro_guess_unitsrow.txt": [
        Layout("mtestquattro", 2, {"position": (1, 0.0254, "m"), "force": (2, 4.4482216152605, "N")})
    ],
    "mts_testsuite_timed.csv": [
        Layout("mtestquattro", 8, {"position": (0, 1e-3, "m"), "force": (1, 1e3, "N")}, ",", time=2)
    ],
    "waveform_spreadsheet_export.txt": [Layout("csv", 5, {"Y[0]": (1, 1, "V"), "Y[1]": (3, 1, "V")})],
    "zwick_testxpert_de.txt": [Layout("mtestquattro", 3, UTM, ";", ",", "cp1252")],
}  # fmt: skip


def by_eye(path: Path, layout: Layout) -> list[list[str]]:
    lines = path.read_bytes().decode(layout.encoding).replace("\r\n", "\n").split("\n")[layout.skip :]
    rows = [line.replace('"', "").split(layout.delimiter) for line in lines if line.strip()]
    return rows[: layout.rows]


@pytest.mark.parametrize(("name", "layout"), [(n, x) for n, layouts in TEXTS.items() for x in layouts])
def test_text_sample_holds_these_values(name: str, layout: Layout) -> None:
    recordings = read(SAMPLES / name)
    assert len(recordings) == layout.records
    recording = recordings[layout.record]
    rows = by_eye(SAMPLES / name, layout)

    def column(index: int) -> np.ndarray:
        return np.array([float(row[index].replace(layout.decimal, ".")) for row in rows])

    assert recording.provenance.reader == layout.reader
    assert recording.names == tuple(layout.channels)
    expected_time = np.arange(len(rows)) * layout.time if isinstance(layout.time, float) else column(layout.time)
    np.testing.assert_allclose(recording.time, expected_time, rtol=0, atol=1e-12)
    for channel, (index, factor, unit) in layout.channels.items():
        assert recording.channel(channel).unit == unit
        expected = column(index) * factor + layout.offset.get(channel, 0.0)
        np.testing.assert_allclose(recording[channel], expected, rtol=1e-15, atol=0)
    if layout.labels:
        assert tuple(channel.label for channel in recording.channels) == layout.labels


def test_bluehill_universal_by_hand() -> None:
    (recording,) = read(SAMPLES / "instron_bluehill_universal.csv")
    force = [1000.2, 1012.7, 1025.2, 1037.7, 1050.2, 1062.7, 1075.2, 1087.7, 1100.2, 1112.7]
    np.testing.assert_array_equal(recording["force"], force)
    np.testing.assert_allclose(recording["position"], np.arange(10) * 5e-5, atol=1e-18)
    assert recording.header["Sample : Operator name"] == "lab"
    assert any("results, not data" in note.text for note in recording.notes)


def test_mtwdata_by_hand() -> None:
    (recording,) = read(SAMPLES / "mtestquattro.mtwData")
    np.testing.assert_allclose(recording.time, np.arange(10) * 0.1, atol=1e-15)
    np.testing.assert_allclose(recording["position"], np.arange(10) * 5e-5, atol=1e-18)
    np.testing.assert_allclose(recording["force"], 0.2 + 12.5 * np.arange(10), rtol=1e-14)
    assert any("LOAD × 10" in note.text for note in recording.warnings)
    (scaled,) = read(SAMPLES / "mtestquattro.mtwData", ReadOptions(load_scale=1.0))
    np.testing.assert_allclose(scaled["force"], recording["force"] / 10, rtol=1e-14)
    assert not scaled.warnings


WORKBOOKS = {
    "lvm_opened_in_excel.xlsx": 24,
    "numbers_as_text_decimal_comma.xlsx": 2,
    "v0-w180-t20-OnFrame-carpet.xlsx": 1,
    "v0-w45-t20-OnWheel-noFrame-concrete.xlsx": 2,
    "v0-w90-t20-OnWheel-noFrame-concrete.xlsx": 11,
}


def check_workbook(path: Path, first_row: int, **options: object) -> None:
    """Against openpyxl: sheet 3 is x, 2 is y, 1 is z, the data begin at ``first_row``."""
    (recording,) = read(path, ReadOptions(**options))  # type: ignore[arg-type]
    book = openpyxl.load_workbook(path)
    for axis, sheet in zip(("az", "ay", "ax"), book.worksheets, strict=True):
        cells = [[float(str(c.value).replace(",", ".")) for c in row[:2]] for row in sheet.iter_rows(min_row=first_row)]
        np.testing.assert_array_equal(recording.time, [row[0] for row in cells])
        np.testing.assert_array_equal(recording[axis], [row[1] for row in cells])
        assert recording.channel(axis).unit == "V"
    assert recording.provenance.reader == "labview-xlsx"
    shown = [note for note in recording.notes if "first sample is row" in note.text]
    assert len(shown) == 3
    assert all(f"row {first_row}," in note.text and "t = 0 s" in note.text for note in shown)


@pytest.mark.parametrize(("name", "first_row"), WORKBOOKS.items())
def test_workbook_sample_agrees_with_openpyxl(name: str, first_row: int) -> None:
    check_workbook(SAMPLES / name, first_row)


def test_thesis_skip_of_ten_loses_ten_samples_only_without_a_header() -> None:
    (bare,) = read(SAMPLES / "v0-w180-t20-OnFrame-carpet.xlsx", ReadOptions(skip=10))
    (segment,) = read(SAMPLES / "v0-w90-t20-OnWheel-noFrame-concrete.xlsx", ReadOptions(skip=10))
    assert bare.time[0] == 0.010
    assert segment.time[0] == 0.0


def test_tdms_sample_agrees_with_nptdms() -> None:
    nptdms = pytest.importorskip("nptdms")
    (recording,) = read(SAMPLES / "accel.tdms")
    channels = nptdms.TdmsFile.read(SAMPLES / "accel.tdms")["Untitled"].channels()
    np.testing.assert_allclose(recording.time, channels[0].time_track(), atol=1e-15)
    for axis, channel in zip(("ax", "ay", "az"), channels, strict=True):
        np.testing.assert_array_equal(recording[axis], channel[:])
        assert recording.channel(axis).label == channel.name


@pytest.mark.parametrize("name", sorted(n for n in TEXTS if n.endswith(".lvm")))
def test_lvm_sample_agrees_with_lvmio(name: str) -> None:
    lvmio = pytest.importorskip("lvmio")
    try:
        segments = lvmio.read_lvm(SAMPLES / name).segments
    except lvmio.LvmError:
        assert name in (
            "lvm_headerless.lvm",
            "lvm_special_block.lvm",
            "lvm_utf16_bom.lvm",
        )  # lvmio takes none of them
        return
    recordings = read(SAMPLES / name)
    assert len(recordings) == len(segments)
    for recording, segment in zip(recordings, segments, strict=True):
        for channel, theirs in zip(recording.channels, segment.channels, strict=True):
            kelvin = 273.15 if channel.unit == "K" else 0.0
            np.testing.assert_array_equal(channel.samples, np.array(theirs.data) + kelvin)
        np.testing.assert_allclose(recording.time, segment.channels[0].time_axis(), atol=1e-12)


def test_no_good_sample_is_left_out() -> None:
    known = {*TEXTS, *WORKBOOKS, "instron_bluehill_universal.csv", "mtestquattro.mtwData", "accel.tdms"}
    assert known == {path.name for path in SAMPLES.iterdir() if path.is_file()}
    assert len(known) == 30


# What section D of the format notes asks: words of the error; or words of a warning or note with the right data.
ERRORS = {
    "01": "file is empty (0 bytes)", "02": "damaged or incompletely copied (zip directory missing)",
    "04": "is an HTML page, not a log", "05": "password-protected workbook or an old .xls",
    "06": "Excel's lock file", "07": "git lfs pull", "08": "3 worksheets needed (z,y,x), found 2: z, y",
    "10": "sheet z (axis z) has no numbers", "13": "time column missing in sheet z (axis z). Give --fs 1000",
    "14": "no data below the header", "15": "only 10 numeric rows; 11:end would be empty",
    "16": "z:A16: text 'overflow' inside the data. Mend the cell, or keep a gap with --on-bad nan",
    "17": "z:B16: blank cell B16 (1 gap at t = 0.015 s)", "18": "z:B16: Excel error #DIV/0! in B16",
    "19": "formulas were never calculated", "23": "workbook part sharedStrings.xml missing",
    "24": "sheet Sheet1 is damaged", "25": "is a zip, but not a workbook",
    "29": "z, row 21: time decreases", "30": "5 samples missing after t = 0.011 s", "31": "volts outside 0…5 V",
    "32": "dt = 1 s, expected 0.001 s", "33": "x 30, y 25, z 30 samples", "34": "Sheet1:B20: nan in a numeric",
    "41": "header end not found", "44": "line 27: row has 8 cells, 4 are expected",
    "46": "ambiguous: comma as separator and as decimal sign", "48": "file is empty",
    "52": "line 14: Channels is not an integer", "61": "is not a TDMS file", "62": "git lfs pull",
    "63": "no channels", "64": "Open the .tdms file beside it", "65": "byte 1293: garbage between segments",
}  # fmt: skip
PLAIN_SHEET = (30, 0.001, 2.6, 2.89)  # samples, step, first and last volts: all made sheets rise by 10 mV
LVM_SAMPLE = (12, 0.001, 2.639031, 2.597994)
READABLE = {
    "03": ("warning", "content is text, not a workbook", (8, 0.001, 2.639031, 2.644548)),
    "09": ("info", "sheet Notes is ignored", PLAIN_SHEET),
    "11": ("info", "Chart1 is no worksheet", PLAIN_SHEET),
    "12": ("warning", "sheet hid is hidden and was ignored", PLAIN_SHEET),
    "20": ("", "", (40, 0.001, 2.639030559210616, 2.56802206839481)),
    "21": ("", "", (40, 0.001, 2.639030559210616, 2.56802206839481)),
    "22": ("", "", (40, 0.001, 2.639030559210616, 2.56802206839481)),
    "26": ("", "", (40, 0.001, 2.639030559210616, 2.56802206839481)),
    "27": ("info", "became seconds since the first sample", PLAIN_SHEET),
    "28": ("info", "first sample is row 4", PLAIN_SHEET),
    "35": ("warning", "content is an .xlsx workbook", (40, 0.001, 2.639030559210616, 2.56802206839481)),
    "40": ("warning", "the last row is cut off and was dropped", (11, 0.001, 2.639031, 2.610442)),
    "42": ("warning", "512 NUL bytes at the end dropped", LVM_SAMPLE),
    "43": ("warning", "Samples says 99, the file holds 12 rows", LVM_SAMPLE),
    "45": ("warning", "decimal comma found, though no Decimal_Separator is declared", LVM_SAMPLE),
    "47": ("warning", "1 value(s) of Voltage_0 are no number", LVM_SAMPLE),
    "49": ("info", "a second file header", LVM_SAMPLE),
    "50": ("", "", LVM_SAMPLE),
    "51": ("warning", "Separator is empty; tab used", LVM_SAMPLE),
    "53": ("warning", "Separator says Tab, the rows are separated by ';'", LVM_SAMPLE),
    "60": ("warning", "the last segment is incomplete", (15, 0.001, 2.6390305592106156, None)),
}  # fmt: skip
BAD = sorted((SAMPLES / "bad").iterdir()) if SAMPLES.is_dir() else []


def test_every_malformed_sample_has_its_line() -> None:
    assert len(BAD) == 55
    assert {path.name[:2] for path in BAD} == set(ERRORS) | set(READABLE)


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.name)
def test_malformed_sample(path: Path, caplog: pytest.LogCaptureFixture) -> None:
    number = path.name[:2]
    if number in ERRORS:
        with pytest.raises(InputError) as caught:
            read(path)
        assert ERRORS[number] in str(caught.value)
        assert caught.value.where.startswith(str(path))
        assert caught.value.mend
        assert "\n" not in str(caught.value)
        return
    level, words, (samples, step, first, last) = READABLE[number]
    with caplog.at_level(logging.WARNING):
        recordings = read(path)
    assert not caplog.records
    assert len(recordings) == (2 if number == "49" else 1)
    for recording in recordings:
        assert len(recording.time) == samples
        np.testing.assert_allclose(recording.time, np.arange(samples) * step, atol=1e-12)
        x = recording.channels[0].samples
        assert x[0] == first
        assert last is None or x[-1] == last
        assert np.isnan(x).sum() == (1 if number == "47" else 0)
        if number == "03":
            assert recording.names == (PLOT,)
        else:
            assert recording.names == ("ax", "ay", "az")
            assert len({channel.samples.tobytes() for channel in recording.channels}) in (1, 3)
    if words:
        assert any(words in note.text for r in recordings for note in r.notes if level == note.level)


@pytest.mark.parametrize(
    ("number", "options", "samples"),
    [
        ("13", {"fs": 1000.0}, 30), ("15", {"skip": 0, "trim": True}, 10), ("16", {"on_bad": "nan"}, 30),
        ("17", {"on_bad": "nan"}, 30), ("18", {"on_bad": "nan"}, 30), ("30", {"trim": True}, 25),
        ("31", {"units": {"az": "mV"}}, 30), ("33", {"trim": True}, 25), ("34", {"on_bad": "nan"}, 40),
        ("32", {"fs": 1000.0}, 30), ("08", {"sheets": {"z": 1, "y": 2}}, 30),
        ("09", {"sheets": {"x": 4, "y": "y", "z": 2}}, 30),
    ],
)  # fmt: skip
def test_the_mend_works(number: str, options: dict, samples: int) -> None:
    path = next(path for path in BAD if path.name.startswith(number))
    (recording,) = read(path, ReadOptions(**options))
    assert len(recording.time) == samples
    gaps = 1 if number in ("17", "18", "34") else 0
    assert sum(int(np.isnan(c.samples).sum()) for c in recording.channels) == gaps
    if number == "31":
        np.testing.assert_allclose(recording["az"], 2.6 + 0.01 * np.arange(30), rtol=1e-12)
