"""Self-contained pages: text, tables and figures as values, one template, no network."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import resources
from itertools import count
from pathlib import Path

import jinja2
from markupsafe import Markup
from matplotlib.figure import Figure

from ssmr_ident import __version__
from ssmr_ident.core.atomic import write_text
from ssmr_ident.report.chart import Chart
from ssmr_ident.report.dark import declarations
from ssmr_ident.report.svg import colours, drawn, inline

_BEGINS_WITH_NUMBER = re.compile(r"^\(?[−+-]?(\d|∞)|^–$")


@dataclass(frozen=True)
class Number:
    """A cell that is sorted by ``value`` and reads as ``text``; ``share`` (0 … 1) draws a bar below it."""

    text: str
    value: float
    share: float | None = None


@dataclass(frozen=True)
class Formula:
    """A cell that holds a name or a law as MathML, as :mod:`ssmr_ident.report.mathml` makes it."""

    mathml: str


@dataclass(frozen=True)
class Link:
    """A cell that leads to a file beside the page."""

    text: str
    target: str


Cell = str | Number | Link | Formula


@dataclass(frozen=True)
class Table:
    """A table; columns whose cells mostly begin with a number are set as numbers. Readers may sort by any column."""

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    @cached_property
    def numeric(self) -> tuple[bool, ...]:
        """Which columns are set as numbers; asked of each cell, so looked for once."""
        return tuple(column > 0 and self._mostly_numbers(column) for column in range(len(self.header)))

    def _mostly_numbers(self, column: int) -> bool:
        cells = [cell for row in self.rows if (cell := row[column]) not in ("", "–")]
        numbers = sum(
            isinstance(cell, Number) or (isinstance(cell, str) and bool(_BEGINS_WITH_NUMBER.match(cell)))
            for cell in cells
        )
        return numbers > len(cells) / 2


@dataclass(frozen=True)
class Drawing:
    """One drawing as SVG text; ``alt`` says it in words, ``name`` is its file's where it is written beside the page.

    ``white`` keeps it on white in the dark, too: for drawings with dark lines as pixels, which no style sheet reaches.
    """

    svg: str
    alt: str
    name: str = ""
    white: bool = False


@dataclass(frozen=True)
class Picture:
    """One or several drawings under one caption; side by side where there is room."""

    drawings: tuple[Drawing, ...]
    caption: str
    title: str = ""

    @property
    def wide(self) -> bool:
        """Whether it is a single drawing too wide for a phone."""
        return len(self.drawings) == 1 and float(self.drawings[0].svg.split('width="')[1].split("pt")[0]) > 400


@dataclass(frozen=True)
class Section:
    """A heading with what stands below it; ``points`` are set as a list, charts before figures."""

    title: str
    paragraphs: tuple[str, ...] = ()
    points: tuple[str, ...] = field(default=(), kw_only=True)
    tables: tuple[Table, ...] = ()
    charts: tuple[Chart, ...] = field(default=(), kw_only=True)
    figures: tuple[Picture, ...] = ()
    listings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Bar:
    """A number drawn as a bar beside others: what it is, itself with its unit, its share (0 … 1), its colour's role."""

    label: str
    value: str
    share: float
    role: str


@dataclass(frozen=True)
class Fact:
    """A number that belongs to the verdict: what it is, itself with its unit, what stands beside it, bars below it."""

    label: str
    value: str
    note: str = ""
    bars: tuple[Bar, ...] = ()


@dataclass(frozen=True, eq=False)
class Verdict:
    """What stands first: a few words, one sentence, one picture, and the numbers it rests on.

    ``tone`` is ``found``, ``clear`` or ``open``; ``equations`` are MathML.
    """

    label: str
    tone: str
    sentence: str
    facts: tuple[Fact, ...] = ()
    equations: tuple[str, ...] = ()
    chart: Chart | None = None


@dataclass(frozen=True)
class Page:
    """A whole report; ``verdict`` or ``lead`` is what a reader needs who reads nothing else.

    ``files`` holds name and SHA-256 of what was read, ``remarks`` label and text of what else belongs to the end.
    """

    title: str
    lead: tuple[str, ...]
    sections: tuple[Section, ...]
    command: str
    files: tuple[tuple[str, str], ...] = ()
    version: str = __version__
    verdict: Verdict | None = None
    seed: int | None = None
    remarks: tuple[tuple[str, str], ...] = ()


def drawing(figure: Figure, alt: str, name: str = "") -> Drawing:
    """A figure as a drawing."""
    return Drawing(drawn(figure), alt, name)


def picture(figure: Figure, caption: str, alt: str, white: bool = False) -> Picture:
    """A single figure with its caption and alternative text; ``white`` as in :class:`Drawing`."""
    return Picture((replace(drawing(figure, alt), white=white),), caption)


def file_hashes(files: Sequence[Path]) -> tuple[tuple[str, str], ...]:
    """Name below the folder that all files share, and SHA-256, of each file."""
    if not files:
        return ()
    resolved = [Path(file).resolve() for file in files]
    base = Path(os.path.commonpath([file.parent for file in resolved]))
    return tuple(
        (str(file.relative_to(base)), hashlib.sha256(file.read_bytes()).hexdigest()) for file in dict.fromkeys(resolved)
    )


def _as_text(value: object) -> object:
    """Text without letters that are not seen but change what is: controls, and what turns the direction of writing."""
    if not isinstance(value, str) or isinstance(value, Markup) or value.isprintable():
        return value
    kept = "\n\t\u00a0\u2009\u202f"
    return "".join(c if c.isprintable() or c in kept else f"⟨U+{ord(c):04X}⟩" for c in value)


def render_page(page: Page) -> str:
    """The page as one HTML text: style, script and figures inside, nothing to load."""
    folder = resources.files("ssmr_ident.report") / "templates"
    environment = jinja2.Environment(
        autoescape=True, finalize=_as_text, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    numbered = count(1)
    environment.filters["payload"] = lambda chart: Markup(chart.payload(lambda text: str(_as_text(text))))
    environment.filters["math"] = Markup
    environment.filters["inline"] = lambda d: Markup(inline(d.svg, f"d{next(numbered)}", str(_as_text(d.alt)), d.white))
    parts = {"css": "report.css", "js": "report.js", "plot_css": "uplot/uPlot.min.css",
             "plot_js": "uplot/uPlot.iife.min.js", "charts_js": "charts.js"}  # fmt: skip
    inside = {name: Markup((folder / file).read_text(encoding="utf-8")) for name, file in parts.items()}
    template = environment.from_string((folder / "report.html").read_text(encoding="utf-8"))
    drawings = [item for section in page.sections for figure in section.figures for item in figure.drawings]
    own = set().union(*(colours(item.svg) for item in drawings))
    charted = bool((page.verdict and page.verdict.chart) or any(section.charts for section in page.sections))
    return template.render(page=page, charted=charted, dark=Markup(declarations(own)), **inside)


def write_page(path: Path, page: Page) -> Path:
    """Render a page; the file appears whole or not at all."""
    return write_text(path, render_page(page))
