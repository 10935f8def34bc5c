"""The page of a diagnosis: the verdict and its numbers first, then proof, place, explanations, what had hidden it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from ssmr_ident.core.atomic import make_folder, write_text
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNIT, Diagnosis, NamedEffect
from ssmr_ident.report.diagnosis_pictures import after_name
from ssmr_ident.report.diagnosis_sections import needed, sections
from ssmr_ident.report.figures_diagnosis import readable
from ssmr_ident.report.html import Fact, Page, Verdict, file_hashes, render_page, write_page
from ssmr_ident.report.numbers import alike, interval, measured, number, share

FIGURES = "figures"


def write_report(diagnosis: Diagnosis, path: Path, command: str, seed: int, files: Sequence[Path]) -> Path:
    """Write the page and, in a folder ``figures`` beside it, each of its drawings as SVG.

    Parameters
    ----------
    diagnosis : Diagnosis
    path : Path
        Of the page.
    command : str
        The call that made it.
    seed : int
    files : sequence of Path
        What was read; printed with its SHA-256.
    """
    page = diagnosis_page(diagnosis, command, seed, file_hashes(files))
    folder = Path(path).parent / FIGURES
    make_folder(folder)
    for section in page.sections:
        for figure in section.figures:
            for item in figure.drawings:
                write_text(folder / f"{item.name}.svg", item.svg)
    return write_page(path, page)


def render_report(diagnosis: Diagnosis, command: str, seed: int, files: Sequence[Path] = ()) -> str:
    """The page as one HTML text."""
    return render_page(diagnosis_page(diagnosis, command, seed, file_hashes(files)))


def diagnosis_page(
    diagnosis: Diagnosis, command: str, seed: int | None = None, files: tuple[tuple[str, str], ...] = ()
) -> Page:
    """The page as a value.

    Parameters
    ----------
    diagnosis : Diagnosis
    command : str
    seed : int or None
    files : tuple of (str, str)
        Name and SHA-256.
    """
    spent = diagnosis.evidence.seconds
    remarks = (("Time", ", ".join(f"{name} {number(value, 2)} s" for name, value in spent.items())),) if spent else ()
    return Page(
        f"Diagnosis of {diagnosis.session}",
        (),
        sections(diagnosis),
        command,
        files,
        verdict=verdict(diagnosis),
        seed=seed,
        remarks=remarks,
    )


def verdict(diagnosis: Diagnosis) -> Verdict:
    """What stands first."""
    if diagnosis.verdict == MISSING:
        names = " and ".join(_name(effect.id) for effect in diagnosis.effects)
        label, tone = f"Missing physics: {names}", "found"
        equation = "\n".join(_law(effect) for effect in diagnosis.effects)
        facts = _found(diagnosis)
    elif diagnosis.verdict == NOTHING:
        label, tone, equation = "Nothing is missing", "clear", ""
        facts = _clear(diagnosis)
    else:
        label, tone, equation = "Undetermined: these recordings cannot tell what is missing", "open", ""
        facts = _open(diagnosis)
    advice = diagnosis.next_experiment if diagnosis.verdict != MISSING or _tied(diagnosis) else ""
    return Verdict(label, tone, diagnosis.summary, facts, equation, advice)


def _found(diagnosis: Diagnosis) -> tuple[Fact, ...]:
    sure = [f"{_name(e.id)}: {share(e.confidence)}" for e in diagnosis.effects]
    ties = sorted({_name(id) for e in diagnosis.effects for id in e.indistinguishable_from})
    facts = [*_before_after(diagnosis), *_kind(diagnosis)]
    if sure:
        one = len(sure) == 1
        facts.append(
            Fact(
                "How sure of the name",
                share(diagnosis.effects[0].confidence) if one else "; ".join(sure),
                f"fits as well: {', '.join(ties)}" if ties else "among the explanations tried",
            )
        )
    return tuple(facts)


def _clear(diagnosis: Diagnosis) -> tuple[Fact, ...]:
    quality, unit = diagnosis.heldout, UNIT[diagnosis.metric]
    tried = [t for t in diagnosis.tried if t.id != "baseline"]
    largest = max(quality.before, quality.noise_floor)
    left, floor = alike((quality.before, quality.noise_floor))
    facts = [
        Fact("Model, on held-out recordings", f"{left} {unit}", _spread(diagnosis), _bar(quality.before, largest)),
        Fact("Noise alone would leave", f"{floor} {unit}", "the noise floor", _bar(quality.noise_floor, largest)),
        Fact("Explanations tried", f"{len(tried)}", "none earns its place"),
    ]
    moved = max((abs(c.sigmas) for c in diagnosis.conflicts), default=None)
    if moved is not None:
        facts.append(Fact("Parameter moved farthest", f"{number(moved, 2)} std", "of what was known of it"))
    return tuple(facts)


def _open(diagnosis: Diagnosis) -> tuple[Fact, ...]:
    candidates = [_name(e.id) for e in diagnosis.effects]
    candidates += [_name(id) for e in diagnosis.effects for id in e.indistinguishable_from]
    facts = [*_before_after(diagnosis), *_kind(diagnosis)]
    if candidates:
        facts.append(Fact("Still possible", str(len(set(candidates))), ", ".join(dict.fromkeys(candidates))))
    return tuple(facts)


def _kind(diagnosis: Diagnosis) -> tuple[Fact, ...]:
    """Which kind of physics in any shape takes most of the misfit, and where it acts."""
    if not diagnosis.kinds:
        return ()
    first, *others = (f"{_name(k.kind)} at {_name(k.element)}: {share(k.share)}" for k in diagnosis.kinds[:3])
    beside = f"of the misfit by itself; {', '.join(others)}" if others else "of the misfit by itself"
    return (Fact("Kind of physics", first, beside),)


def _before_after(diagnosis: Diagnosis) -> tuple[Fact, ...]:
    quality, unit = diagnosis.heldout, UNIT[diagnosis.metric]
    largest = max(quality.before, quality.after, quality.noise_floor)
    before, after, floor = alike((quality.before, quality.after, quality.noise_floor))
    gain = "one held-out recording gives no interval" if len(quality.recordings) == 1 else ""
    if quality.improvement is not None:
        gain = f"improved by {interval(*quality.improvement, unit)} (95 %)"
    count = len(quality.recordings)
    on = f"on {count} recording{'s' if count > 1 else ''} never fitted" if count else "on recordings never fitted"
    facts = [Fact("Model before", f"{before} {unit}", on, _bar(quality.before, largest), "before")]
    if name := after_name(diagnosis):
        facts.append(Fact(name.capitalize(), f"{after} {unit}", gain, _bar(quality.after, largest), "after"))
    facts.append(
        Fact("Noise alone would leave", f"{floor} {unit}", "the noise floor", _bar(quality.noise_floor, largest))
    )
    return tuple(facts)


def _bar(value: float, largest: float) -> float:
    return value / largest if math.isfinite(value) and largest > 0 else 0.0


def _spread(diagnosis: Diagnosis) -> str:
    """Range over held-out recordings."""
    values = {o.recording: o.metric[0] for o in diagnosis.evidence.overlays if o.heldout}
    if len(values) < 2:
        return "distance from the recordings"
    unit = UNIT[diagnosis.metric]
    return f"{interval(min(values.values()), max(values.values()), unit)} over {len(values)} recordings"


def _tied(diagnosis: Diagnosis) -> bool:
    return any(effect.indistinguishable_from for effect in diagnosis.effects)


def _law(effect: NamedEffect) -> str:
    """Formula and values; three of them at most, the table below holds all."""
    scalars = [(name, e) for name, e in needed(effect).items() if isinstance(e.value, int | float)][:3]
    values = [f"{name} = {measured(float(e.value), e.std, e.unit)}" for name, e in scalars]
    return ",   ".join((effect.equation, *values))


def _name(id: str) -> str:
    return "physics that is in no list" if id == "unlisted" else readable(id)
