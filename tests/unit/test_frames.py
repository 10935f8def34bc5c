"""Results as pandas frames: their columns as documented, their numbers those of the result."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from made_diagnoses import EVERY
from made_fit import made_fit

import ssmr_ident
from ssmr_ident.compare.comparison import Comparison, RecordingComparison
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose import Diagnosis
from ssmr_ident.identify.decays.result import DecayFit
from ssmr_ident.signals.peaks import Peaks
from ssmr_ident.simulate import Simulation
from ssmr_ident.workflows.fit.result import SessionFit
from ssmr_ident.workflows.spectrum.run import SpectrumReport, spectrum

ROOT = Path(__file__).resolve().parents[2]
RECORDING = Recording(
    np.array([0.0, 0.5, 1.0]),
    (Channel("force", np.array([1.0, 2.0, 4.0]), "N"), Channel("position", np.zeros(3), "m")),
    Provenance("log.csv", "", "csv"),
)


def test_a_recording_is_a_column_a_channel_over_time() -> None:
    made = RECORDING.to_frame()
    assert made.index.name == "time_s"
    assert made.loc[0.5, "force"] == 2.0
    assert made.attrs == {"units": {"force": "N", "position": "m"}, "file": "log.csv"}


def test_parameters_are_a_row_a_number_with_parts_and_effects() -> None:
    mass, place = Estimate(8.0, 0.1, "kg", "weighed", fixed=True), Estimate(np.array([1.0, 2.0]), None, "m")
    known = ParameterSet(
        "rig",
        {"mass_kg": mass, "place_m": place},
        {"dry_friction": {"F_c_N": Estimate(2.0, 0.5, "N")}},
    )  # fmt: skip
    made = known.to_frame()
    assert list(made.index) == ["mass_kg", "place_m[0]", "place_m[1]", "effects.dry_friction.F_c_N"]
    assert made.loc["mass_kg"].to_dict() == {
        "value": 8.0, "std": 0.1, "unit": "kg", "source": "weighed", "fixed": True, "at_bound": False,
    }  # fmt: skip
    assert made.value["place_m[1]"] == 2.0
    assert np.isnan(made["std"]["place_m[1]"])


def test_a_fit_is_a_row_an_unknown() -> None:
    made = made_fit().to_frame()
    assert list(made.columns) == ["value", "std", "unit", "before", "before_std", "source"]
    assert made.loc["mass_kg", ["value", "before"]].tolist() == [33.04, 31.0]
    assert made["std"].dtype == made.before.dtype == float
    assert np.isnan(made.before["offset"])


def test_a_comparison_is_a_row_a_channel() -> None:
    one = RecordingComparison("a.csv", "pull", "nrmse_percent", 5.0, {"force": 6.0, "position": 4.0}, None)  # type: ignore[arg-type]
    made = Comparison("s", "p.yaml", (one,)).to_frame()
    assert made.set_index("channel").value.to_dict() == {"force": 6.0, "position": 4.0}
    assert set(made.together) == {5.0}
    assert list(Comparison("s", "p.yaml", ()).to_frame().columns) == list(made.columns)


@pytest.mark.parametrize("make", EVERY)
def test_a_diagnosis_is_a_row_an_explanation(make: Callable[[], Diagnosis]) -> None:
    diagnosis = make()
    made = diagnosis.to_frame()
    assert list(made.id) == [tried.id for tried in diagnosis.tried]
    assert made.attrs["verdict"] == diagnosis.verdict
    assert {name for id in made.id[made.named] for name in id.split("+")} <= {e.id for e in diagnosis.effects}
    assert made.named.any() == bool(diagnosis.effects)
    assert not made.named[made.id == "baseline"].any()


def test_peaks_are_rows() -> None:
    made = Peaks(np.array([6.0, 12.0]), np.array([0.5, 0.1]), 0.25).to_frame()
    assert made.to_dict("list") == {"frequency_hz": [6.0, 12.0], "amplitude": [0.5, 0.1]}
    assert len(Peaks(np.zeros(0), np.zeros(0), 0.25).to_frame()) == 0


def test_a_spectrum_is_a_row_a_channel() -> None:
    made = spectrum([ROOT / "data" / "raw" / "free_response" / "roll-1.xlsx"]).to_frame()
    assert list(made.channel) == ["ax", "ay", "az"]
    assert made.peak_1_hz.notna().all()


def test_the_page_names_every_result_that_makes_a_frame() -> None:
    page = (ROOT / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
    results = (Recording, Simulation, ParameterSet, SessionFit, DecayFit, Comparison, Diagnosis, SpectrumReport, Peaks)
    for result in results:
        assert hasattr(result, "to_frame")
        assert f"`{result.__name__}`" in page


@pytest.mark.parametrize("page", ["README.md", "docs/reference/python.md"])
def test_an_example_needs_the_public_names_alone(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    nodes = list(ast.walk(ast.parse("".join(blocks))))
    assert {ast.unparse(n) for n in nodes if isinstance(n, ast.Import | ast.ImportFrom)} == {"import ssmr_ident"}
    asked = {ast.unparse(n).partition(".")[2] for n in nodes if isinstance(n, ast.Attribute) and _is_package(n.value)}
    assert asked <= set(ssmr_ident.__all__)
    assert {"fit_session", "compare_session", "diagnose_session"} <= asked


def _is_package(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id == "ssmr_ident"


def test_types_are_published_and_pandas_is_not_loaded_before_it_is_asked_for() -> None:
    assert (files("ssmr_ident") / "py.typed").is_file()
    code = "import sys, ssmr_ident.core.recording, ssmr_ident.core.parameter; print('pandas' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
