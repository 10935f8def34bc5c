"""Plots that a reader may zoom, read and save: lines as values, drawn by a script that the page carries (uPlot)."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray

_WORDS = {2: "<u2", 4: "<u4"}
"""Two bytes part a course into more steps than a screen has pixels; uneven times take four."""


@dataclass(frozen=True, eq=False)
class Line:
    """One course of a chart.

    Parameters
    ----------
    label : str
    y : (n,) float
        In the unit of the chart; NaN leaves a gap.
    role : str
        ``recorded``, ``before``, ``after``, ``limit`` (an edge of a band): colour and width are the style sheet's.
    """

    label: str
    y: Array
    role: str


@dataclass(frozen=True, eq=False)
class Chart:
    """Lines over one axis, for a page.

    Parameters
    ----------
    title, alt : str
        ``alt`` says in a sentence what is to be seen.
    name : str
        Of the files that it is saved as, without ending.
    x : (n,) float
    x_label, x_unit, y_label, y_unit : str
    lines : tuple of Line
    caption : str
    shown : (float, float) or None
        The part of x that is seen first; None shows all.
    rest : bool
        A strip below with what each further line leaves of the first.
    band : bool
        The last two lines are the edges of a shaded band.
    """

    title: str
    alt: str
    name: str
    x: Array
    x_label: str
    x_unit: str
    y_label: str
    y_unit: str
    lines: tuple[Line, ...]
    caption: str = ""
    shown: tuple[float, float] | None = None
    rest: bool = False
    band: bool = False

    def payload(self, plain: Callable[[str], str]) -> str:
        """As JSON that may stand in a script element; ``plain`` cleans what a user has named."""
        lines = [{"label": plain(c.label), "role": c.role, "y": packed(c.y)} for c in self.lines]
        content = {
            "name": plain(self.name), "x": packed(self.x, 4), "xLabel": self.x_label, "xUnit": self.x_unit,
            "title": plain(self.title), "yLabel": plain(self.y_label), "yUnit": plain(self.y_unit), "lines": lines,
            "shown": self.shown, "rest": self.rest, "band": self.band,
        }  # fmt: skip
        return json.dumps(content, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def packed(values: Array, size: int = 2) -> dict[str, Any]:
    """Numbers as text: even ones by their first and step, others as whole steps from their least, in base64.

    Parameters
    ----------
    values : (n,) float
        NaN and infinity become gaps.
    size : int
        Bytes a number, 2 or 4.

    >>> packed(np.array([1.0, 1.5, 2.0]))
    {'low': 1.0, 'step': 0.5, 'n': 3}
    """
    y = np.asarray(values, float)
    steps = np.diff(y)
    if len(y) > 1 and np.isfinite(y).all() and np.ptp(steps) < 1e-6 * abs(steps[0]):
        return {"low": float(y[0]), "step": float((y[-1] - y[0]) / (len(y) - 1)), "n": len(y)}
    there = np.isfinite(y)
    low, high = (float(y[there].min()), float(y[there].max())) if there.any() else (0.0, 0.0)
    most = 2 ** (8 * size) - 2  # the largest word is the gap
    step = (high - low) / most or 1.0
    words = np.full(len(y), most + 1).astype(_WORDS[size])
    words[there] = np.round((y[there] - low) / step)
    text = base64.b64encode(words.tobytes()).decode()
    return {"low": low, "step": step, "size": size, "data": text}
