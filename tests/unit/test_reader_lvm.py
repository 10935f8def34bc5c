"""LVM files beyond the samples: no X column, other dimensions, comments, empty channels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import ReadOptions, read, read_one

FILE = "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
FILE += "X_Columns\t{x}\n***End_of_Header***\t\n\t\n"


def segment(rows: list[str], names: str = "X_Value\tVoltage_0\tComment", *tags: str) -> str:
    return "\n".join([*tags, "***End_of_Header***\t", names, *rows]) + "\n"


def write(tmp_path: Path, text: str, x: str = "One") -> Path:
    path = tmp_path / "a.lvm"
    path.write_text(FILE.format(x=x) + text, encoding="cp1252")
    return path


ROWS = [f"{k / 1000:.6f}\t{2.5 + k / 100:.6f}" for k in range(20)]


def test_no_unit_means_volts_with_a_warning(tmp_path: Path) -> None:
    recording = read_one(write(tmp_path, segment(ROWS)))
    assert recording.channels[0].unit == "V"
    assert any("Voltage_0: no unit in the file, taken as V" in note.text for note in recording.warnings)


def test_units_of_the_header(tmp_path: Path) -> None:
    path = write(tmp_path, segment(ROWS, "X_Value\tLoad\tComment", "Channels\t1", "Y_Unit_Label\tkN"))
    np.testing.assert_allclose(read_one(path)["force"], 2500 + 10 * np.arange(20), rtol=1e-12)


def test_spectrum_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, segment(ROWS, "X_Value\ta\tComment", "Channels\t1", "X_Dimension\tFrequency"))
    with pytest.raises(InputError, match="line 9: X_Dimension is Frequency: not a log over time"):
        read(path)


def test_no_x_and_no_step_asks_for_the_rate(tmp_path: Path) -> None:
    path = write(tmp_path, segment(["\t1.0", "\t2.5", "\t2.0"]), x="No")
    with pytest.raises(InputError, match=r"no X column and no Delta_X above zero\. Give --fs"):
        read(path)
    np.testing.assert_allclose(read_one(path, ReadOptions(fs=100.0)).time, [0, 0.01, 0.02])


def test_comments_are_kept_and_text_is_refused(tmp_path: Path) -> None:
    recording = read_one(write(tmp_path, segment([*ROWS, "0.020000\t3.1\tLOST COMMUNICATION"])))
    assert any("LOST COMMUNICATION" in note.text and note.where == "line 30" for note in recording.notes)
    path = write(tmp_path, segment([*ROWS, "0.020000\tn.a."]))
    with pytest.raises(InputError, match=r"line 30: 'n\.a\.' where a number belongs"):
        read(path)
    assert np.isnan(read_one(path, ReadOptions(on_bad="nan")).channels[0].samples[-1])


def test_channel_without_samples_is_left_out(tmp_path: Path) -> None:
    rows = [f"{k / 1000:.6f}\t{k}\t\t{2 * k}" for k in range(10)]
    path = write(tmp_path, segment(rows, "X_Value\ta1\ta2\ta3\tComment", "Channels\t3", "Samples\t10\t0\t10"))
    recording = read_one(path)
    assert recording.names == ("a1", "a3")
    np.testing.assert_array_equal(recording["a3"], 2.0 * np.arange(10))
    assert any("channel a2 holds no samples" in note.text for note in recording.warnings)


def test_appended_run_restarts_the_time(tmp_path: Path) -> None:
    first, second = read(write(tmp_path, segment([*ROWS, *ROWS[:8]])))
    assert (len(first.time), len(second.time)) == (20, 8)


def test_points_and_commas_together_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, segment([*ROWS[:5], "0,005\t2,55"]))
    with pytest.raises(InputError, match="decimal points and with decimal commas"):
        read(path)


def test_header_without_data(tmp_path: Path) -> None:
    for text, words in (("", "has a header and no data"), (segment([]), "no data below the header")):
        with pytest.raises(InputError, match=words):
            read(write(tmp_path, text))


def test_long_file_goes_through_the_compiled_loop_alike(tmp_path: Path) -> None:
    rng = np.random.default_rng(10)
    values = (2.6 + 0.1 * rng.standard_normal((15_000, 2))).round(6)
    rows = [f"{k / 1000:.6f}\t{a:.6f}\t{b:.6f}" for k, (a, b) in enumerate(values)]
    rows[700] += "\tbump"
    rows[9000] = "9.000000\t-1.#IND\t2.5"
    recording = read_one(write(tmp_path, segment(rows, "X_Value\tA\tB\tComment")))
    expected = values.copy()
    expected[9000] = np.nan, 2.5
    np.testing.assert_array_equal(np.stack([c.samples for c in recording.channels], axis=1), expected)
    np.testing.assert_array_equal(recording.time, [float(row.split("\t")[0]) for row in rows])
    assert any("bump" in note.text and note.where == "line 710" for note in recording.notes)
