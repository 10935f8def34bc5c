"""Colours of figures on dark paper: the house's own by hand, any other with its lightness turned over."""

from __future__ import annotations

import colorsys
from collections.abc import Iterable

PAPER, INK = "#16181b", "#e8e8e6"
"""As in templates/report.css."""
_HOUSE = {
    "#ffffff": PAPER, "#1a1a1a": INK, "#000000": INK, "#0072b2": "#5cb3ee", "#d55e00": "#ff8d42", "#009e73": "#34c99c",
    "#cc79a7": "#dc95bf", "#e69f00": "#f2b134", "#56b4e9": "#7cc9f2", "#8c8c8c": "#9a9fa6", "#bdbdbd": "#686e75",
    "#eef3f7": "#23282e", "#d9d9d9": "#34393f",
}  # fmt: skip
_LIGHTEST, _DARKEST, _VIVID = 0.91, 0.10, 0.6


def on_dark(colour: str) -> str:
    """The colour that plays on dark paper the part that ``colour`` plays on white.

    Parameters
    ----------
    colour : str
        ``#rrggbb``, lower case.

    >>> on_dark("#ffffff"), on_dark("#808080"), on_dark("#aa0000")
    ('#16181b', '#808080', '#ff4747')
    """
    if colour in _HOUSE:
        return _HOUSE[colour]
    red, green, blue = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    hue, lightness, saturation = colorsys.rgb_to_hls(red, green, blue)
    turned = _LIGHTEST - (_LIGHTEST - _DARKEST) * lightness
    if saturation > 0.3 and lightness < 0.85:  # a line or a mark, not a shade: it must stand out
        turned = max(turned, _VIVID)
    parts = colorsys.hls_to_rgb(hue, turned, saturation)
    return "#" + "".join(f"{round(255 * part):02x}" for part in parts)


def declarations(colours: Iterable[str]) -> str:
    """Style sheet lines that give each colour of :func:`ssmr_ident.report.svg.inline` its value in the dark.

    >>> declarations(["#0072b2"])
    '--f0072b2: #5cb3ee;'
    """
    return " ".join(f"--f{colour[1:]}: {on_dark(colour)};" for colour in sorted(set(colours)))
