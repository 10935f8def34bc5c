"""Figures of the proof: confusion, held-out error before and after, power, shifted parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ssmr_ident.report.style import GREEN, INK, MEASURED, ORANGE, house, new_figure
from ssmr_proof.scores.power import Power
from ssmr_proof.scores.score import NAMED
from ssmr_proof.scores.summary import confusion
from ssmr_proof.scores.table import Row

GOOD, BAD, PALE = GREEN, ORANGE, MEASURED
LEAST = 0.03  # standard deviations; smaller shifts are drawn there


@house
def confusion_figure(rows: Sequence[Row]) -> Figure:
    """Hidden physics down, named physics across; what is named rightly lies on the frame of green cells."""
    hidden, named, counts = confusion(rows)
    figure = new_figure(max(5.0, 0.42 * len(named) + 3.0), max(3.0, 0.3 * len(hidden) + 2.0))
    axes = figure.add_subplot()
    totals = np.maximum(counts.sum(axis=1, keepdims=True), 1)
    for i, left in enumerate(hidden):
        for j, right in enumerate(named):
            if counts[i, j]:
                colour = GOOD if left == right else BAD
                shade = 0.25 + 0.75 * counts[i, j] / totals[i, 0]
                axes.add_patch(Rectangle((j - 0.5, i - 0.5), 1, 1, color=colour, alpha=shade, lw=0))
                axes.text(j, i, str(counts[i, j]), ha="center", va="center", color="white", fontsize=8)
    axes.set(xlim=(-0.5, len(named) - 0.5), ylim=(len(hidden) - 0.5, -0.5), xlabel="named", ylabel="hidden")
    axes.set_xticks(range(len(named)), [_words(name) for name in named], rotation=55, ha="right", fontsize=8)
    axes.set_yticks(range(len(hidden)), [_words(name) for name in hidden], fontsize=8)
    axes.grid(False)
    return figure


@house
def heldout_figure(rows: Sequence[Row]) -> Figure:
    """Every case with hidden physics: before and after over the noise floor, on recordings never seen."""
    used = sorted((row for row in rows if row.missing and row.heldout.before), key=lambda row: row.heldout.excess)
    figure = new_figure(6.8, max(2.4, 0.17 * len(used) + 1.0))
    axes = figure.add_subplot()
    for i, row in enumerate(used):
        before, after, floor = row.heldout.means
        colour = GOOD if row.mark.outcome in NAMED else BAD
        axes.plot([before / floor, after / floor], [i, i], color=PALE, lw=1.2, zorder=1)
        axes.plot(before / floor, i, "o", color=INK, ms=4, mfc="white", zorder=2)
        axes.plot(after / floor, i, "o", color=colour, ms=4, zorder=3)
    axes.axvline(1.0, color=INK, lw=0.8)
    axes.set_xscale("log")
    axes.set_yticks(
        range(len(used)), [f"{'+'.join(map(_words, row.mark.hidden))}  {row.case[-3:]}" for row in used], fontsize=6
    )
    axes.set(xlabel="held-out error over the noise floor: refitted baseline (open), with the named physics (full)")
    return figure


@house
def power_figure(power: Power) -> Figure:
    """The share of cases named, over what the refitted baseline leaves."""
    figure = new_figure(5.6, 3.0)
    axes = figure.add_subplot()
    x = np.maximum(power.excess, 0.03)
    spread = np.random.default_rng(1).uniform(-0.03, 0.03, len(x))
    axes.plot(x, power.named + spread, "o", ms=4, color=INK, alpha=0.5, label="one case: named or not")
    # a running share over the nearest cases in log excess
    if len(x) >= 6:
        grid = np.geomspace(x.min(), x.max(), 80)
        weight = np.exp(-0.5 * (np.log(grid[:, None] / x) / 0.5) ** 2)
        axes.plot(grid, weight @ power.named / weight.sum(axis=1), color=GOOD, label="share named")
        axes.plot(grid, weight @ power.seen / weight.sum(axis=1), color=PALE, label="share said to be missing")
    axes.set_xscale("log")
    axes.set(ylim=(-0.08, 1.08), xlabel="misfit that the refitted baseline leaves, over the noise", ylabel="share")
    axes.legend(fontsize=8, loc="center right")
    return figure


@house
def concealment_figure(rows: Sequence[Row]) -> Figure:
    """How well the baseline hid the physics: its error over the noise, and the largest shift of a parameter."""
    used = [row for row in rows if row.heldout.shifts]
    figure = new_figure(5.6, 3.2)
    axes = figure.add_subplot()
    for missing, colour, label in ((True, BAD, "physics missing"), (False, GOOD, "nothing missing")):
        points = [
            (row.heldout.means[0] / row.heldout.means[2], max(abs(row.heldout.shifts[0].sigmas), LEAST))
            for row in used
            if row.missing == missing
        ]
        if points:
            axes.plot(*np.array(points).T, "o", ms=4, color=colour, alpha=0.7, label=label)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.axvline(1.0, color=INK, lw=0.8)
    axes.set(
        xlabel="held-out error of the refitted baseline over the noise floor",
        ylabel="largest shift of a parameter\n[standard deviations of what was known]",
    )
    axes.legend(fontsize=8)
    return figure


def _words(name: str) -> str:
    return name.replace("_", " ")
