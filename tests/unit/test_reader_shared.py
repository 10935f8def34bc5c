"""Every real recording and every practice log is read, without a question to the user."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import ReadOptions, read, read_one

LOGS = (".csv", ".lvm", ".xlsx", ".txt")


def logs(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.suffix in LOGS)


@pytest.mark.slow
def test_every_recording_is_read(shared: Path) -> None:
    files = [path for path in logs(shared / "recordings") if path.parent.name != "original"]
    assert len(files) > 50
    for path in files:
        (recording,) = read(path)
        header, *_ = path.read_text().splitlines()
        labels = [cell.split(" [")[0] for cell in header.split(",")][1:]
        assert [channel.label for channel in recording.channels] == labels
        table = np.loadtxt(path, delimiter=",", skiprows=1, max_rows=3000)
        np.testing.assert_array_equal(recording.time[:3000], table[:, 0])
        for index, channel in enumerate(recording.channels, start=1):
            np.testing.assert_array_equal(channel.samples[:3000], table[:, index])
        assert not recording.warnings, (path, recording.warnings)


def test_originals_ask_for_what_they_do_not_say(shared: Path) -> None:
    for path in sorted((shared / "recordings").glob("friction*/original/*.csv")):
        with pytest.raises(InputError, match="unit of"):
            read(path)
        recording = read_one(path, ReadOptions(units={"position": "mm", "force": "N"}, time_unit="us"))
        assert recording.names == ("position", "force") or recording.names == ("force", "position")
        assert recording.series("force").rate == pytest.approx(84, abs=3)


@pytest.mark.slow
def test_every_practice_log_is_read(shared: Path) -> None:
    files = logs(shared / "practice")
    assert len(files) > 150
    for path in files[::3]:  # every third: the others differ in their numbers only
        recording = read_one(path)
        if path.suffix in (".xlsx", ".lvm"):
            assert recording.names == ("ax", "ay", "az")
            assert {channel.unit for channel in recording.channels} == {"V"}
            assert recording.sample_rate == pytest.approx(1000.0, rel=1e-6)
            assert 3.7 < recording["az"].mean() < 4.4  # 2.6 V and one g
        elif path.suffix == ".txt":
            assert recording.names == ("position", "force")
            table = np.loadtxt(path, skiprows=2)
            np.testing.assert_allclose(recording["position"], table[:, 1] * 1e-3, rtol=1e-15)
            np.testing.assert_array_equal(recording["force"], table[:, 2])
        assert not [note for note in recording.warnings if "clipped" not in note.text], path
