"""The page of a diagnosis in Firefox: first screen, zoom, read-out by keys, export, paper, no request to outside."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_diagnoses import hardening

pytestmark = pytest.mark.slow

HERO = "document.querySelector('figure.hero')"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    pytest.importorskip("websockets", reason="websockets is not installed (extra: browser)")
    driver = importlib.import_module("firefox_by_bidi")
    if driver.FIREFOX is None:
        pytest.skip("no Firefox on this machine")
    with driver.firefox() as opened:
        yield opened


@pytest.mark.parametrize(("width", "height"), [(1366, 768), (500, 844)])  # a window of Firefox is 450 wide at least
def test_first_screen_holds_verdict_picture_and_figures(
    width: int, height: int, browser: Any, pages: dict[str, Path]
) -> None:
    browser.open(pages["hardening"], width, height)
    ends = browser.evaluate(
        "['.label', '.sentence', '.plot', 'dd b'].map((part) =>"
        " Math.max(...[...document.querySelectorAll('#verdict ' + part)].map((e) => e.getBoundingClientRect().bottom)))"
    )
    assert max(ends) <= height
    assert browser.evaluate("document.documentElement.scrollWidth") <= width
    assert browser.evaluate(f"{HERO}.querySelectorAll('canvas').length") > 0
    assert browser.troubles == []


def test_zoom_read_out_and_export(browser: Any, pages: dict[str, Path]) -> None:
    overlay = hardening().evidence.overlays[0]
    browser.open(pages["hardening"], 1366, 768)
    whole = browser.evaluate(f"{HERO}.chart.span()")
    left, top, width = browser.evaluate(
        f"(() => {{ const b = {HERO}.querySelector('.u-over').getBoundingClientRect();"
        " return [b.left, b.top + b.height / 2, b.width]; })()"
    )
    browser.drag((left + 0.25 * width, top), (left + 0.5 * width, top))
    begin, end = browser.evaluate(f"{HERO}.chart.span()")
    length = whole[1] - whole[0]
    assert [(begin - whole[0]) / length, (end - whole[0]) / length] == pytest.approx([0.25, 0.5], abs=0.02)
    browser.evaluate(f"{HERO}.querySelector('.plot').focus()")
    browser.keys("0", "\ue014")  # the arrow to the right
    assert browser.evaluate(f"{HERO}.chart.span()") == pytest.approx(whole)
    assert "recorded" in browser.evaluate(f"{HERO}.querySelector('.spoken').textContent")
    text = browser.evaluate(
        "new Promise((done) => { const make = URL.createObjectURL;"
        " URL.createObjectURL = (blob) => { blob.text().then(done); URL.createObjectURL = make; return make(blob); };"
        f" [...{HERO}.querySelectorAll('.tools button')].find((b) => b.textContent === 'CSV').click(); }})"
    )
    read = np.array([[float(cell) for cell in row.split(",")] for row in text.splitlines()[1:]])
    wanted = np.column_stack([overlay.time, overlay.measured, overlay.before, overlay.after])
    np.testing.assert_allclose(read, wanted, atol=np.ptp(overlay.measured) / 2**15, rtol=1e-6)
    assert browser.troubles == []


def test_paper_has_every_chart(browser: Any, pages: dict[str, Path]) -> None:
    browser.open(pages["hardening"], 1366, 768)
    made = browser.call("browsingContext.print", context=browser.window)["data"]
    assert len(made) > 20_000
    assert browser.evaluate("document.querySelectorAll('figure.chart:not([data-drawn])').length") == 0
