"""The page of many sessions: which physics, where and how often; who stands apart; parameters over time and robots."""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd
from matplotlib.dates import AutoDateLocator, ConciseDateFormatter
from matplotlib.figure import Figure

from ssmr_ident.report import style
from ssmr_ident.report.html import (
    Bar,
    Cell,
    Fact,
    Link,
    Number,
    Page,
    Picture,
    Section,
    Table,
    Verdict,
    picture,
    write_page,
)
from ssmr_ident.report.numbers import NONE, measured, number, unit
from ssmr_ident.workflows.batch.outliers import farthest
from ssmr_ident.workflows.batch.results import Results

LISTED = 2000
"""As many sessions stand on the page, those that stand apart first; the tables hold all of them."""
DRAWN = 9
"""As many parameters are drawn, those that most sessions have."""
COLUMNS = 3


def write_batch_page(results: Results, command: str = "") -> Path:
    """Write ``report.html`` beside the tables."""
    return write_page(results.folder / "report.html", batch_page(results, command))


def batch_page(results: Results, command: str) -> Page:
    """What a fleet's sessions say together."""
    sessions = results.sessions
    told = sessions[sessions.verdict != ""]
    counts = {verdict: int((told.verdict == verdict).sum()) for verdict in told.verdict.unique()}
    lost = sessions[sessions.status != "done"]
    missing = counts.get("missing_physics", 0)
    facts = (
        Fact("physics missing", f"{missing}", bars=_bar(_share(missing, told))),
        Fact("nothing missing", f"{(n := counts.get('nothing_missing', 0))}", bars=_bar(_share(n, told))),
        Fact("undetermined", f"{(n := counts.get('undetermined', 0))}", bars=_bar(_share(n, told))),
        Fact("not done", f"{len(lost)}", bars=_bar(_share(len(lost), sessions), "before")),
    )
    often = told[told.effects != ""].effects.value_counts()
    sentence = (
        f"Most often: {often.index[0]}, in {often.iloc[0]} of {len(told)}." if len(often) else "No physics is missing."
    )
    if not len(told):
        sentence = "No session was diagnosed."
    verdict = Verdict(
        f"{len(sessions)} sessions", "found" if missing else "clear" if len(told) else "open", sentence, facts
    )
    sections = (_often(told), _not_done(lost), _sessions(results), _over_time(results.parameters))
    kept = tuple(s for s in sections if s.tables or s.figures)
    return Page(f"Sessions of {results.folder.name}", (), kept, command, verdict=verdict)


def _bar(share: float, role: str = "floor") -> tuple[Bar, ...]:
    return (Bar("", f"{100 * share:.0f} %", share, role),)


def _share(count: int, of: pd.DataFrame) -> float:
    return count / len(of) if len(of) else 0.0


def _often(told: pd.DataFrame) -> Section:
    named = told[told.effects != ""]
    rows: list[tuple[Cell, ...]] = []
    for (effects, elements), group in named.groupby(["effects", "elements"], sort=False):
        better = (group.heldout_after / group.heldout_before).median()
        rows.append((
            effects, elements or NONE, Number(f"{len(group)}", len(group)),
            Number(f"{100 * len(group) / len(told):.1f} %", len(group)),
            ", ".join(sorted(group.robot.unique())[:5]), _number(group.confidence.median()), _number(better),
        ))  # fmt: skip
    rows.sort(key=lambda row: -row[2].value if isinstance(row[2], Number) else 0.0)
    header = ("physics", "where", "sessions", "share", "robots", "confidence", "held-out error left")
    caption = "What is missing, how often. Confidence and what is left of the held-out error are medians."
    return Section("Which physics", tables=(Table(caption, header, tuple(rows)),) if rows else ())


def _not_done(lost: pd.DataFrame) -> Section:
    rows = tuple((row.session, row.status, row.error) for row in lost.head(LISTED).itertuples())
    caption = "Sessions without an answer, and why. After mending, the same command runs these again."
    return Section("Not done", tables=(Table(caption, ("session", "state", "why"), rows),) if rows else ())


def _sessions(results: Results) -> Section:
    done = results.sessions[results.sessions.status == "done"].set_index("session")
    apart = farthest(results.parameters)
    order = apart.deviations.abs().reindex(done.index).sort_values(ascending=False, kind="stable").index[:LISTED]
    farthest_of = {row.Index: row for row in apart.itertuples()}
    rows: list[tuple[Cell, ...]] = []
    for row in done.loc[order].itertuples():
        name = row.Index
        far: Cell = NONE
        if (a := farthest_of.get(name)) is not None:
            text = f"{a.parameter} {measured(a.value, None, a.unit)}, {a.deviations:+.1f} std"
            far = Number(text.replace("-", "−"), abs(a.deviations))
        target = f"sessions/{name}/report.html"
        link: Cell = Link(name, target) if (results.folder / target).is_file() else name
        rows.append((
            link, row.robot, row.verdict.replace("_", " ") or NONE, row.effects or NONE, far,
            _number(row.confidence), _number(row.heldout_before), _number(row.heldout_after), _number(row.noise_floor),
            _number(row.seconds),
        ))  # fmt: skip
    header = ("session", "robot", "verdict", "physics", "farthest", "confidence", "before", "after", "floor", "s")
    caption = (
        "Held-out error before and after, and what noise leaves of it (% or dB). Farthest: the fitted parameter that "
        "stands farthest from the median of the same robot's sessions; those sessions come first."
    )
    if len(done) > LISTED:
        caption += f" The first {LISTED} of {len(done)}; sessions.parquet has all."
    return Section("Sessions, outliers first", tables=(Table(caption, header, tuple(rows)),) if rows else ())


def _number(value: float | None) -> Number:
    known = value is not None and math.isfinite(value)
    return Number(number(float(value)) if known else NONE, float(value) if known else math.nan)  # type: ignore[arg-type]


def _over_time(parameters: pd.DataFrame) -> Section:
    fitted = parameters[(parameters.source == "fit") & parameters.value.notna()]
    if fitted.session.nunique() < 2:
        return Section("Parameters over time")
    names = list(fitted.parameter.value_counts().index[:DRAWN])
    caption = "Each dot is a session, in the order of their logs; bars are standard deviations, colours robots."
    alt = f"{len(names)} fitted parameters over the time of the logs: {', '.join(names)}."
    drawn: tuple[Picture, ...] = (picture(parameters_figure(fitted, names), caption, alt),)
    return Section("Parameters over time and robots", figures=drawn)


@style.house
def parameters_figure(fitted: pd.DataFrame, names: list[str]) -> Figure:
    """Small multiples: a parameter each, its values over the time of their logs.

    Parameters
    ----------
    fitted : DataFrame
        As ``Results.parameters``.
    names : list of str
    """
    lines = math.ceil(len(names) / COLUMNS)
    figure = Figure((style.DOUBLE_COLUMN, 1.7 * lines), layout="constrained")
    axes = figure.subplots(lines, COLUMNS, squeeze=False)
    robots = sorted(fitted.robot.unique())
    for k, (ax, name) in enumerate(zip(axes.flat, names, strict=False)):
        values = fitted[fitted.parameter == name]
        for colour, robot in zip(style.SERIES * (1 + len(robots) // len(style.SERIES)), robots, strict=False):
            one = values[values.robot == robot]
            if len(one):
                ax.errorbar(
                    pd.to_datetime(one.logged).dt.tz_localize(None), one.value, one["std"].fillna(0.0), fmt="o",
                    color=colour, markersize=2.5, elinewidth=0.6, label=robot, rasterized=len(one) > 500,
                )  # fmt: skip
        ax.set_title(f"{name} [{unit(values.unit.iloc[0]) or '1'}]", fontsize=7)
        dates = AutoDateLocator(minticks=2, maxticks=5)  # type: ignore[no-untyped-call]
        ax.xaxis.set_major_locator(dates)
        ax.xaxis.set_major_formatter(ConciseDateFormatter(dates))  # type: ignore[no-untyped-call]
        if k == 0 and 1 < len(robots) <= len(style.SERIES):
            ax.legend()
    for ax in axes.flat[len(names) :]:
        ax.remove()
    return figure
