"""A row of numbers that no run of rows takes is a line of text, wherever it stands."""

from __future__ import annotations

from pathlib import Path

import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import read

ROWS = ("0.0550,0.9399../../,", "0.0800,0.9787,0.979", "0.2050,", "0.2400,=0.8133,", "0.813", "0.2450,")
"""Of three columns; the third row has two, the fourth is filled up to what stands above it."""


def test_a_row_that_no_run_takes_costs_itself(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("\n".join(ROWS) + "\n")
    with pytest.raises(InputError, match=r"a\.csv"):
        read(file)
