"""Pages in a real browser: quiet, complete, verdict at once, for all readers, on a phone, in the dark, on paper."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.slow

NAMES = ("hardening", "nothing", "undetermined", "swivel", "comparison", "spectrum", "fit", "changes")
Opened = Callable[..., Any]


@pytest.mark.parametrize("name", NAMES)
def test_quiet_and_complete(name: str, pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages[name])
    assert page.troubles == []
    missing = page.evaluate(
        "Promise.all([...document.querySelectorAll('img, svg image')].map(async (e) => {"
        " const i = new Image(); i.src = e.src ?? e.href.baseVal;"
        " try { await i.decode(); return i.naturalWidth > 0 ? null : i.src.slice(0, 60); }"
        " catch { return i.src.slice(0, 60); } })).then((r) => r.filter(Boolean))"
    )
    assert missing == []
    assert page.troubles == []


@pytest.mark.parametrize("name", NAMES)
def test_verdict_is_seen_without_scrolling(name: str, pages: dict[str, Path], opened: Opened) -> None:
    box = opened(pages[name]).locator("#verdict").bounding_box()
    assert box is not None
    assert box["y"] >= 0
    assert box["y"] + box["height"] <= 800


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(name: str, scheme: str, pages: dict[str, Path], opened: Opened) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed (extra: browser)")
    page = opened(pages[name], color_scheme=scheme)
    found = axe.Axe().run(page).response
    assert len(found["passes"]) > 10  # it did look
    grave = [v for v in found["violations"] if v["impact"] in ("serious", "critical") or "heading" in v["id"]]
    assert [(v["id"], [node["target"] for node in v["nodes"]][:3]) for v in grave] == []


@pytest.mark.parametrize("name", NAMES)
def test_phone_needs_no_sideways_scrolling(name: str, pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages[name], 390, 844)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_tables_sort_by_mouse_and_keyboard(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["hardening"])
    table = page.locator("table", has=page.get_by_role("button", name="log evidence")).first
    head = table.locator("th", has_text="log evidence")

    def column() -> list[float]:
        texts = table.locator("tbody tr td:nth-child(2)").all_inner_texts()
        return [float(text.replace("−", "-")) for text in texts]

    start = column()
    assert start != sorted(start)
    head.get_by_role("button").click()
    assert head.get_attribute("aria-sort") == "ascending"
    assert column() == sorted(start)
    head.get_by_role("button").focus()
    page.keyboard.press("Enter")
    assert head.get_attribute("aria-sort") == "descending"
    assert column() == sorted(start, reverse=True)
    first = table.locator("th").first
    first.get_by_role("button").click()
    assert head.get_attribute("aria-sort") is None
    names = table.locator("tbody tr td:nth-child(1)").all_inner_texts()
    assert names == sorted(names)


def test_figures_follow_the_dark(pages: dict[str, Path], opened: Opened) -> None:
    def paper_and_ink(scheme: str) -> tuple[int, int]:
        page = opened(pages["hardening"], color_scheme=scheme)
        found = page.evaluate(
            "[getComputedStyle(document.body).backgroundColor,"
            " getComputedStyle(document.querySelector('svg [id$=patch_1] path')).fill,"
            " getComputedStyle(document.querySelector('svg')).fill]"
        )
        body, patch, ink = (sum(map(int, re.findall(r"\d+", colour)[:3])) for colour in found)
        assert body == patch
        return patch, ink

    light, dark = paper_and_ink("light"), paper_and_ink("dark")
    assert light[0] > 600 > 200 > light[1]
    assert dark[0] < 200 < 500 < dark[1]


def test_paper_is_white_and_shows_hashes(pages: dict[str, Path], opened: Opened) -> None:
    page = opened(pages["hardening"], color_scheme="dark")
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert page.locator("footer details pre").is_visible()
    assert len(page.pdf(format="A4")) > 20_000
