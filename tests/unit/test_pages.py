"""Pages of fits, comparisons and spectra: what stands first, and that numbers carry unit and interval."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from made_fit import made_fit

from ssmr_ident.cli.called import called
from ssmr_ident.report.dark import on_dark
from ssmr_ident.report.html import render_page
from ssmr_ident.workflows.fit.page import fit_page
from ssmr_ident.workflows.spectrum.page import spectrum_page
from ssmr_ident.workflows.spectrum.run import spectrum


def test_fit_page_says_conflict_first_and_what_was_learnt_most() -> None:
    page = fit_page(made_fit(), "ident fit my-session", 7, ())
    assert page.verdict is not None
    assert page.verdict.label == "1 parameter found from 2 recordings"
    assert page.verdict.sentence == "One is in conflict with what was known before: mass_kg."
    assert [(f.label, f.value, f.note) for f in page.verdict.facts] == [
        ("mass_kg", "33.040 ± 0.020 kg", "95 %: 33.001 … 33.079")
    ]
    text = render_page(page)
    assert "<dt>Seed</dt><dd>7</dd>" in text
    assert "the mass is not what the scales said" in text


@pytest.mark.slow
def test_spectrum_page_finds_the_line_that_is_there(tmp_path: Path) -> None:
    time = np.arange(0, 10, 0.005)
    log = tmp_path / "log.csv"
    lines = ["time [s],ax [m/s^2]", *(f"{t:.3f},{np.sin(2 * np.pi * 6.25 * t):.5f}" for t in time)]
    log.write_text("\n".join(lines) + "\n", encoding="utf-8")
    page = spectrum_page(spectrum([log]), "ident spectrum log.csv", [log])
    assert page.verdict is not None
    assert page.verdict.label == "1 recording, strongest line at 6.25 Hz"
    assert float(page.verdict.facts[0].value.removesuffix(" Hz")) == pytest.approx(6.25, abs=1e-6)
    assert page.verdict.facts[0].note.endswith("m/s²")
    assert page.files[0][0] == "log.csv"


def test_the_call_can_be_typed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["/usr/bin/ident", "compare", "my session", "-o", "out"])
    assert called() == "ident compare 'my session' -o out"


@pytest.mark.parametrize("colour", ["#1b3a57", "#b5482f", "#2a7f62", "#0072b2", "#808080", "#1a1a1a"])
def test_any_colour_that_reads_on_white_reads_in_the_dark(colour: str) -> None:
    """Contrast by WCAG 2.2 at least 3 to 1 on both papers, as asked of graphical objects."""
    assert _contrast(colour, "#ffffff") > 3
    assert _contrast(on_dark(colour), "#16181b") > 3


def _contrast(first: str, second: str) -> float:
    def luminance(colour: str) -> float:
        parts = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
        linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    dark, light = sorted((luminance(first), luminance(second)))
    return (light + 0.05) / (dark + 0.05)
