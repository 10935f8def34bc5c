"""House style of every figure: readable in print, safe for colour-blind readers, units on every axis."""

from __future__ import annotations

import io
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font

from ssmr_ident.core.atomic import make_folder, write_bytes

# Okabe & Ito (2008), "Color Universal Design": told apart with any common colour blindness, and in grey by order.
INK = "#1a1a1a"
MEASURED = "#8c8c8c"
RAW = "#bdbdbd"
BLUE = "#0072B2"
ORANGE = "#D55E00"
GREEN = "#009E73"
PURPLE = "#CC79A7"
AMBER = "#E69F00"
SKY = "#56B4E9"
SERIES = (BLUE, ORANGE, GREEN, PURPLE, AMBER, SKY)
MARKERS = ("o", "s", "^", "D", "v", "P")
SHADE = "#eef3f7"

SINGLE_COLUMN = 3.5
DOUBLE_COLUMN = 7.2
"""Widths [inch] of a journal's one and two columns."""

STYLE: Any = {  # not dict[str, …]: matplotlib types its keys one by one
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with matplotlib: the same figure on every machine
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "legend.fontsize": 7,
    "mathtext.fontset": "dejavusans",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#d9d9d9",
    "grid.linewidth": 0.4,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 4,
    "legend.frameon": False,
    "figure.dpi": 100,
    "savefig.dpi": 200,
    "svg.hashsalt": "ssmr_ident",
    "svg.fonttype": "path",
    "agg.path.chunksize": 20000,
}

_UNITS = {"m/s^2": "m/s²", "rad/s^2": "rad/s²", "N m": "N·m", "1": "–", "": "–"}
_SYMBOLS = {
    **{f"a{axis}": f"$a_{axis}$" for axis in "xyz"},
    **{f"w{axis}": rf"$\omega_{axis}$" for axis in "xyz"},
}

house = mpl.rc_context(STYLE)
"""Decorator for functions that draw or save."""


def name_text(name: str, longest: int = 80) -> str:
    """A name that a user gave, as a figure prints it: its beginning, without mathematics, in letters that the font has.

    >>> name_text("cost_$x.csv"), len(name_text(4000 * "w"))
    ('cost_\\\\$x.csv', 80)
    """
    short = name if len(name) <= longest else f"{name[: longest - 1]}…"
    return "".join(letter if _printed(letter) else "□" for letter in short).replace("$", r"\$")


@cache
def _printed(letter: str) -> bool:
    """Whether the figures' font has a letter; what turns the direction of writing is none."""
    font = get_font(findfont(FontProperties(family=[STYLE["font.family"]])))
    return letter.isprintable() and font.get_char_index(ord(letter)) != 0


def unit_text(unit: str) -> str:
    """Unit as printed.

    >>> unit_text("m/s^2")
    'm/s²'
    """
    return _UNITS.get(unit, unit)


def quantity_text(name: str) -> str:
    """Channel name as printed: a symbol where there is a usual one.

    >>> quantity_text("ay"), quantity_text("acceleration_2")
    ('$a_y$', 'acceleration 2')
    """
    return _SYMBOLS.get(name) or name_text(name.replace("_", " "))


def axis_text(name: str, unit: str) -> str:
    """Label of an axis.

    >>> axis_text("force", "N")
    'force [N]'
    """
    return f"{quantity_text(name)} [{unit_text(unit)}]"


class HouseFigure(Figure):
    """A figure that a notebook shows without pyplot."""

    def _repr_png_(self) -> bytes:
        return drawn(self)


def new_figure(width: float, height: float) -> Figure:
    """A figure of its own, outside pyplot's list of open ones. Width and height in inches."""
    figure = HouseFigure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def panel_letter(axes: Axes, letter: str) -> None:
    """A bold letter at the upper left, outside the axes."""
    axes.set_title(letter, loc="left", fontweight="bold", fontsize=8)


def save(figure: Figure, stem: Path, format: str = "png", command: str = "") -> Path:
    """Write a figure; the same figure gives the same bytes.

    Parameters
    ----------
    figure : Figure
    stem : Path
        Without suffix.
    format : {"png", "svg", "pdf"}
    command : str
        By which it was made; kept in a PNG.

    Returns
    -------
    Path of the file written
    """
    path = stem.with_name(f"{stem.name}.{format}")
    make_folder(path.parent)
    return write_bytes(path, drawn(figure, format, command))


def drawn(figure: Figure, format: str = "png", command: str = "") -> bytes:
    """A figure as the bytes of a file."""
    undated: Any = {
        "png": {"Command": command} if command else {},
        "svg": {"Date": None},
        "pdf": {"CreationDate": None},
    }[format]
    buffer = io.BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(buffer, format=format, metadata=undated)
    return buffer.getvalue()
