"""Cells of thousands of letters: read, or refused in one line, in a time that grows as the file does."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import read_one

LONG = 20_000
CELLS = {
    "digits and a letter": "1" * LONG + "x",
    "digits and points": "1." * (LONG // 2),
    "exponents": "1e" * (LONG // 2),
    "a number at the end of blanks": " " * LONG + "1x",
    "a time without end": "12:" * (LONG // 3),
    "signs": "-+" * (LONG // 2),
    "a unit without end": "1 " + "m/" * (LONG // 2),
    "commas and digits": "1'000" * (LONG // 5) + "?",
}


@pytest.fixture(scope="module", autouse=True)
def warm(tmp_path_factory: pytest.TempPathFactory) -> None:
    """What reading imports when it is first asked is no cost of a cell."""
    log = tmp_path_factory.mktemp("warm") / "log.csv"
    log.write_text("time [s],ax [m/s^2]\n" + "".join(f"{i / 100},{i % 7}x\n" for i in range(300)), encoding="utf-8")
    with pytest.raises(InputError):
        read_one(log)


@pytest.mark.parametrize("name", CELLS)
@pytest.mark.parametrize("times", [1, pytest.param(20, marks=pytest.mark.slow)])
def test_a_cell_costs_what_its_letters_cost(tmp_path: Path, name: str, times: int) -> None:
    rows = [f"{i / 100},{(i * i) % 7},{i % 5}" for i in range(300)]
    for row in range(times):
        rows[100 + row] = f"{1 + row / 100},{CELLS[name]},3"
    log = tmp_path / "log.csv"
    log.write_text("time [s],ax [m/s^2],ay [m/s^2]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    begun = time.process_time()
    try:
        said = " ".join(note.text for note in read_one(log).notes)
    except InputError as error:
        said = str(error)
    assert "\n" not in said
    assert len(said) < 1500 + len(str(log))
    assert time.process_time() - begun < 2.0  # as long for each megabyte at the most, and these are below one
