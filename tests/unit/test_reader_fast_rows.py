"""The compiled loop gives the very doubles that Python's own float gives, and hands over what it cannot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from ssmr_ident.readers import read_one
from ssmr_ident.readers.text.dialect import NUMBER, Layout
from ssmr_ident.readers.text.encoding import Text
from ssmr_ident.readers.text.fast_rows import count_lines, parse_rows
from ssmr_ident.readers.text.numbers import Dialect
from ssmr_ident.readers.text.numeric_run import NumberRun, TextRow, compiled_rows, walk


def rows_of(text: str, width: int, delimiter: str = ",", decimal: str = ".") -> tuple[np.ndarray, str]:
    data = text.encode()
    out, kinds = np.empty((width, 1000)), np.zeros(width, dtype=np.int64)
    none = np.zeros((0, 0, 2), dtype=np.int64)
    count, end = parse_rows(np.frombuffer(data, np.uint8), 0, ord(delimiter), ord(decimal), kinds, out, none)
    return out[:, :count].T, data[end:].decode()


@pytest.mark.parametrize("style", ["{:.6f}", "{:.3e}", "{:.17g}", "{!r}", "{:.0f}", "{:+.9f}", "{:.15g}", "{:.18f}"])
def test_bit_for_bit_like_python(style: str) -> None:
    rng = np.random.default_rng(6)
    values = rng.standard_normal(3000) * 10.0 ** rng.integers(-9, 10, 3000)
    tokens = [style.format(float(v)) for v in values]
    text = "".join(f"{a},{b}\n" for a, b in zip(tokens[::2], tokens[1::2], strict=True))
    got: list[float] = []
    taken = 0
    while text:
        rows, rest = rows_of(text, 2)
        got += rows.ravel().tolist()
        taken += len(rows)
        if rest and not len(rows):  # the row goes through Python
            line, _, rest = rest.partition("\n")
            got += [float(cell) for cell in line.split(",")]
        text = rest
    assert got == [float(token) for token in tokens]
    if style != "{:.18f}":
        # the loop must not hand over everything; below 1e-6 the power of ten is beyond the exact ones
        assert taken > 900


def test_halfway_cases_are_rounded_to_even() -> None:
    """Numbers that lie between two doubles: 2**53 + 1 and its like, where a naive loop is off by one."""
    tokens = ["9007199254740993", "9007199254740995", "900719925474099.3", "9007199254740.993", "0.9007199254740993"]
    tokens += [f"{2**53 + 2 * k + 1}" for k in range(200)] + [f"{(2**53 + 2 * k + 1) / 10**6!r}" for k in range(200)]
    for token in tokens:
        rows, rest = rows_of(token + "\n", 1)
        assert rest or rows[0, 0] == float(token)


@pytest.mark.parametrize(
    "row", ["1,x", "1", "1,NaN", "1,2,3", "1,2 3", "1,0x2", "1,2e", "1,--2", "1,1e400",
            "1,1234567890123456789012",            "1,.", "1,-", '1,"2"', "", "   ", "1,14:03:11"],
)  # fmt: skip
def test_rows_that_are_handed_over(row: str) -> None:
    rows, rest = rows_of(f"5,6\n{row}\n7,8\n", 2)
    np.testing.assert_array_equal(rows, [[5, 6]])
    assert rest == f"{row}\n7,8\n"


def test_endings_blanks_and_empty_cells() -> None:
    rows, rest = rows_of(" 1 , 2 \r\n3,4,,\n,6\n7,\n7,8", 2)
    np.testing.assert_array_equal(rows, [[1, 2], [3, 4], [np.nan, 6], [7, np.nan], [7, 8]])
    assert rest == ""
    rows, rest = rows_of("  1   2\n\t3\t4\n", 2, " ")
    np.testing.assert_array_equal(rows, [[1, 2], [3, 4]])
    rows, rest = rows_of("1,5;2,5\n", 2, ";", ",")
    np.testing.assert_array_equal(rows, [[1.5, 2.5]])


@pytest.mark.slow
def test_long_and_short_ways_agree(tmp_path: Path) -> None:
    """A log long enough for the loop and for two threads, with disturbances that go through Python."""
    rng = np.random.default_rng(7)
    lines = [f"{k / 1000:.3f},{f:.4f}" for k, f in enumerate(rng.standard_normal(300_000))]
    for k in rng.integers(10, 299_000, 200):
        lines[k] = lines[k].replace(",", ', "') + '"'
    data = "\n".join(["Time (s),Load (N)", *lines]) + "\n"
    assert len(data) > 4_500_000
    path = tmp_path / "a.csv"
    path.write_text(data)
    recording = read_one(path)
    expected = [float(line.split(",")[1].strip(' "')) for line in lines]
    np.testing.assert_array_equal(recording["force"], expected)
    np.testing.assert_array_equal(recording.time, [float(line.split(",")[0]) for line in lines])


@pytest.mark.slow
def test_agrees_with_pandas(tmp_path: Path) -> None:
    rng = np.random.default_rng(8)
    table = pd.DataFrame({"Time (s)": np.arange(400_000) / 1000, "Load (N)": rng.standard_normal(400_000)})
    table.to_csv(tmp_path / "a.csv", index=False)
    theirs = pd.read_csv(tmp_path / "a.csv")
    recording = read_one(tmp_path / "a.csv")
    np.testing.assert_array_equal(recording["force"], theirs["Load (N)"])


def test_lines_are_counted_through_all_ways() -> None:
    body = "".join(f"{k},{k}\n" for k in range(60_000))
    text = Text(f"a,b\n{body}\nwords\n1,2\n".encode(), "utf-8")
    items = list(walk(text, Layout(Dialect(","))))
    assert isinstance(items[0], TextRow)
    assert isinstance(items[1], NumberRun)
    assert (items[1].lines[0], items[1].lines[-1]) == (2, 60_001)
    assert [item.line for item in items if isinstance(item, TextRow)] == [1, 60_002, 60_003]
    assert items[-1].lines.tolist() == [60_004]
    assert count_lines(np.frombuffer(text.data, np.uint8)) == 60_004


def test_compiled_rows_grow() -> None:
    """Rows that get shorter: the guess from the head is too small."""
    text = "1000000.000000,2000000.000000\n" * 3000 + "1,2\n" * 200_000
    rows, end, _ = compiled_rows(text.encode(), 0, Dialect(","), (NUMBER, NUMBER))
    assert len(rows) == 203_000
    assert end == len(text)
    assert rows[-1].tolist() == [1, 2]


def test_text_and_stamps_are_passed_over(tmp_path: Path) -> None:
    """The loop and Python's way read the same table of stamps, numbers, words and blanks."""
    rng = np.random.default_rng(9)
    rows = [
        f'2024-03-01 12:{k // 6000:02d}:{k % 6000 / 100:05.2f},{"" if k % 4 else f"{v:.4f}"},"state, {k % 3}",{v:.5f}'
        for k, v in enumerate(rng.standard_normal(9000))
    ]
    recordings = []
    for count in (9000, 3000):
        path = tmp_path / f"{count}.csv"
        path.write_text("\n".join(["timestamp,Load (N),state,a (m/s^2)", *rows[:count]]) + "\n")
        recordings.append(read_one(path))
    long, short = recordings
    assert long.names == ("force", "acceleration")
    np.testing.assert_allclose(long.time[:100], np.arange(100) / 100, atol=1e-6)
    np.testing.assert_array_equal(long["acceleration"][:2997], short["acceleration"])
    np.testing.assert_array_equal(long.series("force").samples[:750], short.series("force").samples)
    assert long.series("force").rate == pytest.approx(25.0, rel=1e-6)
    assert any("column(s) of text left out: state" in note.text for note in long.notes)
