"""Photograph the page of a diagnosis: ``python docs/make_report_screenshot.py``.

``ident demo`` hides dry friction in recordings of a rig; its page is opened on a laptop's screen
in Debian's chromium (``apt-get install chromium``, ``pip install playwright``).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from pictures import first_screen, keep
from playwright.sync_api import sync_playwright

IMAGE = Path(__file__).resolve().parent / "images" / "report.png"


def photograph(page: Path) -> None:
    """Write docs/images/report.png: the first screen."""
    executable = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox"])
        tab = browser.new_page(viewport={"width": 1280, "height": 560})
        tab.goto(page.resolve().as_uri())
        tab.wait_for_function("document.querySelector('figure.hero').chart !== undefined")
        tab.screenshot(path=IMAGE)
        browser.close()
    keep(IMAGE, "python docs/make_report_screenshot.py", first_screen(page.read_text(encoding="utf-8")))
    print(f"written to {IMAGE}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        subprocess.run([sys.executable, "-m", "ssmr_ident", "demo", "-q"], cwd=name, check=True)
        photograph(Path(name) / "out" / "demo-diagnosis" / "report.html")
