"""One call draws every public result."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import ssmr_ident
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.diagnosis import Diagnosis, PredictionQuality
from ssmr_ident.diagnose.evidence import Evidence, Overlay
from ssmr_ident.workflows.spectrum.run import spectrum


def _labels(figure: Figure) -> list[str]:
    return [axes.get_ylabel() for axes in figure.axes]


def test_recordings_simulations_and_effects(root: Path) -> None:
    recordings = ssmr_ident.read(root / "data" / "raw" / "pulls" / "carpet-lateral-steel-1.txt")
    assert _labels(ssmr_ident.plot(recordings[0])) == ["position [m]", "force [N]"]
    robot = ssmr_ident.robot_from_parameters(ssmr_ident.read_parameters("p3at-extended"))
    run = ssmr_ident.simulate_robot(robot, ssmr_ident.Scenario("free_response", 0.2, offset={"roll": 0.001}))
    assert len(ssmr_ident.plot(run).axes) == 3
    assert len(ssmr_ident.plot(ssmr_ident.CATALOGUE["sensor_bandwidth"]).axes) >= 2


@pytest.mark.slow
def test_fits_spectra_and_comparisons(root: Path) -> None:
    session = root / "data" / "raw" / "pulls" / "carpet.yaml"
    comparison = ssmr_ident.compare_session(session)
    worst = max(comparison.recordings, key=lambda recording: recording.value)
    assert worst.file in ssmr_ident.plot(comparison).axes[0].get_title()
    assert "force [N]" in _labels(ssmr_ident.plot(comparison, "carpet-lateral-steel-1.txt"))
    with pytest.raises(InputError, match="Did you mean 'carpet-lateral-steel-1"):
        ssmr_ident.plot(comparison, "carpet-lateral-stel-1.txt")
    assert ssmr_ident.plot(ssmr_ident.fit_session(session))._repr_png_().startswith(b"\x89PNG")
    report = spectrum([root / "data" / "raw" / "free_response" / "roll-1.xlsx"])
    assert len(ssmr_ident.plot(report).axes) == 9


def test_a_diagnosis_shows_where_it_gains_most() -> None:
    time = np.linspace(0.0, 1.0, 200)
    courses = np.sin(9 * time), np.sin(8 * time), np.sin(9 * time)
    gains = (("a.csv", True, 3.0), ("b.csv", True, 9.0), ("c.csv", False, 20.0))
    overlays = tuple(
        Overlay(name, "ay", "m/s^2", heldout, time, *courses, (2.0 + gain, 2.0, 1.9)) for name, heldout, gain in gains
    )
    empty = ParameterSet("rig", {})
    diagnosis = Diagnosis(
        "s", "nothing_missing", (), (), (), (), "nrmse_percent", PredictionQuality(1, 1, 1), PredictionQuality(1, 1, 1),
        "", empty, empty, "", evidence=Evidence(overlays=overlays),
    )  # fmt: skip
    figure = ssmr_ident.plot(diagnosis)
    text = " ".join(t.get_text() for axes in figure.axes for t in (axes.title, axes._left_title))
    text += str(figure.get_suptitle())
    assert "b.csv" in text
    with pytest.raises(InputError, match="no evidence"):
        ssmr_ident.plot(diagnosis.without_evidence())


def test_what_cannot_be_drawn_is_said() -> None:
    with pytest.raises(TypeError, match="SessionFit"):
        ssmr_ident.plot(3)
