"""The benchmark that holds two checkouts' answers side by side sees a difference, and no folder for one."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from same_answers import differences, hold


@pytest.mark.parametrize(
    ("one", "other", "count"),
    [
        ({"a": 1.0, "b": [1.0, float("nan")]}, {"a": 1.0 + 1e-12, "b": [1.0, float("nan")]}, 0),
        ({"a": 1.0}, {"a": 1.0 + 1e-6}, 1),
        ({"a": 1.0}, {"a": float("nan")}, 1),
        ({"a": 1.0}, {"b": 1.0}, 2),
        ([1, 2], [1, 2, 3], 1),
        ("written: /tmp/one/roll.csv", "written: /home/other/roll.csv", 0),
        ("written: /tmp/one/roll.csv", "written: /tmp/one/yaw.csv", 1),
        ("N/m/s", "N/k/s", 1),
    ],
)
def test_numbers_within_and_words_without_their_folders(one: object, other: object, count: int) -> None:
    assert len(list(differences(one, other, 1e-9))) == count


def test_files_are_read_as_what_they_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, value in (("one", 2.0), ("other", 2.0 + 1e-12)):
        folder = tmp_path / name / "fit"
        folder.mkdir(parents=True)
        (folder / "a.csv").write_text(f"time,x\n0,{value!r}\n")
        (folder / "a.json").write_text(json.dumps({"value": value, "file": str(folder / "a.csv")}))
        (folder / "a.yaml").write_text(f"value: {value!r}\n")
    assert hold(tmp_path / "one", tmp_path / "other", 1e-9, 5) == 0
    (tmp_path / "other" / "fit" / "a.yaml").write_text("value: 2.1\n")
    (tmp_path / "one" / "fit" / "b.json").write_text("{}")
    assert hold(tmp_path / "one", tmp_path / "other", 1e-9, 5) == 2
    assert "fit: 2 of 4 files agree" in capsys.readouterr().out
