"""Six cases as pictures: what was recorded, what the baseline says, what the extended model says, held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ssmr_ident.compare import compare
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.experiments.campaign import load
from ssmr_ident.report.html import Picture, picture
from ssmr_ident.report.style import BLUE, INK, ORANGE, axis_text, house, new_figure
from ssmr_ident.session import read_parameters
from ssmr_ident.signals.filters import low_pass
from ssmr_proof.scores.score import CLEAN, NAMED
from ssmr_proof.scores.table import Row

SIZE = 6
RECORDED, BEFORE, AFTER = INK, ORANGE, BLUE


def chosen(rows: Sequence[Row]) -> list[Row]:
    """Six cases of different hidden physics: four named, the best concealed first, one clean, one that went wrong."""
    named = sorted(
        (row for row in rows if row.mark.outcome in NAMED and row.missing and row.heldout.before),
        key=lambda row: row.heldout.excess,
    )
    picked: list[Row] = []
    for row in named:
        if all(row.mark.hidden != other.mark.hidden for other in picked):
            picked.append(row)
    wrong = [row for row in rows if row.mark.outcome not in (*NAMED, CLEAN) and row.heldout.before][:1]
    clean = [row for row in rows if row.mark.outcome == CLEAN and row.heldout.before][:1]
    return [*picked[: SIZE - len(wrong) - len(clean)], *clean, *wrong]


def overlay(row: Row, opened: Path) -> Picture:
    """The held-out recording that gains most, as recorded, and by both models."""
    campaign = load(opened / row.case / "heldout")
    gains = np.subtract(row.heldout.before, row.heldout.after)
    index = int(np.argmax(gains))
    before, after = (
        compare(campaign, read_parameters(str(row.answer.folder / f"{name}.yaml"))).recordings[index]
        for name in ("before", "after")
    )
    figure = _drawn(*_overlapping(before.prediction, after.prediction))
    truth = "+".join(row.mark.hidden) or "nothing"
    named = "+".join(row.mark.named) or "nothing"
    values = f"{row.heldout.before[index]:.1f} %, {row.heldout.after[index]:.1f} %, {row.heldout.floor[index]:.1f} %"
    caption = f"{row.case}, held out: {before.file}. Hidden: {truth}; named: {named}. Before, after, noise: {values}."
    return picture(figure, caption, f"overlay {row.case}")


def _overlapping(before: Prediction, after: Prediction) -> tuple[Prediction, Prediction]:
    """The two over the times that both have: a sensor's own start-up is left out, and two sensors' differ."""
    first, last = max(before.time[0], after.time[0]), min(before.time[-1], after.time[-1])

    def cut(prediction: Prediction) -> Prediction:
        half = 0.5 / prediction.sample_rate
        kept = (prediction.time > first - half) & (prediction.time < last + half)
        return replace(
            prediction,
            time=prediction.time[kept],
            measured=prediction.measured[kept],
            simulated=prediction.simulated[kept],
        )

    return cut(before), cut(after)


@house
def _drawn(before: Prediction, after: Prediction) -> Figure:
    channel = int(np.argmax(before.measured.std(axis=0)))
    time = before.time
    shown = slice(0, int(np.searchsorted(time, time[0] + 1.2))) if before.low_pass_hz else slice(None)

    def smooth(prediction: Prediction, samples: np.ndarray) -> np.ndarray:
        column = samples[:, channel]
        if prediction.low_pass_hz is None:
            return column
        return low_pass(column, prediction.sample_rate, prediction.low_pass_hz)

    measured = smooth(before, before.measured)
    left, right = measured - smooth(before, before.simulated), measured - smooth(after, after.simulated)
    figure = new_figure(6.8, 3.2)
    top, bottom = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": [2, 1]})
    top.plot(time[shown], measured[shown], color=RECORDED, lw=1.0, label="recorded")
    top.plot(time[shown], (measured - left)[shown], color=BEFORE, lw=0.9, label="baseline, refitted")
    top.plot(time[shown], (measured - right)[shown], color=AFTER, lw=0.9, label="with the named physics")
    top.set_ylabel(axis_text(before.names[channel], before.units[channel]))
    top.legend(fontsize=7, ncols=3, loc="upper right")
    bottom.plot(time[shown], (left - left.mean())[shown], color=BEFORE, lw=0.8)
    bottom.plot(time[shown], (right - right.mean())[shown], color=AFTER, lw=0.8)
    bottom.set(xlabel="time [s]", ylabel="left over")
    return figure
