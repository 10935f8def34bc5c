"""Two parameter sets or two diagnoses as a page: what has changed, beyond what their uncertainty makes by chance."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ssmr_ident.compare.change import CHANCE, Change, Changes, Side
from ssmr_ident.report.chart import Chart, Line
from ssmr_ident.report.comparison_page import UNITS
from ssmr_ident.report.figures_diagnosis import readable
from ssmr_ident.report.html import Bar, Cell, Fact, Number, Page, Section, Table, Verdict
from ssmr_ident.report.numbers import NONE, alike, measured, number
from ssmr_ident.report.numbers import unit as printed

SHOWN = 4


def changes_page(found: Changes, command: str, files: tuple[tuple[str, str], ...]) -> Page:
    """What has changed from one to the other.

    Parameters
    ----------
    found : Changes
    command : str
    files : tuple of (str, str)
        Name and SHA-256 of what was read.
    """
    some = found.changed
    count = f"{len(some)} parameter{'s have' if len(some) != 1 else ' has'} changed" if some else "Nothing has changed"
    both = (found.first, found.second)
    gone = [id for id in found.first.effects if id not in found.second.effects]
    come = [id for id in found.second.effects if id not in found.first.effects]
    told = [
        f"{', '.join(map(readable, ids))} {word}"
        for ids, word in ((gone, "is no longer missing"), (come, "is missing now"))
        if ids and all(side.verdict for side in both)
    ]
    label = "; ".join((count, *told))
    compared = sum(c.p_value == c.p_value for c in found.changes)
    sentence = (
        f"{found.first.name} against {found.second.name}: {compared} parameters have a standard deviation to be held "
        f"against. By chance alone even one would be called changed in {100 * CHANCE:.0f} of 100 such comparisons."
    )
    facts = (*_largest(some), *(_error(side) for side in both if side.error))
    charts = tuple(chart for id in found.first.curves if (chart := _curves(id, *both)) is not None)
    tone, chart = "found" if some or told else "clear", charts[0] if charts else None
    verdict = Verdict(label[0].upper() + label[1:], tone, sentence, facts, (), chart)
    header = ("parameter", "first", "second", "unit", "change", "change [%]", "p")
    rows = tuple(_row(c) for c in found.changes)
    caption = (
        "Value ± standard deviation; p: probability of such a difference without a change. Changed ones stand first. "
        "Both sides are taken as independent: two fits of one recording are not."
    )
    section = Section("Parameter by parameter", tables=(Table(caption, header, rows),), charts=charts[1:])
    return Page(f"{found.first.name} against {found.second.name}", (), (section,), command, files, verdict=verdict)


def _curves(id: str, first: Side, second: Side) -> Chart | None:
    """What both diagnoses found of one effect, over what it depends on; None where they do not both say."""
    one, other = first.curves.get(id), second.curves.get(id)
    if one is None or other is None or one["variable"] != other["variable"]:
        return None
    variable, _, of = str(one["variable"]).partition(" [")
    x = np.unique(np.concatenate([np.asarray(c["points"], float) for c in (one, other)]))
    turning = variable in ("angle", "turning speed")
    what = "moment" if turning else "force"

    def over(curve: Mapping[str, Any]) -> np.ndarray:
        points = np.asarray(curve["points"], float)
        return np.interp(x, points, np.asarray(curve["force"], float), left=np.nan, right=np.nan)

    return Chart(
        title=f"{readable(id).capitalize()}: {what} over {variable}",
        alt=f"{readable(id)}: {what} over {variable}, of {first.name} and of {second.name}.",
        name=f"curves-{id}", x=x, x_label=variable, x_unit=printed(of.rstrip("]")),
        y_label=what, y_unit="N m" if turning else "N",
        lines=(Line(first.name, over(one), "before"), Line(second.name, over(other), "after")),
        caption="Each as far as its recordings went.",
    )  # fmt: skip


def _largest(some: tuple[Change, ...]) -> list[Fact]:
    return [
        Fact(c.parameter, _percent(c) + (" %" if c.relative == c.relative else f" {printed(c.unit)}"),
             f"{' → '.join(alike([c.first or 0.0, c.second or 0.0]))} {printed(c.unit)}")
        for c in some[:SHOWN]
    ]  # fmt: skip


def _error(side: Side) -> Fact:
    """Of a diagnosis on recordings that it never fitted."""
    assert side.error is not None
    unit, texts, largest = UNITS[side.metric], alike(side.error), max(side.error)
    words = (("before", "before"), ("after", "after"), ("noise", "floor"))
    bars = tuple(
        Bar(name, f"{text} {unit}", value / largest, role)
        for (name, role), text, value in zip(words, texts, side.error, strict=True)
    )
    named = ", ".join(map(readable, side.effects)) or side.verdict.replace("_", " ")
    return Fact(f"Error on recordings never fitted, {side.name}", named, "", bars)


def _row(c: Change) -> tuple[Cell, ...]:
    p_value = NONE if math.isnan(c.p_value) else "below 0.001" if c.p_value < 1e-3 else number(c.p_value, 2)
    return (
        c.parameter,
        _value(c.first, c.first_std),
        _value(c.second, c.second_std),
        printed(c.unit) or NONE,
        _told(c),
        Number(_percent(c) if c.relative == c.relative else NONE, c.relative),
        Number(p_value, c.p_value),
    )


def _told(c: Change) -> str:
    if c.first is None or c.second is None:
        return "in the second alone" if c.first is None else "in the first alone"
    return "changed" if c.changed else NONE if math.isnan(c.p_value) else "within its uncertainty"


def _percent(c: Change) -> str:
    value = 100 * c.relative if c.relative == c.relative else c.difference
    return f"{'+' if value > 0 else ''}{number(value)}"


def _value(value: float | None, std: float | None) -> Cell:
    return NONE if value is None else Number(measured(value, std), value)
