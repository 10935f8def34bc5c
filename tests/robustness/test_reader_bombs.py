"""Files made to hurt: they are refused in one line, soon, and without being unpacked."""

from __future__ import annotations

import io
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.readers import read
from ssmr_ident.readers.writers import write_labview_xlsx
from ssmr_ident.readers.xlsx import zip_safety
from ssmr_ident.readers.xlsx.sheet_corner import LONG, corner_of


@pytest.fixture
def workbook(tmp_path: Path) -> Path:
    noise = np.random.default_rng(0).standard_normal((3, 40)) * 0.1 + 2.6
    channels = tuple(Channel(n, v, "V") for n, v in zip(("ax", "ay", "az"), noise, strict=True))
    recording = Recording(np.arange(40) * 1e-3, channels, Provenance("", "", ""))
    return write_labview_xlsx(tmp_path / "a.xlsx", recording, header="none")


def repack(path: Path, part: str, change) -> Path:
    """The workbook with one part changed by a function of its bytes."""
    archive = zipfile.ZipFile(path)
    parts = {name: archive.read(name) for name in archive.namelist()}
    parts[part] = change(parts.get(part, b""))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, data in parts.items():
            packed.writestr(name, data)
    return path


def refused(path: Path, words: str, seconds: float = 2.0) -> None:
    begin = time.process_time()
    with pytest.raises(InputError, match=words):
        read(path)
    assert time.process_time() - begin < seconds


SHEET = "xl/worksheets/sheet1.xml"


@pytest.mark.slow
def test_zip_bomb(workbook: Path) -> None:
    size = zip_safety.MAX_UNPACKED + 1
    refused(repack(workbook, "xl/media/zeros.xml", lambda _: bytes(size)), "unpacks to more than", seconds=5)
    assert workbook.stat().st_size < 1_000_000


def test_zip_that_lies_about_its_size(workbook: Path) -> None:
    """The directory says 10 bytes, the part holds millions."""
    big = repack(workbook, SHEET, lambda data: data + b" " * 3_000_000)
    raw = big.read_bytes()
    size = zipfile.ZipFile(io.BytesIO(raw)).getinfo(SHEET).file_size
    big.write_bytes(raw.replace(size.to_bytes(4, "little"), (10).to_bytes(4, "little")))
    refused(big, "damaged")


@pytest.mark.parametrize("part", [SHEET, "xl/workbook.xml", "xl/styles.xml"])
def test_billion_laughs_in_a_workbook(workbook: Path, part: str) -> None:
    laughs = b'<!DOCTYPE a [<!ENTITY l "ha">' + b"".join(
        b'<!ENTITY l%d "%s">' % (i, b"&l%s;" % (str(i - 1).encode() if i else b"") * 10) for i in range(10)
    )
    refused(repack(workbook, part, lambda data: laughs + b"]>" + data), "document type definition")


def test_billion_laughs_in_machine_xml(tmp_path: Path) -> None:
    path = tmp_path / "a.mtwData"
    entities = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10 if i else "ha"}">' for i in range(10))
    path.write_text(f'<?xml version="1.0"?><!DOCTYPE a [{entities}]><a><Sample TIME="&l9;" LOAD="1"/></a>')
    refused(path, "document type definition")


def test_external_entity(tmp_path: Path) -> None:
    path = tmp_path / "a.mtwData"
    path.write_text('<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><a><Sample TIME="1" LOAD="&x;"/></a>')
    refused(path, "document type definition")


@pytest.mark.parametrize(
    "cell",
    [
        b'<c r="XFD1048576"><v>1</v></c>', b"<c r='XFD1048576'><v>1</v></c>", b'<c s="1" r="XFD1048576"><v>1</v></c>',
        b'<c r = "XFD1048576"><v>1</v></c>', b'<c\nr="XFD1048576"><v>1</v></c>', b'<c r="XFD1048576"/>',
    ],
)  # fmt: skip
@pytest.mark.parametrize("long", [False, True])
def test_one_stray_cell_at_the_end_of_the_sheet(workbook: Path, cell: bytes, long: bool) -> None:
    """17 thousand million cells would be laid out for it; the row goes, with a word."""
    (clean,) = read(workbook)
    padding = b" " * (LONG if long else 0)
    row = b'<row r="1048576">' + cell + b"</row>" + padding + b"</sheetData>"
    begin = time.process_time()
    (recording,) = read(repack(workbook, SHEET, lambda data: data.replace(b"</sheetData>", row)))
    assert time.process_time() - begin < 2.0
    assert any("row(s) from 1048576 on stand alone" in note.text for note in recording.warnings)
    for name in clean.names:
        np.testing.assert_array_equal(recording[name], clean[name])


def test_a_cell_far_to_the_right_is_refused(workbook: Path) -> None:
    row = b'<row r="900"><c r="XFD900"><v>1</v></c></row></sheetData>'
    refused(repack(workbook, SHEET, lambda data: data.replace(b"</sheetData>", row)), "sheet reaches to row 900")


@pytest.mark.parametrize("place", [b'r="A999999999992"', b'r="ABCDEFGHIJKLM2"', b'r="A' + b"9" * 5000 + b'"'])
def test_a_place_longer_than_any_is_far_away(workbook: Path, place: bytes) -> None:
    refused(repack(workbook, SHEET, lambda data: data.replace(b'r="A2"', place, 1)), "sheet reaches to row")


def test_a_place_in_what_is_no_xml_is_not_laid_out(workbook: Path) -> None:
    row = b'<row r="41">&<c r="ABCDE104857629"><v>1</v></c></row></sheetData>'
    refused(repack(workbook, SHEET, lambda data: data.replace(b"</sheetData>", row)), "is damaged")


def test_control_characters_of_an_instrument_are_read_over(workbook: Path) -> None:
    words = b"<sheetData><!-- run\x0b1\x00 -->"
    (recording,) = read(repack(workbook, SHEET, lambda data: data.replace(b"<sheetData>", words, 1)))
    assert len(recording.time) == 40


@pytest.mark.parametrize("share", [0.3, 0.5, 0.9])
def test_a_sheet_cut_short_is_damaged(workbook: Path, share: float) -> None:
    refused(repack(workbook, SHEET, lambda data: data[: int(share * len(data))]), "is damaged")


def test_rows_without_references_are_counted(workbook: Path) -> None:
    rows = (
        b"".join(b"<row>" + b"<c><v>1</v></c>" * 40 + b"</row>" for _ in range(2000))
        + b'<row r="9999"><c r="XFD9999"/></row>'
    )
    refused(
        repack(workbook, SHEET, lambda data: data.replace(b"</sheetData>", rows + b"</sheetData>")), "sheet reaches"
    )


def test_sheet_in_utf16_does_not_slip_through(workbook: Path) -> None:
    text = '<?xml version="1.0" encoding="UTF-16"?><!DOCTYPE a []><worksheet><sheetData/></worksheet>'
    refused(repack(workbook, SHEET, lambda _: text.encode("utf-16")), "is not UTF-8")


@pytest.mark.slow
def test_both_ways_find_the_same_corner() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        rows, columns = int(rng.integers(3000, 9000)), int(rng.integers(1, 26))
        cells = [f'<row r="{r}"><c r="{chr(64 + columns)}{r}"><v>1.5</v></c></row>' for r in range(1, rows + 1)]
        data = f'<worksheet><dimension ref="A1"/><sheetData>{"".join(cells)}</sheetData></worksheet>'.encode()
        spaced = data.replace(b"<c r", b"<c  r")
        assert corner_of(data) == (rows, columns, len(data))
        assert corner_of(spaced) == (rows, columns, len(spaced))


@pytest.mark.slow
def test_a_million_blank_formatted_rows(workbook: Path) -> None:
    """A column formatted to the end of the sheet is clumsy, not wrong: it is read, up to the last number."""
    blank = b"".join(b'<row r="%d"><c r="A%d" s="0"/></row>' % (r, r) for r in range(41, 300_000))
    path = repack(workbook, SHEET, lambda data: data.replace(b"</sheetData>", blank + b"</sheetData>"))
    (recording,) = read(path)
    assert len(recording.time) == 40


def test_huge_declared_dimension_is_not_believed(workbook: Path) -> None:
    dimension = b'<dimension ref="A1:XFD1048576"/><sheetData>'
    (recording,) = read(repack(workbook, SHEET, lambda data: data.replace(b"<sheetData>", dimension)))
    assert len(recording.time) == 40


def test_line_without_end(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"Time (s),Load (N)\n" + b"1," * 3_000_000)
    with pytest.raises(InputError):
        read(path)


def test_random_bytes_and_pictures(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    path = tmp_path / "a.csv"
    for head in (
        b"",
        b"\x89PNG\r\n",
        b"%PDF-1.4",
        b"BM",
        b"\xff\xfe",
        b"PK\x03\x04",
        b"TDSm",
        b"<a>",
        b"LabVIEW Measurement\t\n",
    ):
        path.write_bytes(head + rng.integers(0, 256, 5000, dtype=np.uint8).tobytes())
        with pytest.raises(InputError):
            read(path)
