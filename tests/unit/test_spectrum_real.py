"""``ident spectrum`` on recordings of other people, where these lie beside the checkout."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.workflows.spectrum.run import SpectrumChoices, spectrum


def test_hammer_shows_both_modes(shared: Path) -> None:
    """19.76 and 21.15 Hz by a two-mode fit of the same record (its README); bins are 0.125 Hz wide."""
    report = spectrum([shared / "recordings/lvm_hammer"])
    for row in report.rows:
        if row.unit == "m/s^2":
            two = np.sort(row.analysis.peaks.frequency[:2])
            np.testing.assert_allclose(two, [19.76, 21.15], atol=0.125)


def test_a_coarse_range_cannot_split_the_modes(shared: Path) -> None:
    """Half a second resolves 2 Hz: no two of the peaks may then pretend to be the pair."""
    report = spectrum([shared / "recordings/lvm_hammer"], SpectrumChoices(part="0.3:0.8"))
    frequencies = report.rows[1].analysis.peaks.frequency
    near = frequencies[np.abs(frequencies - 20.45) < 1.5]
    assert len(near) == 1


@pytest.mark.slow
def test_practice_swivels_agree_across_formats(shared: Path) -> None:
    for practice, reader in (("practice-20", "xlsx"), ("practice-21", "lvm")):
        report = spectrum([shared / "practice" / practice / "session"])
        assert {row.unit for row in report.rows} == {"m/s^2"}
        assert {row.analysis.part.count for row in report.rows} == {2**14}, reader
        vertical = [np.mean(row.analysis.samples) for row in report.rows if row.channel == "az"]
        # the zero of the sensor is known to 0.02 V, which is 0.13 m/s²
        np.testing.assert_allclose(vertical, 9.8, atol=3 * 0.13)


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["borealtc_flooring", "borealtc_ice"])
def test_husky_logs_of_100_hz(shared: Path, folder: str) -> None:
    report = spectrum([shared / "recordings" / folder])
    assert all(row.analysis.mains is None for row in report.rows)
    assert report.speed_key == "wheel_speed_m_s"
    assert {average.channel for average in report.averages} == {"ax", "ay", "az"}
    for row in report.rows:
        # 50 Hz is half the rate: nothing to take away
        np.testing.assert_array_equal(row.analysis.low_passed, row.analysis.samples)
