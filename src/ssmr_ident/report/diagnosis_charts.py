"""Charts of a diagnosis: recorded and simulated on recordings never fitted, and a force whose shape was found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNIT, Diagnosis, NamedEffect
from ssmr_ident.diagnose.evidence import Overlay
from ssmr_ident.report.chart import Chart, Line
from ssmr_ident.report.curves import busiest_part
from ssmr_ident.report.field_words import place_words
from ssmr_ident.report.figures_diagnosis import CYCLES
from ssmr_ident.report.numbers import interval, number, unit

SHOWN_OVERLAYS = 6
"""As many as a reader looks at; diagnosis.yaml holds the rest in numbers."""


def after_name(diagnosis: Diagnosis) -> str:
    """What the model with physics added is called; empty where none was added."""
    if diagnosis.verdict == NOTHING or not diagnosis.effects:
        return ""
    return "with the physics added" if diagnosis.verdict == MISSING else "with the likeliest candidate"


def before_name(diagnosis: Diagnosis) -> str:
    """What the baseline at its best is called."""
    return "model before" if after_name(diagnosis) else "model"


def overlay_charts(diagnosis: Diagnosis) -> tuple[Chart, ...]:
    """One for each channel of recordings that were held out, of fitted ones where none was; the first of each first."""
    held = [o for o in diagnosis.evidence.overlays if o.heldout]
    shown = _across_recordings(held or list(diagnosis.evidence.overlays))[:SHOWN_OVERLAYS]
    return tuple(_overlay(o, diagnosis, k) for k, o in enumerate(shown, 1))


def _overlay(o: Overlay, diagnosis: Diagnosis, index: int) -> Chart:
    after, of = after_name(diagnosis), UNIT[diagnosis.metric]
    before, with_it, floor = (f"{number(v)} {of}" for v in o.metric)
    error = f"{before} before, {with_it} {after}" if after else before
    lines = [Line("recorded", o.measured, "recorded")]
    lines += [Line("model before", o.before, "before")] if after else [Line("model", o.before, "after")]
    lines += [Line("after", o.after, "after")] if after else []
    matter = o.measured - (o.before if after else o.measured.mean())
    part = o.time[busiest_part(o.measured, matter, CYCLES)]
    return Chart(
        title=f"{o.recording}, {o.channel.replace('_', ' ')}{_stretch(o, diagnosis)}: "
        f"{'never fitted' if o.heldout else 'fitted'}",
        alt=f"{o.recording}, {o.channel}: recorded and simulated over time; error {error}, noise alone {floor}.",
        name=f"overlay-{index}",
        x=o.time, x_label="time", x_unit="s", y_label=o.channel.replace("_", " "), y_unit=unit(o.unit),
        lines=tuple(lines), rest=True,
        shown=(float(part[0]), float(part[-1])) if len(part) < len(o.time) else None,
    )  # fmt: skip


def _stretch(o: Overlay, diagnosis: Diagnosis) -> str:
    """Its times, where a recording is shown in several stretches."""
    alike = [one for one in diagnosis.evidence.overlays if (one.recording, one.channel) == (o.recording, o.channel)]
    return f", {interval(float(o.time[0]), float(o.time[-1]), 's')}" if len(alike) > 1 else ""


def _across_recordings(overlays: Sequence[Overlay]) -> list[Overlay]:
    """The first channel of each recording, then the second of each, and so on."""
    seen: dict[str, int] = {}
    ranked = []
    for o in overlays:
        seen[o.recording] = seen.get(o.recording, 0) + 1
        ranked.append((seen[o.recording], o))
    return [o for _, o in sorted(ranked, key=lambda pair: pair[0])]


def curve_charts(diagnosis: Diagnosis) -> tuple[Chart, ...]:
    """A force over what it depends on, with its 95 % band, of each effect that has one."""
    return tuple(_curve(e, diagnosis, k) for k, e in enumerate(diagnosis.effects, 1) if e.curve)


def _curve(effect: NamedEffect, diagnosis: Diagnosis, index: int) -> Chart:
    curve = effect.curve or {}
    variable, _, of = str(curve["variable"]).partition(" [")
    points, force, std = (np.asarray(curve[key], float) for key in ("points", "force", "std"))
    turning = variable in ("angle", "turning speed")
    what, place = "Moment" if turning else "Force", place_words(effect.element, diagnosis.after)
    straight = _straight(effect, variable, diagnosis)
    return Chart(
        title=f"{what} over {variable}: the {place}",
        alt=f"{what} over {variable}, {number(force.min())} to {number(force.max())}.",
        name=f"curve-{index}",
        x=points, x_label=variable, x_unit=unit(of.rstrip("]")),
        y_label=what.lower(), y_unit="N m" if turning else "N",
        lines=(
            *((Line("model before", straight * points, "before"),) if straight is not None else ()),
            Line("found", force, "after"),
            Line("2.5 %", force - 1.96 * std, "limit"),
            Line("97.5 %", force + 1.96 * std, "limit"),
        ),
        band=True,
        caption="As far as the recordings went. Shaded: the 95 % band.",
    )  # fmt: skip


def _straight(effect: NamedEffect, variable: str, diagnosis: Diagnosis) -> float | None:
    """What the baseline has in place of the curve: stiffness over a deflection, damping over a speed."""
    key = {
        "displacement": "stiffness_N_m", "angle": "stiffness_N_m_rad", "velocity": "damping_N_s_m",
        "turning speed": "damping_N_m_s_rad",
    }.get(variable, "")  # fmt: skip
    path = f"springs.{effect.element}.{key}" if diagnosis.before.between else key
    return diagnosis.before.number(path) if path in diagnosis.before else None
