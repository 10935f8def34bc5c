"""Rows beyond ``Samples`` without an X column: records or one record."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from ssmr_ident.readers import ReadOptions, read
from ssmr_ident.readers.lvm.packets import _fisher, rounded_step

HEADER = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tNo\n"
    "X_Columns\tNo\n"
    "***End_of_Header***\t\n\t\nChannels\t2\nSamples\t{n}\t{n}\nY_Unit_Label\tN\tm/s^2\nX0\t0.0\t0.0\n"
    "Delta_X\t{step}\t{step}\n***End_of_Header***\t\nX_Value\thammer\tm_1\tComment\n"
)


def write(path: Path, values: np.ndarray, samples: int, step: str = "0.001000") -> Path:
    rows = "".join(f"\t{a:.6f}\t{b:.6f}\n" for a, b in values)
    path.write_text(HEADER.format(n=samples, step=step) + rows)
    return path


def ringing(seed: int, count: int) -> np.ndarray:
    """Noise and a decaying 20 Hz tone; begins anew for every hit."""
    rng = np.random.default_rng(seed)
    t = np.arange(count) / 1000
    tone = np.exp(-t) * np.sin(2 * np.pi * 20 * t + rng.uniform(0, 6))
    return np.stack([0.05 + 0.001 * rng.standard_normal(count), tone + 0.002 * rng.standard_normal(count)], axis=1)


def test_triggered_packets_are_records(tmp_path: Path) -> None:
    values = np.concatenate([ringing(seed, 2000) for seed in (1, 2, 3)])
    recordings = read(write(tmp_path / "a.lvm", values, 2000))
    assert [len(r.time) for r in recordings] == [2000, 2000, 2000]
    assert all(r.time[0] == 0 for r in recordings)
    np.testing.assert_array_equal(recordings[2]["m_1"], values[4000:, 1].round(6))
    assert any("read as 3 records" in note.text for note in recordings[0].warnings)


@pytest.mark.slow
def test_a_running_acquisition_stays_one_record(tmp_path: Path) -> None:
    """Samples is the size of a packet only; rows are trusted. 1 in 100 may be split at the level of 0.01."""
    split = 0
    for seed in range(20):
        values = ringing(seed, 3000)
        recordings = read(write(tmp_path / "a.lvm", values, 500 + 100 * (seed % 7)))
        split += len(recordings) > 1
        if len(recordings) == 1:
            assert len(recordings[0].time) == 3000
            assert any("read as one record" in note.text for note in recordings[0].warnings)
    assert split <= 1


def test_one_sample_declared_says_nothing(tmp_path: Path) -> None:
    (recording,) = read(write(tmp_path / "a.lvm", ringing(5, 300), 1))
    assert len(recording.time) == 300


def test_hammer_log_is_two_records_at_its_rate(shared: Path) -> None:
    folder = shared / "recordings" / "lvm_hammer"
    path = folder / "original" / "long_single_header_multi_ch-cut.lvm"
    first, second = read(path)
    assert (len(first.time), len(second.time)) == (8192, 60)
    assert first.sample_rate == pytest.approx(1 / 0.000977, rel=1e-9)
    lines = path.read_text(encoding="cp1252").split("X_Value")[1].splitlines()[1:]
    values = np.array([[float(cell) for cell in line.split("\t")[1:4]] for line in lines])
    np.testing.assert_allclose(first["F"], values[:8192, 0] * 9.80665, rtol=1e-15)
    np.testing.assert_array_equal(first["m_1"], values[:8192, 1])
    np.testing.assert_array_equal(second["m_2"], values[8192:, 2])
    notes = " ".join(note.text for note in first.warnings)
    assert "1023.54 Hz is used, 1024 Hz prints the same" in notes
    assert "channel F bears the unit g" in notes
    first, _ = read(path, ReadOptions(fs=1024.0, units={"F": "N"}))
    assert first.sample_rate == pytest.approx(1024.0)
    np.testing.assert_array_equal(first["force"], values[:8192, 0])


def test_rounded_steps() -> None:
    assert rounded_step("0.001000", 0.001) is None
    assert "1024 Hz prints the same" in rounded_step("0.000977", 0.000977).text
    assert "3000 Hz prints the same" in rounded_step("0.000333", 0.000333).text
    assert rounded_step("3.906250E-5", 3.90625e-5) is None


def test_fisher_agrees_with_scipy() -> None:
    for chances in ([0.003], [0.5, 0.01, 0.2], [0.9] * 30, [1e-4] * 80):
        expected = chi2.sf(-2 * np.log(chances).sum(), 2 * len(chances))
        assert _fisher(chances) == pytest.approx(expected, rel=1e-9, abs=1e-300)
