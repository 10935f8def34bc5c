"""Self-contained pages: text, tables and figures as values, one template, no network."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import jinja2
from matplotlib import rc_context
from matplotlib.figure import Figure

from ssmr_ident import __version__
from ssmr_ident.core.atomic import write_text
from ssmr_ident.report.style import STYLE


@dataclass(frozen=True)
class Table:
    """A table; the first column is text, the others are numbers as text."""

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Picture:
    """A figure as SVG text with its caption and alternative text."""

    svg: str
    caption: str
    alt: str


@dataclass(frozen=True)
class Section:
    """A heading with what stands below it."""

    title: str
    paragraphs: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    figures: tuple[Picture, ...] = ()
    listings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Page:
    """A whole report; ``lead`` is what a reader needs who reads nothing else."""

    title: str
    lead: tuple[str, ...]
    sections: tuple[Section, ...]
    command: str
    files: tuple[tuple[str, str], ...] = ()
    version: str = __version__


def picture(figure: Figure, caption: str, alt: str) -> Picture:
    """A figure as inline SVG; ids are made unique so that several can stand on one page."""
    buffer = io.StringIO()
    with rc_context(STYLE):
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    mark = re.sub(r"\W+", "", alt)[:40]
    svg = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{mark}-", svg)
    return Picture(svg, caption, alt)


def write_page(path: Path, page: Page) -> Path:
    """Render a page; the file appears whole or not at all."""
    folder = resources.files("ssmr_ident.report") / "templates"
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    text = environment.from_string((folder / "report.html").read_text(encoding="utf-8")).render(page=page)
    return write_text(path, text)
