"""Photograph a terminal at work, a terminal with an answer, and a notebook: ``python docs/make_screenshots.py``.

Needs Debian's chromium (``apt-get install chromium``) and ``pip install playwright pyte nbconvert``. The terminal is a
real one: a command runs in a pseudo-terminal, a terminal emulator keeps its screen, and the screen is photographed.
"""

from __future__ import annotations

import html
import json
import os
import pty
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
from collections.abc import Iterator
from fcntl import ioctl
from pathlib import Path
from typing import Any

import nbformat
import pyte
from nbclient import NotebookClient
from nbconvert import HTMLExporter
from pictures import keep
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
WIDTH = 104
SHOWN = slice(2, 6)
"""Cells of the notebook."""
MAKES = {"terminal-progress": "progress", "terminal-new": "answer", "notebook": "notebook"}
"""The word behind the command that makes each picture."""
COLOURS = {"default": "#e6e6e6", "red": "#ff7b72", "green": "#7ee787", "brown": "#e3b341", "blue": "#79c0ff",
           "magenta": "#ff9bce", "cyan": "#76e3ea", "white": "#ffffff", "black": "#8b949e"}  # fmt: skip


def frames(command: list[str], rows: int, place: Path = ROOT) -> Iterator[pyte.Screen]:
    """The screen of a terminal in which ``ident …`` runs, after every piece of output; nobody answers its questions."""
    screen = pyte.Screen(WIDTH, rows)
    stream = pyte.ByteStream(screen)
    master, slave = pty.openpty()
    ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, WIDTH, 0, 0))
    environment = {key: value for key, value in os.environ.items() if key != "NO_COLOR"} | {"TERM": "xterm-256color"}
    with subprocess.Popen(
        [sys.executable, "-m", "ssmr_ident", *command],
        cwd=place, env=environment, stdin=subprocess.DEVNULL, stdout=slave, stderr=slave,
    ) as process:  # fmt: skip
        os.close(slave)
        try:
            while piece := _read(master):
                stream.feed(piece)
                yield screen
        finally:
            process.kill()  # nothing to a command that has ended
            os.close(master)


def _read(master: int) -> bytes:
    try:
        return os.read(master, 65536)
    except OSError:  # the command has ended
        return b""


def page_of(screen: pyte.Screen, command: list[str]) -> str:
    """A screen as a page, without its empty end."""
    lines = []
    for row in range(screen.lines):
        cells = [screen.buffer[row][column] for column in range(WIDTH)]
        text = "".join(_cell(cell) for cell in cells)
        lines.append(text if "".join(cell.data for cell in cells).strip() else "")
    while lines and not lines[-1]:
        lines.pop()
    typed = f'<span style="color:#7ee787">$</span> ident {html.escape(" ".join(command))}'
    body = "\n".join([typed, *lines])
    return (
        "<body style='margin:0;background:#0d1117'><pre style='margin:0;padding:18px 22px;display:inline-block;"
        f"color:#e6e6e6;font:14px/1.35 DejaVu Sans Mono,monospace'>{body}</pre></body>"
    )


def _cell(cell: Any) -> str:
    colour = COLOURS.get(cell.fg, f"#{cell.fg}")
    weight = ";font-weight:bold" if cell.bold else ""
    return f'<span style="color:{colour}{weight}">{html.escape(cell.data)}</span>'


def photograph(
    browser: Any, page: str, name: str, shows: str, width: int = 1000, height: int = 200, selector: str = "pre"
) -> None:
    """Write docs/images/NAME.png, and into it what it shows."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "page.html"
        file.write_text(page, encoding="utf-8")
        tab = browser.new_page(viewport={"width": width, "height": height}, device_scale_factor=1.5)
        tab.goto(file.as_uri())
        target = IMAGES / f"{name}.png"
        if selector:
            tab.locator(selector).first.screenshot(path=target)
        else:
            tab.screenshot(path=target)
        tab.close()
    keep(target, f"python docs/make_screenshots.py {MAKES[name]}", shows)
    print(f"written to {target}")


def progress(browser: Any) -> None:
    """The demo on a campaign, when it is comparing."""
    with tempfile.TemporaryDirectory() as out:
        command = ["demo", "--campaign", str(ROOT / "data"), "-o", out]
        for screen in frames(command, 14):
            if any("simulation against" in line for line in screen.display) and "━━" in screen.display[2]:
                last = page_of(screen, ["demo", "--campaign", "data", "-o", "out"])
                stages = "\n".join(line.split("━")[0].strip() for line in screen.display if "━" in line)
                if sum("simulation against" in line for line in screen.display) >= 2:
                    break
        photograph(browser, last, "terminal-progress", stages)


def answer(browser: Any) -> None:
    """What ident new says of a folder of logs."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "my-logs"
        folder.mkdir()
        raw = ROOT / "data" / "raw"
        for log in ("free_response/roll-1.xlsx", "free_response/pitch-1.xlsx", "pulls/concrete-lateral-rope-1.txt"):
            shutil.copy(raw / log, folder)
        command = ["new", "my-logs", "--robot", "p3at-extended"]
        *_, screen = frames(command, 20, Path(place))
        photograph(browser, page_of(screen, command), "terminal-new", "\n".join(screen.display).rstrip())


def source_of(path: Path) -> str:
    """What is typed in the cells of a notebook that are shown."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"][SHOWN]
    return "\n".join("".join(cell["source"]) for cell in cells)


def notebook(browser: Any) -> None:
    """The first notebook with its answers, from its second heading on."""
    path = ROOT / "notebooks" / "01_first_look.ipynb"
    book = nbformat.read(path, as_version=4)
    NotebookClient(book, timeout=300, resources={"metadata": {"path": str(path.parent)}}).execute()
    book.cells = book.cells[SHOWN]
    page, _ = HTMLExporter(template_name="lab").from_notebook_node(book)
    photograph(browser, page, "notebook", source_of(path), 900, 900, "")


def main() -> None:
    """All, or those named on the command line."""
    chosen = sys.argv[1:] or ["progress", "answer", "notebook"]
    executable = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox"])
        for name in chosen:
            {"progress": progress, "answer": answer, "notebook": notebook}[name](browser)
        browser.close()


if __name__ == "__main__":
    main()
