"""A figure as SVG that belongs to the page it stands on: its own ids, and colours that follow light and dark."""

from __future__ import annotations

import io
import re
from html import escape

from matplotlib import rc_context
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from ssmr_ident.report.style import STYLE

_STYLE_ATTRIBUTE = re.compile(r'style="[^"]*"')
_COLOUR = re.compile(r"#([0-9a-f]{6})\b")


def drawn(figure: Figure) -> str:
    """SVG text of a figure, without the prologue and the metadata; the same figure gives the same text."""
    buffer = io.StringIO()
    canvas, dpi = figure.canvas, figure.dpi
    figure.set_dpi(STYLE["savefig.dpi"])
    with rc_context(STYLE):
        # savefig draws twice, first to no file
        FigureCanvasSVG(figure).print_svg(buffer, metadata={"Date": None, "Creator": None})
    figure.set_canvas(canvas)
    figure.set_dpi(dpi)
    text = buffer.getvalue()
    return re.sub(r"\s*<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.DOTALL)


def colours(svg: str) -> set[str]:
    """All colours of a drawing, as ``#rrggbb``."""
    return {f"#{name}" for attribute in _STYLE_ATTRIBUTE.findall(svg) for name in _COLOUR.findall(attribute)}


def inline(svg: str, mark: str, label: str, white: bool = False) -> str:
    """The same SVG ready to stand in a page.

    Parameters
    ----------
    svg : str
        As :func:`drawn` gives it.
    mark : str
        Unique on the page; ids begin with it, so that several figures do not take each other's shapes.
    label : str
        What a reader hears who does not see the figure.
    white : bool
        Keep all colours, on white paper.

    Colours become ``var(--f0072b2, #0072b2)``: the page's style sheet may give each another value in the dark.
    """
    svg = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{mark}-", svg)
    if not white:
        svg = _STYLE_ATTRIBUTE.sub(lambda found: _COLOUR.sub(r"var(--f\1, #\1)", found[0]), svg)
    width = float(svg.split('width="')[1].split("pt")[0])
    paper = "; background: #fff; fill: #000" if white else ""
    opening = f'<svg role="img" aria-label="{escape(label)}" style="max-width: {width * 1.6:.0f}pt{paper}"'
    head, _, rest = svg.partition(">")
    head = re.sub(r'\s(?:width|height|version|xmlns(?::xlink)?)="[^"]*"', "", head)
    return head.replace("<svg", opening, 1) + ">" + rest
