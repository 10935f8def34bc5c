"""Charts in a real browser: the first screen, zoom, read-out, export, keyboard, phone, dark and paper."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_diagnoses import EVERY, hardening

pytestmark = pytest.mark.slow

Opened = Callable[..., Any]
SCREENS = {"laptop": (1366, 768), "phone": (390, 844)}
DRAWN = "document.querySelector('figure.hero').chart !== undefined"


@pytest.fixture
def chart(pages: dict[str, Path], opened: Opened) -> Any:
    """The page of decays with its first chart drawn."""
    page = opened(pages["hardening"], 1366, 768)
    page.wait_for_function(DRAWN)
    return page


def span(page: Any) -> list[float]:
    return list(page.evaluate("document.querySelector('figure.hero').chart.span()"))


def settled(page: Any) -> None:
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


@pytest.mark.parametrize("screen", SCREENS)
@pytest.mark.parametrize("name", [make.__name__ for make in EVERY])
def test_first_screen_holds_verdict_picture_and_four_figures(
    name: str, screen: str, pages: dict[str, Path], opened: Opened
) -> None:
    width, height = SCREENS[screen]
    page = opened(pages[name], width, height)
    for part in ("#verdict .label", "#verdict .sentence", "#verdict .plot"):
        if part == "#verdict .plot" and name == "swivel":
            continue  # spectra over speed have a figure of their own below
        box = page.locator(part).bounding_box()
        assert box["y"] + box["height"] <= height, part
    values = page.locator("#verdict dd b")
    assert values.count() == 4
    for index in range(4):
        box = values.nth(index).bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
        assert box["y"] + box["height"] <= height


def test_a_drag_zooms_and_a_double_click_or_a_button_shows_all(chart: Any) -> None:
    whole = span(chart)
    box = chart.locator("figure.hero .u-over").first.bounding_box()
    y = box["y"] + box["height"] / 2
    chart.mouse.move(box["x"] + 0.25 * box["width"], y)
    chart.mouse.down()
    chart.mouse.move(box["x"] + 0.5 * box["width"], y, steps=4)
    chart.mouse.up()
    settled(chart)
    begin, end = span(chart)
    length = whole[1] - whole[0]
    assert begin == pytest.approx(whole[0] + 0.25 * length, abs=0.02 * length)
    assert end == pytest.approx(whole[0] + 0.5 * length, abs=0.02 * length)
    below = chart.evaluate("(() => { const s = document.querySelector('figure.hero').chart.panels[1].scales.x;"
                           " return [s.min, s.max]; })()")  # fmt: skip
    assert below == pytest.approx([begin, end])
    chart.locator("figure.hero .tools button", has_text="All").click()
    settled(chart)
    assert span(chart) == pytest.approx(whole)
    chart.locator("figure.hero .tools button", has_text="+").click()
    settled(chart)
    assert span(chart)[1] - span(chart)[0] == pytest.approx(length / 2)


def test_the_mouse_reads_the_values_at_its_place(chart: Any) -> None:
    overlay = hardening().evidence.overlays[0]
    box = chart.locator("figure.hero .u-over").first.bounding_box()
    chart.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 30)
    settled(chart)
    index = chart.evaluate("document.querySelector('figure.hero').chart.panels[0].cursor.idx")
    assert abs(index - 0.4 * len(overlay.time)) < 0.02 * len(overlay.time)
    read = [float(t.replace("−", "-")) for t in chart.locator("figure.hero .legend output").all_inner_texts()]
    courses = [overlay.measured, overlay.before, overlay.after]
    assert read == pytest.approx([c[index] for c in courses], rel=1e-3, abs=1e-4 * np.ptp(overlay.measured))
    at, seconds, unit = chart.locator("figure.hero .legend li").last.inner_text().split()
    assert (at, unit) == ("at", "s")
    assert float(seconds) == pytest.approx(overlay.time[index], abs=1e-4)


def test_keys_read_zoom_and_show_all(chart: Any) -> None:
    plot = chart.locator("figure.hero .plot")
    plot.focus()
    spoken = chart.locator("figure.hero .spoken")
    assert spoken.get_attribute("aria-live") == "polite"
    chart.keyboard.press("ArrowRight")
    first = spoken.inner_text()
    chart.keyboard.press("Shift+ArrowRight")
    second = spoken.inner_text()
    assert first.startswith("time 12")
    assert "recorded" in first
    assert first != second
    whole = span(chart)
    chart.keyboard.press("+")
    settled(chart)
    assert span(chart)[1] - span(chart)[0] < 0.7 * (whole[1] - whole[0])
    chart.keyboard.press("0")
    settled(chart)
    assert span(chart) == pytest.approx(whole)


def test_values_are_saved_as_csv(chart: Any) -> None:
    overlay = hardening().evidence.overlays[0]
    with chart.expect_download() as begun:
        chart.locator("figure.hero .tools button", has_text="CSV").click()
    assert begun.value.suggested_filename == "overlay-1.csv"
    text = Path(begun.value.path()).read_text(encoding="utf-8").splitlines()
    assert text[0] == "time [s],recorded [m/s²],model before [m/s²],after [m/s²]"
    read = np.array([[float(cell) for cell in row.split(",")] for row in text[1:]])
    wanted = np.column_stack([overlay.time, overlay.measured, overlay.before, overlay.after])
    np.testing.assert_allclose(read, wanted, atol=np.ptp(overlay.measured) / 2**15, rtol=1e-6)


def test_the_picture_is_saved_as_png(chart: Any) -> None:
    with chart.expect_download() as begun:
        chart.locator("figure.hero .tools button", has_text="PNG").click()
    data = Path(begun.value.path()).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", data[16:24])
    assert width > 400
    assert height > 400
    assert len(data) > 10_000  # something is drawn on it


def coloured(page: Any, colour: tuple[int, int, int]) -> int:
    """Pixels of the first chart's upper panel that have nearly this colour."""
    return int(page.evaluate(
        "([r, g, b]) => { const c = document.querySelector('figure.hero canvas');"
        " const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0;"
        " for (let k = 0; k < d.length; k += 4) n += Math.abs(d[k] - r) + Math.abs(d[k+1] - g)"
        " + Math.abs(d[k+2] - b) < 12 && d[k+3] > 200; return n; }", list(colour)))  # fmt: skip


BLUE, BLUE_ON_DARK = (0x00, 0x72, 0xB2), (0x5C, 0xB3, 0xEE)


def test_charts_follow_the_dark_and_turn_light_on_paper(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["hardening"], 1366, 768, color_scheme="dark")
    page.wait_for_function(DRAWN)
    settled(page)
    assert coloured(page, BLUE_ON_DARK) > 100 > coloured(page, BLUE)
    page.emulate_media(color_scheme="light")
    settled(page)
    assert coloured(page, BLUE) > 100 > coloured(page, BLUE_ON_DARK)
    page.emulate_media(color_scheme="dark")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    settled(page)
    assert coloured(page, BLUE) > 100 > coloured(page, BLUE_ON_DARK)
    assert page.locator("figure.chart canvas").count() == 2 * page.locator("figure.chart").count()  # all are drawn
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    settled(page)
    assert coloured(page, BLUE_ON_DARK) > 100


def test_without_a_script_the_page_says_what_is_to_be_seen(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["hardening"], java_script_enabled=False)
    assert "error 22 % before" in page.locator("figure.hero noscript").inner_text()
    assert page.locator("#verdict .label").is_visible()
