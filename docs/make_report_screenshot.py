"""Photograph a diagnosis' report, light and dark: ``python docs/make_report_screenshot.py``.

A robot whose tires stiffen is simulated, its logs are diagnosed as anyone would diagnose theirs, and the page that
``ident diagnose`` writes is opened in Debian's chromium (``apt-get install chromium``, ``pip install playwright``).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

IMAGES = Path(__file__).resolve().parent / "images"
MISSING = "nonlinear_stiffness:k3_N_m3=8e8"
AMPLITUDES_MM = (0.6, 1.2, 1.8)
SESSION = """\
schema: ssmr-ident/session/1
name: my-robot
robot: p3at-extended
recordings:
"""


def ident(*words: str, folder: Path) -> None:
    """Run ``ident`` as a reader would."""
    subprocess.run([sys.executable, "-m", "ssmr_ident", *words], cwd=folder, check=True)


def record(folder: Path) -> None:
    """Three decays each in roll, pitch and yaw of a robot whose tires stiffen."""
    session = folder / "my-session"
    session.mkdir()
    lines = [SESSION]
    for motion in ("roll", "pitch", "yaw"):
        for trial, amplitude in enumerate(AMPLITUDES_MM, 1):
            log = f"my-session/{motion}-{trial}.lvm"
            ident(
                "simulate", "p3at-extended", "--experiment", "free_response", "--motion", motion, "--noise", "--seed",
                str(trial), "--amplitude-mm", str(amplitude), "--effect", MISSING, "-o", log, "-q", folder=folder,
            )  # fmt: skip
            lines.append(f"  - {{file: {motion}-{trial}.lvm, experiment: free_response, motion: {motion}}}\n")
    (session / "session.yaml").write_text("".join(lines), encoding="utf-8")


def photograph(page: Path) -> None:
    """Write docs/images/report.png and report-dark.png: what is seen first, and what stands below it."""
    executable = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox"])
        for name, scheme, height in (("report", "light", 1500), ("report-dark", "dark", 800)):
            tab = browser.new_page(viewport={"width": 1280, "height": height}, color_scheme=scheme)
            tab.goto(page.resolve().as_uri())
            tab.screenshot(path=IMAGES / f"{name}.png")
            print(f"written to {IMAGES / name}.png")
        browser.close()


def main() -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        record(folder)
        ident("diagnose", "my-session", "-o", "out", folder=folder)
        photograph(folder / "out" / "report.html")


if __name__ == "__main__":
    main()
