"""The page of ``ident fit``: what was found and how well, against what was known; figures; the whole report."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from ssmr_ident.core.atomic import make_folder
from ssmr_ident.identify.lmfit_report import Variable
from ssmr_ident.report.figures_fit import backbone_figure, sawtooth_figure
from ssmr_ident.report.html import (
    Cell,
    Fact,
    Number,
    Page,
    Picture,
    Section,
    Table,
    Verdict,
    file_hashes,
    picture,
    write_page,
)
from ssmr_ident.report.numbers import NONE, interval, measured, unit
from ssmr_ident.workflows.files_read import files_read
from ssmr_ident.workflows.fit.result import SessionFit

SHOWN = 6
"""As many pulls are drawn; the folder holds the figures of all."""


def write_fit_page(fit: SessionFit, folder: Path, command: str, seed: int, session: Path) -> Path:
    """Write ``report.html`` into a folder; it is made where it is missing."""
    make_folder(folder)
    return write_page(folder / "report.html", fit_page(fit, command, seed, files_read(session)))


def fit_page(fit: SessionFit, command: str, seed: int, files: Sequence[Path]) -> Page:
    """What the recordings say of the parameters.

    Parameters
    ----------
    fit : SessionFit
    command : str
    seed : int
    files : sequence of Path
        What was read.
    """
    known = [v for v in fit.variables if v.std is not None]
    told = [v for v in known if v.source != "prior"]
    label = f"{len(told)} parameter{'' if len(told) == 1 else 's'} found from {len(fit.recordings)} recordings"
    count = len(fit.conflicts)
    sentence = "None of them is in conflict with what was known before."
    if count:
        names = ", ".join(str(conflict["parameter"]) for conflict in fit.conflicts)
        sentence = f"{'One is' if count == 1 else f'{count} are'} in conflict with what was known before: {names}."
    facts = tuple(_fact(v) for v in sorted(told, key=_learnt, reverse=True)[:4])
    sections = (
        Section("Findings", points=fit.findings),
        _parameters(fit),
        _pictures(fit),
        Section("The report in full", listings=(str(fit),)),
    )
    kept = tuple(s for s in sections if s.points or s.tables or s.figures or s.listings)
    verdict = Verdict(label, "open" if count else "", sentence, facts)
    return Page(f"Parameters of {fit.session}", (), kept, command, file_hashes(files), verdict=verdict, seed=seed)


def _learnt(v: Variable) -> float:
    """How many times narrower the recordings made what is known of a parameter; infinite for what was unknown."""
    return (v.before_std or math.inf) / v.std if v.std else 0.0


def _fact(v: Variable) -> Fact:
    std = v.std or 0.0
    return Fact(
        v.name, measured(v.value, v.std, v.unit), f"95 %: {interval(v.value - 1.96 * std, v.value + 1.96 * std)}"
    )


def _parameters(fit: SessionFit) -> Section:
    rows: list[tuple[Cell, ...]] = []
    for v in fit.variables:
        row: list[Cell] = [v.name, Number(measured(v.value, v.std), v.value)]
        if v.std is None:
            row.append(Number(NONE, math.nan))
        else:
            low, high = v.value - 1.96 * v.std, v.value + 1.96 * v.std
            row.append(Number(interval(low, high), low))
        before = Number(NONE, math.nan) if v.before is None else Number(measured(v.before, v.before_std), v.before)
        rows.append((*row, before, unit(v.unit) or NONE, v.source or NONE))
    header = ("parameter", "found ± std", "95 % interval", "known before ± std", "unit", "informed by")
    caption = "Everything that was fitted. Informed by: whether the data or the earlier knowledge decides the value."
    return Section("Parameters", tables=(Table(caption, header, tuple(rows)),) if rows else ())


def _pictures(fit: SessionFit) -> Section:
    figures: list[Picture] = []
    if fit.backbones:
        caption = (
            "How fast each decay swings (above) and how quickly it dies away (below) while its swings become smaller: "
            "level lines belong to a straight spring and a plain damper. Bars are standard deviations."
        )
        alt = "Natural frequency and damping ratio of each decay over its amplitude."
        figures.append(picture(backbone_figure(fit.backbones), caption, alt))
    for pull in fit.pulls[:SHOWN]:
        level = (
            f"{measured(pull.pull.level, pull.pull.level_std, 'N')} while sliding" if pull.pull.slides else "no sliding"
        )
        caption = (
            f"{pull.name}: pulling force over the way pulled. The first rise tells the stiffness, the level afterwards "
            f"the friction; {level}."
        )
        figures.append(picture(sawtooth_figure(pull), caption, f"{pull.name}: force over travel, {level}."))
    return Section("Decays and pulls", figures=tuple(figures))
