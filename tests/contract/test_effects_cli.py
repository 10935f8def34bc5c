"""``ident effects``: the list, one effect as text and JSON, its figure, a misspelt name; the page made from it."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ssmr_ident import cli
from ssmr_ident.core.errors import InputError
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.workflows.effects.panels import cycles, panels

RUN = CliRunner()


def _out(*arguments: str) -> str:
    result = RUN.invoke(cli.app, ["effects", *arguments])
    assert result.exit_code == 0, result.output
    return result.stdout


def test_the_list_names_every_effect_once_with_its_sentence() -> None:
    text = _out()
    starts = [line.split()[0] for line in text.splitlines() if line and not line.startswith(" ")]
    assert starts[: len(CATALOGUE)] == list(CATALOGUE)
    flat = " ".join(text.split())
    for effect in CATALOGUE.values():
        assert " ".join(effect.sentence.split()) in flat
    assert json.loads(_out("--json"))[0]["id"] == next(iter(CATALOGUE))


@pytest.mark.slow
@pytest.mark.parametrize("effect_id", sorted(CATALOGUE))
def test_one_effect_as_text_and_values(effect_id: str) -> None:
    effect = CATALOGUE[effect_id]
    text = _out(effect_id)
    for part in (effect.sentence, effect.equation, effect.signature, effect.source):
        assert part in text
    answer = json.loads(_out(effect_id, "--json"))
    assert answer["figure"] is None
    for told, parameter in zip(answer["parameters"], effect.parameters, strict=True):
        assert f"{parameter.name} " in text
        assert told["unit"] == parameter.unit
        assert float(told["upper"]) == parameter.upper
        assert (told["off"] is None) == (parameter.off is None)


def test_a_misspelt_name_is_answered_in_one_line_with_the_nearest(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["ident", "effects", "dry_frction"])
    with pytest.raises(SystemExit) as stop:
        cli.main()
    assert stop.value.code == 2
    complaint = capsys.readouterr().err
    assert complaint.count("\n") == 1
    assert "Did you mean 'dry_friction'?" in complaint


@pytest.mark.slow
def test_a_figure_is_written_where_asked_and_nowhere_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert "-o free_play.png" in _out("free_play")
    assert not list(tmp_path.iterdir())
    assert "figure: here.svg" in _out("free_play", "-o", "here.svg")
    assert [path.name for path in tmp_path.iterdir()] == ["here.svg"]
    assert Path("here.svg").stat().st_size > 10_000


@pytest.mark.parametrize("place", ["figure.gif", "figure"])
def test_another_ending_is_refused(place: str, tmp_path: Path) -> None:
    result = RUN.invoke(cli.app, ["effects", "free_play", "-o", str(tmp_path / place)])
    assert isinstance(result.exception, InputError)
    assert not list(tmp_path.iterdir())


def test_a_figure_of_the_whole_list_is_refused() -> None:
    assert isinstance(RUN.invoke(cli.app, ["effects", "-o", "x.png"]).exception, InputError)


def test_the_reference_page_is_what_the_catalogue_says(root: Path) -> None:
    page = runpy.run_path(str(root / "docs" / "make_effects.py"))["page"]()
    assert (root / "docs" / "reference" / "effects.md").read_text(encoding="utf-8") == page


@pytest.mark.slow
@pytest.mark.parametrize("effect_id", ["dry_friction", "motor_belt", "ground_joints", "translation_coupling"])
def test_panels_show_a_difference_with_units_on_every_axis(effect_id: str) -> None:
    effect = CATALOGUE[effect_id]
    found = panels(effect, effect.values())
    assert 2 <= len(found) <= 4
    for panel in found:
        assert "[" in panel.x_label
        assert "[" in panel.y_label
        plain, *changed = panel.curves
        assert plain.role == "without"
        for curve in changed:
            assert curve.x.shape == curve.y.shape
            assert np.isfinite(curve.y).all()
            assert curve.y.shape != plain.y.shape or not np.array_equal(curve.y, plain.y)


def test_cycles_of_a_known_decay() -> None:
    """8 Hz and 3 % damping, measured cycle by cycle."""
    time = np.arange(3000) / 1000.0
    omega, xi = 2 * np.pi * 8.0, 0.03
    course = np.exp(-xi * omega * time) * np.cos(omega * np.sqrt(1 - xi**2) * time)
    amplitude, hertz, ratio = cycles(course, 1000.0)
    assert len(amplitude) > 10
    assert hertz == pytest.approx(8.0 * np.sqrt(1 - xi**2), rel=1e-3)
    assert ratio == pytest.approx(xi / np.sqrt(1 - xi**2), rel=0.02)
