"""The page of a diagnosis: what stands first, what every figure and number must carry, one file that loads nothing."""

from __future__ import annotations

import base64
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
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.report import style
from ssmr_ident.report.chart import packed
from ssmr_ident.report.curves import busiest_part, thinned
from ssmr_ident.report.diagnosis_page import diagnosis_page, render_report, write_report
from ssmr_ident.report.diagnosis_sections import scalar
from ssmr_ident.report.field_words import effect_words, explanation_words, place_words, sentence
from ssmr_ident.report.html import Number, Page, Table
from ssmr_ident.report.robot_figure import ACTS, NAMES, parts_of
from ssmr_ident.report.svg import inline
from ssmr_ident.session import read_parameters

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
    assert all(f["role"] == "img" and len(f["aria-label"] or "") > 20 for f in figures)
    charts = [attributes for tag, attributes in tags if tag == "div" and attributes.get("class") == "plot"]
    assert figures or charts
    assert all(c["tabindex"] == "0" and len(c["aria-label"] or "") > 20 for c in charts)
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
        (hardening, "Missing: nonlinear stiffness (cubic)", "found"),
        (nothing, "Nothing is missing", "clear"),
        (undetermined, "Undetermined: these recordings cannot name it", "open"),
        (swivel, "Missing: wheel eccentricity", "found"),
    ],
)
def test_first_screen_answers_what_where_how_sure_how_much_and_what_next(
    made: Callable[[], Diagnosis], label: str, tone: str
) -> None:
    verdict = page_of(made).verdict
    assert verdict is not None
    assert (verdict.label, verdict.tone) == (label, tone)
    assert [fact.label.split(" on ")[0] for fact in verdict.facts] == ["Error", "Where", "How sure", "Record next"]
    assert all(fact.value for fact in verdict.facts)


def test_before_after_and_noise_are_bars_beside_each_other() -> None:
    verdict = page_of(hardening).verdict
    assert verdict is not None
    better, where, sure, following = verdict.facts
    assert better.value == "22.0 → 3.4 %"
    assert [(b.value, round(b.share, 3)) for b in better.bars] == [("22.0 %", 1.0), ("3.4 %", 0.155), ("2.9 %", 0.132)]
    assert better.note == "lower by 17.1 … 20.2 points (95 % interval)"
    assert (where.value, where.note) == ("ay of roll-2.xlsx", "81 % of the misfit, |roll| > 1.5 deg")
    assert (sure.value, following.value) == ("99 %", "Nothing more")


def test_the_law_is_set_as_mathematics_with_what_was_measured_of_it() -> None:
    verdict = page_of(hardening).verdict
    assert verdict is not None
    (law,) = verdict.equations
    assert "<msup><mrow><mi>s</mi></mrow><mrow><mn>3</mn></mrow></msup>" in law
    assert '<msub><mi>k</mi><mi mathvariant="normal">3</mi></msub></math> = (3.10 ± 0.21)·10⁸ N/m³' in law


def test_a_rotary_rig_has_moments_and_angles() -> None:
    """Symbols, and units as the workflow hands them over."""
    torsion = ParameterSet("rig", {"inertia_kg_m2": Estimate(0.1, None, "kg m^2")})
    effect = replace(hardening().effects[0], parameters={"k3_N_m3": Estimate(6.2, 0.1, "N m/rad^3")})
    page = diagnosis_page(replace(hardening(), before=torsion, effects=(effect,)), "")
    assert page.verdict is not None
    assert "<mi>M</mi>" in page.verdict.equations[0]
    assert "<mi>θ</mi>" in page.verdict.equations[0]
    assert "N m/rad³" in page.verdict.equations[0]


def test_the_formula_has_the_name_of_the_field_and_the_sentence_no_numbers() -> None:
    told = CATALOGUE["dry_friction"].sentence.rstrip(".") + ": F_c_N = 0.4 ± 0.01 N."
    effect = replace(hardening().effects[0], id="dry_friction", form="tanh", sentence=told)
    verdict = diagnosis_page(replace(hardening(), effects=(effect,)), "").verdict
    assert verdict is not None
    assert verdict.label == "Missing: dry friction (Coulomb)"
    assert verdict.sentence == CATALOGUE["dry_friction"].sentence.rstrip(".") + "."


def test_a_kind_without_law_and_curve_has_no_formula() -> None:
    effect = replace(hardening().effects[0], id="unlisted", equation="F = f(s, v), drawn", parameters={}, form="")
    verdict = diagnosis_page(replace(hardening(), effects=(effect,)), "").verdict
    assert verdict is not None
    assert (verdict.label, verdict.equations) == ("Missing: a force that no listed law makes", ())


def test_a_force_of_any_shape_is_drawn_with_its_band() -> None:
    (chart,) = next(s for s in page_of(undetermined).sections if s.title == "What it could be").charts
    assert (chart.x_label, chart.x_unit, chart.y_unit, chart.band) == ("displacement", "m", "N", True)
    assert chart.lines[-1].y - chart.lines[-2].y == pytest.approx(2 * 1.96 * np.array([0.0, 0.1]))


def test_where_the_name_is_settled_what_is_left_is_said() -> None:
    left = replace(hardening(), heldout=PredictionQuality(22.0, 9.0, 2.9, ("roll-3.xlsx",)))
    verdict = diagnosis_page(left, "").verdict
    assert verdict is not None
    assert verdict.facts[3].value == "Nothing more"
    assert "3.1 times the noise is left" in verdict.facts[3].note


def test_what_no_law_is_has_the_words_of_its_kind_and_says_of_what_it_is_sure() -> None:
    effect = replace(
        hardening().effects[0], id="unlisted", form="any shape, over time", kind="changing", element="spring",
        confidence=0.02,
    )  # fmt: skip
    verdict = diagnosis_page(replace(hardening(), effects=(effect,)), "").verdict
    assert verdict is not None
    assert verdict.label == "Missing: a parameter that changes with time, by no listed law"
    assert (verdict.facts[2].value, verdict.facts[2].note[:27]) == ("above 99.9 %", "that something is missing; ")


def test_a_spring_stiffens_or_softens_and_a_rig_has_no_tires() -> None:
    rig = ParameterSet("rig", {"mass_kg": Estimate(2.0, None, "kg")})
    tires = ParameterSet("robot", {"tire.stiffness_y_N_m": Estimate(18000.0, None, "N/m")})
    softer = replace(hardening().effects[0], form="", parameters={"k3_N_m3": Estimate(-3e8, 2e7, "N/m^3")})
    assert sentence(softer, rig) == "The spring softens with deflection."
    assert sentence(hardening().effects[0], tires) == "The tires stiffen with deflection."
    assert effect_words(softer) == "nonlinear stiffness (cubic)"


def test_a_robot_is_drawn_with_what_the_answer_is_about_in_colour() -> None:
    robot = read_parameters("p3at-extended")
    page = diagnosis_page(replace(hardening(), before=robot, after=robot), "")
    (figure,) = next(s for s in page.sections if s.title == "The robot").figures
    assert "tires in colour" in figure.caption
    assert style.ORANGE.lower() in figure.drawings[0].svg.lower()
    assert parts_of(("sensor_delay", "free_play", "free_play")) == ("sensor", "tire")
    assert all(ACTS[e.id] in NAMES for e in CATALOGUE.values() if e.robot and e.id != "unlisted")


def test_explanations_of_a_network_say_where_they_are() -> None:
    network = ParameterSet("net", {"bodies.tip.mass_kg": Estimate(1.0)}, between={"blade": ("ground", "tip")})
    assert (place_words("blade", network), place_words("tip", network)) == ("spring blade", "body tip")
    assert explanation_words("nonlinear_stiffness (cubic) at blade", "nonlinear_stiffness").endswith("(cubic) at blade")


@pytest.mark.parametrize(
    "values",
    [np.linspace(0, 2, 401), np.array([1.0, 1.5, 1.4, np.nan, -3.0]), np.array([2.0]), np.array([np.nan, np.nan])],
)
def test_packed_numbers_come_back(values: np.ndarray) -> None:
    made = packed(values)
    if "data" not in made:
        back = made["low"] + made["step"] * np.arange(made["n"])
    else:
        words = np.frombuffer(base64.b64decode(made["data"]), "<u2")
        back = np.where(words == 2**16 - 1, np.nan, made["low"] + made["step"] * words.astype(float))
    span = np.nanmax(values) - np.nanmin(values) if np.isfinite(values).any() else 0.0
    np.testing.assert_allclose(back, values, atol=span / 2**16 + 1e-12)


def test_nothing_missing_shows_one_model_and_claims_no_gain() -> None:
    text = parsed(nothing).text
    assert "2.95 %" in text
    assert "2.91 %" in text
    for word in ("physics added", "improve", "model before", "Missing"):
        assert word not in text


def test_tie_names_all_and_says_what_to_record() -> None:
    verdict = page_of(undetermined).verdict
    assert verdict is not None
    better, _, sure, following = verdict.facts
    assert following.note.startswith("Sweep the force")
    assert (sure.value, sure.note) == ("3 candidates", "quadratic damping, dry friction, hysteresis")
    assert better.note == ""  # one held-out recording gives no interval


def test_parameters_carry_interval_and_unit() -> None:
    table = next(s for s in page_of(hardening).sections if s.title == "What was added").tables[0]
    assert [getattr(cell, "text", cell) for cell in table.rows[0][1:4]] == [
        "(3.10 ± 0.21)·10⁸", "(2.69 … 3.52)·10⁸", "N/m³",
    ]  # fmt: skip


def test_a_parameter_that_stood_in_shows_where_it_came_back_to() -> None:
    sections = {section.title: section for section in page_of(hardening).sections}
    row = [getattr(cell, "text", cell) for cell in sections["Parameters that stood in for it"].tables[0].rows[0]]
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
def test_a_page_of_24_recordings_is_below_a_megabyte_and_a_half() -> None:
    """Uneven times and noise pack worst; maps, surfaces and drifts as many as are drawn at the most."""
    full, rng = hardening(), np.random.default_rng(5)
    time = np.sort(rng.uniform(0.0, 30.0, 3000))
    overlays = tuple(
        replace(full.evidence.overlays[0], recording=f"roll-{k}.csv", channel=channel, time=time,
                **{name: rng.standard_normal(3000) for name in ("measured", "before", "after")})
        for k in range(24) for channel in ("ax", "ay", "az")
    )  # fmt: skip
    evidence = replace(
        full.evidence, overlays=overlays, maps=2 * full.evidence.maps, surfaces=2 * full.evidence.surfaces,
        drifts=2 * full.evidence.drifts,
    )  # fmt: skip
    located = 24 * full.located
    page = render_report(replace(full, evidence=evidence, located=located, tried=8 * full.tried), "", 0)
    assert len(page.encode()) < 1_500_000


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
        replace(nothing(), notes=("<script>alert(1)</script>",), session='"><img src=x>'), "a && b <c>", 0
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
