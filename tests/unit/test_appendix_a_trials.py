"""Appendix A to the letter beside ours: what the low-pass does to a line at its edge, and every trial in the table."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.experiments import SWIVEL
from ssmr_ident.signals.analysis import AnalysisOptions, analyse
from ssmr_ident.workflows.spectrum.appendix_a import band_amplitude, printed_peaks, write
from ssmr_ident.workflows.spectrum.run import SpectrumReport
from ssmr_ident.workflows.spectrum.table import RATE_LABEL, RecordingLabel, SpectrumRow

TIME = np.arange(20000) / 1000.0
EDGE = 819 * 1000.0 / 2**14  # the bin next to 50 Hz


def row(name: str, speed: float, size: float) -> SpectrumRow:
    course = size * np.sin(2 * np.pi * 131 * 1000.0 / 2**14 * TIME) + 0.5 * np.sin(2 * np.pi * EDGE * TIME)
    label = RecordingLabel(name, SWIVEL, floor="tile", frame="frame", yaw_rate_deg_s=speed)
    return SpectrumRow(label, "ay", "m/s^2", analyse(course, 1000.0, AnalysisOptions()))


def test_the_low_pass_halves_a_line_at_its_edge() -> None:
    one = row("a.xlsx", 30.0, 1.0)
    ours, printed = one.analysis.peaks, printed_peaks(one)
    assert ours.amplitude[:2] == pytest.approx([1.0, 0.5], rel=1e-3)
    assert printed.amplitude[:2] == pytest.approx([1.0, 0.25], rel=0.03)
    assert band_amplitude(one) == pytest.approx(1.0, rel=0.02)


@pytest.mark.slow
def test_every_trial_is_written(tmp_path: Path) -> None:
    rows = tuple(row(f"{k}.xlsx", 10.0 * k, 1.0 + 0.1 * k) for k in (1, 2, 3))
    report = write(SpectrumReport("made", rows, (), (), RATE_LABEL), tmp_path)
    assert {file.name for file in report.files} == {"appendix-a.csv", "appendix-a.png"}
    with (tmp_path / "appendix-a.csv").open(encoding="utf-8", newline="") as stream:
        found = list(csv.DictReader(stream))
    assert [float(line["yaw_rate_deg_s"]) for line in found] == [10.0, 20.0, 30.0]
    assert float(found[0]["ours_peak_2_amplitude"]) > 1.8 * float(found[0]["printed_peak_2_amplitude"])
