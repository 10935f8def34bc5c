"""A real browser, where there is one: Debian's Chromium by Playwright."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_diagnoses import EVERY, hardening, nothing
from made_fit import made_fit

from ssmr_ident.compare import Comparison, RecordingComparison
from ssmr_ident.compare.change import Side, changes
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.report.changes_page import changes_page
from ssmr_ident.report.comparison_page import comparison_page
from ssmr_ident.report.diagnosis_page import write_report
from ssmr_ident.report.html import write_page
from ssmr_ident.workflows.fit.page import fit_page
from ssmr_ident.workflows.spectrum.page import write_spectrum_page
from ssmr_ident.workflows.spectrum.run import spectrum

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """A headless browser; skips where none is installed."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed (extra: browser)")
    if CHROMIUM is None:
        pytest.skip("no Chromium on this machine")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Every page of this project that can be made without minutes of fitting, by name."""
    folder = tmp_path_factory.mktemp("pages")
    made = {}
    for make in EVERY:
        path = folder / make.__name__ / "report.html"
        path.parent.mkdir()
        log = path.parent / "roll-1.csv"
        log.write_text("time [s],ay [m/s^2]\n0,0\n", encoding="utf-8")
        made[make.__name__] = write_report(make(), path, "ident diagnose my-session -o out", 0, [log])
    made["comparison"] = _comparison(folder)
    made["spectrum"] = _spectrum(folder)
    made["fit"] = _fit(folder)
    made["changes"] = _changes(folder)
    return made


def _comparison(folder: Path) -> Path:
    random = np.random.default_rng(0)
    time = np.arange(0, 2, 0.005)
    courses = np.column_stack([np.exp(-time) * np.sin(2 * np.pi * f * time) for f in (5.0, 8.0)])
    noise = 0.05 * random.standard_normal(courses.shape)
    prediction = Prediction(time, ("ax", "ay"), ("m/s^2", "m/s^2"), courses + noise, courses)
    recordings = tuple(
        RecordingComparison(
            f"roll-{k}.csv", "free_response", "nrmse_percent", 9.0 - k, {"ax": 9.0, "ay": 8.0}, prediction
        )
        for k in range(8)
    )
    page = comparison_page(Comparison("my-session", "params.yaml", recordings), "ident compare my-session", ())
    (folder / "comparison").mkdir()
    return write_page(folder / "comparison" / "report.html", page)


def _spectrum(folder: Path) -> Path:
    out = folder / "spectrum"
    out.mkdir()
    time = np.arange(0, 10, 0.005)
    lines = ["time [s],ax [m/s^2],ay [m/s^2]"]
    lines += [f"{t:.3f},{np.sin(40 * t):.5f},{0.3 * np.sin(90 * t):.5f}" for t in time]
    log = out / "log.csv"
    log.write_text("\n".join(lines) + "\n", encoding="utf-8")
    write_spectrum_page(spectrum([log]), out, "ident spectrum log.csv -o spectrum", [log])
    return out / "report.html"


@pytest.fixture
def opened(chromium: Any) -> Iterator[Callable[..., Any]]:
    """Open a page; every message of the console, every failed or outside request is gathered in ``page.troubles``."""
    contexts = []

    def open_page(path: Path, width: int = 1280, height: int = 800, **options: Any) -> Any:
        context = chromium.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        page.troubles = []
        own = path.resolve().as_uri()
        page.on("console", lambda message: page.troubles.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: page.troubles.append(f"error: {error}"))
        page.on("requestfailed", lambda request: page.troubles.append(f"failed: {request.url}"))
        page.on(
            "request",
            lambda request: request.url == own or request.url[:5] == "data:" or page.troubles.append(request.url),
        )
        page.goto(own)
        return page

    yield open_page
    for context in contexts:
        context.close()


def _fit(folder: Path) -> Path:
    (folder / "fit").mkdir()
    page = fit_page(made_fit(), "ident fit my-session --figures fit", 3, ())
    return write_page(folder / "fit" / "report.html", page)


def _changes(folder: Path) -> Path:
    (folder / "changes").mkdir()
    robots = (diagnosis.after for diagnosis in (hardening(), nothing()))
    sides = [
        Side(name, robot, verdict, effects, "nrmse_percent", error)
        for name, robot, verdict, effects, error in zip(
            ("march", "june"), robots, ("missing_physics", "nothing_missing"), (("nonlinear_stiffness",), ()),
            ((22.0, 3.4, 2.9), (2.95, 2.95, 2.91)), strict=True,
        )
    ]  # fmt: skip
    page = changes_page(changes(*sides), "ident compare march june", ())
    return write_page(folder / "changes" / "report.html", page)
