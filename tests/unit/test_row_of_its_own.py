"""A row of numbers that no run of rows takes is a line of text, wherever it stands."""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.readers import read


def test_a_row_of_zero_bytes_costs_itself(tmp_path: Path) -> None:
    rows = [f"{0.005 * k:.4f},{(k * 37 % 11) / 10:.4f},{k % 4}" for k in range(40)]
    rows[20] = "0" + "\x00" * 32 + ","
    file = tmp_path / "a.csv"
    file.write_text("time [s],ax [m/s^2],force [N]\n" + "\n".join(rows) + "\n")
    (recording,) = read(file)
    assert len(recording.time) == 39
