"""The page of a diagnosis: what stands first, what every figure and number must carry, one file that loads nothing."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from made_diagnoses import EVERY, hardening, nothing, swivel, undetermined

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.diagnosis import Conflict, Diagnosis, PredictionQuality, Tried
from ssmr_ident.diagnose.evidence import Evidence, ForceSurface, SpeedMap
from ssmr_ident.report.curves import busiest_part, thinned
from ssmr_ident.report.diagnosis_page import diagnosis_page, render_report, write_report
from ssmr_ident.report.diagnosis_pictures import scalar
from ssmr_ident.report.html import Number, Page, Table
from ssmr_ident.report.svg import inline

pytestmark = pytest.mark.slow


class _Elements(HTMLParser):
    """All start tags with their attributes, and the text."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data


@cache
def rendered(made: Callable[[], Diagnosis]) -> str:
    """Drawn once for every test that looks at it."""
    return render_report(made(), "ident diagnose my-session -o out --seed 3", 3)


@cache
def page_of(made: Callable[[], Diagnosis]) -> Page:
    return diagnosis_page(made(), "")


def parsed(made: Callable[[], Diagnosis]) -> _Elements:
    page = _Elements()
    page.feed(rendered(made))
    return page


@pytest.mark.parametrize("made", EVERY)
def test_figures_have_words_and_ids_are_unique(made: Callable[[], Diagnosis]) -> None:
    tags = parsed(made).tags
    figures = [attributes for tag, attributes in tags if tag == "svg"]
    assert figures
    assert all(f["role"] == "img" and len(f["aria-label"] or "") > 20 for f in figures)
    assert sum(tag == "figcaption" for tag, _ in tags) == sum(tag == "figure" for tag, _ in tags)
    ids = [attributes["id"] for _, attributes in tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    referred = {
        value[1:] for _, a in tags for key, value in a.items() if value and key.endswith("href") and value[0] == "#"
    }
    assert referred <= set(ids)


@pytest.mark.parametrize("made", EVERY)
def test_page_loads_nothing(made: Callable[[], Diagnosis]) -> None:
    for tag, attributes in parsed(made).tags:
        assert tag not in ("iframe", "object", "embed")
        for key in ("src", "href", "xlink:href", "action", "srcset"):
            assert (attributes.get(key) or "#").startswith(("#", "data:")), (tag, attributes)
    assert not re.search(r"@import|url\((?!#)", rendered(made))


@pytest.mark.parametrize(
    ("made", "label", "tone"),
    [
        (hardening, "Missing physics: nonlinear stiffness", "found"),
        (nothing, "Nothing is missing", "clear"),
        (undetermined, "Undetermined: these recordings cannot tell what is missing", "open"),
        (swivel, "Missing physics: wheel eccentricity", "found"),
    ],
)
def test_verdict_says_what_was_found(made: Callable[[], Diagnosis], label: str, tone: str) -> None:
    verdict = page_of(made).verdict
    assert verdict is not None
    assert (verdict.label, verdict.tone, verdict.sentence) == (label, tone, made().summary)


def test_verdict_holds_before_after_noise_and_interval() -> None:
    verdict = page_of(hardening).verdict
    assert verdict is not None
    assert [fact.value for fact in verdict.facts[:3]] == ["22.0 %", "3.4 %", "2.9 %"]
    assert "17.1 … 20.2 %" in verdict.facts[1].note
    assert "(3.10 ± 0.21)·10⁸ N/m³" in verdict.equation
    assert [round(fact.share or 0, 3) for fact in verdict.facts[:3]] == [1.0, 0.155, 0.132]


def test_nothing_missing_shows_one_model_and_claims_no_gain() -> None:
    text = parsed(nothing).text
    assert "2.95 %" in text
    assert "2.91 %" in text
    for word in ("physics added", "improve", "model before", "Missing"):
        assert word not in text


def test_tie_names_all_and_puts_the_next_experiment_first() -> None:
    verdict = page_of(undetermined).verdict
    assert verdict is not None
    assert verdict.advice.startswith("Sweep the force")
    assert "quadratic damping, dry friction, hysteresis" in verdict.facts[-1].note
    assert "one held-out recording gives no interval" in verdict.facts[1].note


def test_parameters_carry_interval_and_unit() -> None:
    table = page_of(hardening).sections[0].tables[0]
    assert [getattr(cell, "text", cell) for cell in table.rows[0]] == [
        "nonlinear stiffness", "k3_N_m3", "(3.10 ± 0.21)·10⁸", "(2.69 … 3.52)·10⁸", "N/m³",
    ]  # fmt: skip


def test_absorption_account_shows_where_a_parameter_came_back_to() -> None:
    sections = {section.title: section for section in page_of(hardening).sections}
    row = [getattr(cell, "text", cell) for cell in sections["What it had been hidden in"].tables[0].rows[0]]
    assert row == ["inertia_kg_m2.xx", "1.210 ± 0.050", "1.940 ± 0.020", "1.220 ± 0.020", "kg m²", "+14.6"]


def test_a_component_of_an_array_is_found() -> None:
    parameters = ParameterSet("robot", {"accelerometer.position_m": Estimate(np.array([0.1, 0.2, 0.3]), 0.01, "m")})
    found = scalar(parameters, "accelerometer.position_m.z")
    assert found is not None
    assert (found.value, found.std) == (0.3, 0.01)
    assert scalar(parameters, "accelerometer.position_m") is None
    assert scalar(parameters, "accelerometer.bandwidth_hz") is None


def test_the_end_tells_command_version_seed_and_hashes(tmp_path: Path) -> None:
    logs = [tmp_path / "session" / name for name in ("a.csv", "sub/b.csv")]
    for log in logs:
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text(log.name)
    out = tmp_path / "out"
    out.mkdir()
    path = write_report(hardening(), out / "report.html", "ident diagnose session -o out --seed 5", 5, logs)
    text = path.read_text(encoding="utf-8")
    end = text[text.index("<footer>") :]
    assert "ident diagnose session -o out --seed 5" in end
    assert re.search(r"ssmr_ident \d+\.\d+\.\d+", end)
    assert "<dt>Seed</dt><dd>5</dd>" in end
    for log, name in zip(logs, ("a.csv", "sub/b.csv"), strict=True):
        assert f"{hashlib.sha256(log.read_bytes()).hexdigest()}  {name}" in end
    assert str(tmp_path) not in text
    figures = sorted(figure.name for figure in (out / "figures").iterdir())
    assert "overlay-1.svg" in figures
    assert "residual-map-1-before.svg" in figures
    assert len(figures) == text.count("<svg ")


@pytest.mark.slow
def test_same_diagnosis_same_page() -> None:
    again = render_report(undetermined(), "ident diagnose my-session -o out --seed 3", 3)
    assert again == rendered(undetermined)


@pytest.mark.slow
def test_few_speeds_are_drawn_as_lines_and_many_as_maps() -> None:
    def names(speeds: SpeedMap) -> list[str]:
        evidence = replace(swivel().evidence, speeds=(speeds,))
        sections = diagnosis_page(replace(swivel(), evidence=evidence), "").sections
        figures = [f for s in sections for f in s.figures if "turning speed" in f.title]
        return [d.name for f in figures for d in f.drawings]

    full = swivel().evidence.speeds[0]
    assert names(full) == ["waterfall-1-recorded", "waterfall-1-before", "waterfall-1-after", "levels-1"]
    twice = np.array([0, 0, 3, 3])
    few = replace(
        full, speed=full.speed[twice], recorded=full.recorded[twice], before=full.before[twice],
        after=full.after[twice], lines=(("beyond", np.full(4, 99.0)), *((n, c[twice]) for n, c in full.lines)),
        names=("target", "held out") * 2,
    )  # fmt: skip
    assert names(few) == ["waterfall-1"]


@pytest.mark.slow
def test_poor_evidence_is_drawn_as_it_is() -> None:
    """One point, one column, no number: what a short or failed fit leaves."""
    full, few = hardening(), np.array([0.001, 0.002])
    evidence = replace(
        full.evidence,
        maps=(
            replace(full.evidence.maps[0], time=np.array([1.0]), before=np.full((50, 1), 9.0), after=np.zeros((50, 1))),
        ),
        surfaces=(ForceSurface("r", "w", few, few, few, few), ForceSurface("r", "w", *(np.array([]),) * 4)),
        drifts=(replace(full.evidence.drifts[0], **{k: np.array([1.0]) for k in ("position", "value", "std")}),),
    )
    poor = replace(
        full,
        evidence=evidence,
        tried=(Tried("nonlinear_stiffness", float("nan"), float("-inf")), Tried("baseline", 0.0, 0.0)),
        conflicts=(Conflict("mass_kg", 2.0, 2.0, 0.0, "kg"), Conflict("tire.x", 0.0, 1.0, float("inf"), "m")),
        heldout=PredictionQuality(0.0, 0.0, float("nan")),
    )
    page = render_report(poor, "", 0)
    assert "nan%" not in page
    assert page.count("force-surface") == 0  # names are of files only
    names = [d.name for s in diagnosis_page(poor, "").sections for f in s.figures for d in f.drawings]
    assert [n for n in names if n.startswith("force-surface")] == ["force-surface-1-before", "force-surface-1-after"]


def test_text_from_outside_is_escaped() -> None:
    page = render_report(
        replace(nothing(), summary="<script>alert(1)</script>", session='"><img src=x>'), "a && b <c>", 0
    )
    assert "<script>alert" not in page
    assert "<img" not in page


def test_a_name_that_turns_the_line_round_or_fills_a_page_is_shown_as_text() -> None:
    name = "<b>\"quoted' \u202egpj.exe " + "x" * 4000
    page = render_report(replace(nothing(), session=name), f"ident diagnose {name}", 0)
    assert "\u202e" not in page
    assert "U+202E" in page
    assert "<b>&quot;" not in page
    assert "&lt;b&gt;" in page
    assert "x" * 4000 in page
    assert "overflow-wrap: break-word" in page  # so that it cannot push the page wider


@pytest.mark.slow
@pytest.mark.parametrize("made", EVERY)
def test_a_diagnosis_without_figures_still_makes_a_page(made: Callable[[], Diagnosis]) -> None:
    bare = replace(made().without_evidence(), tried=(), conflicts=(), located=(), notes=(), next_experiment="")
    page = diagnosis_page(bare, "")
    assert bare.evidence == Evidence() or not bare.evidence.overlays
    assert not any(section.figures for section in page.sections)
    assert page.verdict is not None


def test_colours_follow_the_page_and_keep_their_own_as_fallback() -> None:
    svg = '<svg width="280.8pt" height="10pt"><path id="p" style="stroke: #0072b2"/><use xlink:href="#p"/></svg>'
    made = inline(svg, "d7", 'a "quoted" word')
    assert 'style="stroke: var(--f0072b2, #0072b2)"' in made
    assert 'id="d7-p"' in made
    assert 'xlink:href="#d7-p"' in made
    assert 'aria-label="a &quot;quoted&quot; word"' in made


def test_columns_of_numbers_are_told_from_columns_of_words() -> None:
    rows = (("a", "−1.5", "2 of 3 roll", Number("(1 ± 2)", 1.0)), ("b", "–", "roll", Number("–", float("nan"))))
    table = Table("", ("name", "value", "word", "number"), rows)
    assert table.numeric == (False, True, False, True)


def test_drawn_part_is_where_it_matters() -> None:
    time = np.arange(0, 100, 0.01)
    course = np.sin(2 * np.pi * time)
    matter = np.where((time > 60) & (time < 70), 1.0, 0.01)
    part = busiest_part(course, matter, 20)
    assert time[part][0] <= 60 + 0.01
    assert time[part][-1] >= 70 - 0.01
    assert 19 < time[part][-1] - time[part][0] < 21
    assert busiest_part(course[:500], matter[:500], 20) == slice(0, 500)


def test_thinning_keeps_extremes_in_order() -> None:
    random = np.random.default_rng(1)
    x, y = np.arange(50_000.0), random.standard_normal(50_000)
    kept_x, kept_y = thinned(x, y, 400)
    assert len(kept_x) <= 400
    assert np.all(np.diff(kept_x) > 0)
    assert kept_y.max() == y.max()
    assert kept_y.min() == y.min()
