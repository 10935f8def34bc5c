"""Figures that show where a mismatch sits: in time and pitch, in the motion, along an axis, over turning speed."""

from __future__ import annotations

from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.diagnose.evidence import SpeedMap
from ssmr_ident.report.diagnosis_charts import after_name, before_name
from ssmr_ident.report.figures_diagnosis import drift_panel
from ssmr_ident.report.figures_residual import cut_panel, residual_map_panel, surface_panel
from ssmr_ident.report.figures_waterfall import level_panel, many, stacked_panel, waterfall_panel
from ssmr_ident.report.html import Drawing, Picture, drawing
from ssmr_ident.report.numbers import number

SHOWN_MAPS, SHOWN_SURFACES, SHOWN_DRIFTS = 2, 2, 4
"""As many of each as a reader looks at; diagnosis.yaml holds the rest in numbers."""


def places(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    """Residual maps, force surfaces, drifting parameters, waterfalls."""
    return (*_waterfalls(diagnosis), *_maps(diagnosis), *_surfaces(diagnosis), *_drifts(diagnosis))


def _maps(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    after, pictures = after_name(diagnosis), []
    for index, m in enumerate(diagnosis.evidence.maps[:SHOWN_MAPS], 1):
        name, drawings = f"{m.recording}, {m.channel}", []
        panels = [("before", m.before, before_name(diagnosis))] + ([("after", m.after, after)] if after else [])
        for tag, power, title in panels:
            above = number(100 * float((power > m.threshold_db).mean()), 2)
            alt = f"{name}, {title}: {above} % of the map lies above what noise makes once in 100 maps."
            drawings.append(drawing(residual_map_panel(m, power, title), alt, f"residual-map-{index}-{tag}"))
        caption = (
            "When (from left to right) and at which frequency (from low to high) the model differs from the "
            "recording. Pale speckle is what noise alone makes. Full colour with a line round it is more than noise "
            f"alone would show in one of 100 such maps: above {number(m.threshold_db)} dB, marked on the scale."
        )
        pictures.append(Picture(tuple(drawings), caption, f"What is left over, by time and frequency: {name}"))
    return tuple(pictures)


def _surfaces(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    after, pictures = after_name(diagnosis), []
    surfaces = [s for s in diagnosis.evidence.surfaces if len(s.displacement)]
    for index, s in enumerate(surfaces[:SHOWN_SURFACES], 1):
        alt = f"{s.recording}: force that the model does not explain, over displacement and velocity, {s.where}"
        panels = [("before", s.before, before_name(diagnosis))] + ([("after", s.after, after)] if after else [])
        drawings = [
            drawing(surface_panel(s, force, title), f"{alt}; {title}.", f"force-surface-{index}-{tag}")
            for tag, force, title in panels
        ]
        drawings += [
            drawing(cut_panel(s, over, after), f"{alt}; over {over} alone.", f"force-over-{over}-{index}")
            for over in ("displacement", "velocity")
        ]
        caption = (
            "The force that the model does not explain, wherever the motion came. Orange "
            "pushes one way, blue the other, uncoloured is explained, grey was never reached. Then the same force over "
            "displacement and over velocity alone, with the middle 80 % of its values shaded: a bend over displacement "
            "is a spring that is not straight, a step over velocity is friction, a flat line at zero leaves nothing "
            "to explain."
        )
        pictures.append(Picture(tuple(drawings), caption, f"The force that is not explained: {s.recording}, {s.where}"))
    return tuple(pictures)


def _drifts(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    drifts = sorted(diagnosis.evidence.drifts, key=lambda d: d.p_value)[:SHOWN_DRIFTS]
    if not drifts:
        return ()
    drawings = []
    for index, d in enumerate(drifts, 1):
        low, high = number(float(d.value.min())), number(float(d.value.max()))
        alt = (
            f"{d.parameter} refitted along {d.along}: {low} to {high} times the whole fit, p = {number(d.p_value, 2)}."
        )
        drawings.append(drawing(drift_panel(d), alt, f"drift-{index}"))
    caption = (
        "A constant of the model, fitted again to parts of the recordings. If the model were complete, every part "
        "would give the same value (dashed line). Bars are 95 % intervals; p is how often chance alone orders the "
        "points so well."
    )
    caption = " ".join((caption, *dict.fromkeys(f"{d.reading.rstrip('.')}." for d in drifts if d.reading)))
    return (Picture(tuple(drawings), caption, "Are the model's constants constant?"),)


def _waterfalls(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    speeds, after = diagnosis.evidence.speeds, after_name(diagnosis)
    drawings: list[Drawing] = []
    for index, s in enumerate(speeds, 1):
        drawings += _map_drawings(diagnosis, s, index) if many(s) else [_stacked_drawing(s, after, index)]
    if not drawings:
        return ()
    how = "fuller colour is stronger" if many(speeds[0]) else "higher is stronger; one turning speed above the other"
    caption = (
        f"How strongly the robot shakes at each frequency and turning speed, axis by axis ({how}), and how far the "
        "levels of recorded and simulated spectra are apart (root mean square over frequencies). A line that keeps its "
        "frequency comes from the structure, one that rises with speed from wheels or floor; dashed and dotted lines "
        "show where each candidate would lie."
    )
    return (Picture(tuple(drawings), caption, "Vibration over turning speed"),)


def _map_drawings(diagnosis: Diagnosis, s: SpeedMap, index: int) -> list[Drawing]:
    after = after_name(diagnosis)
    panels = [("recorded", s.recorded, "recorded"), ("before", s.before, before_name(diagnosis))]
    panels += [("after", s.after, after)] if after else []
    drawings = []
    for tag, density, title in panels:
        alt = f"{s.channel}, {title}: power of the vibration over turning speed and frequency."
        panel = waterfall_panel(s, density, f"{s.channel}, {title}")
        drawings.append(drawing(panel, alt, f"waterfall-{index}-{tag}"))
    alt = f"{s.channel}: difference in level between recorded and simulated spectra at each turning speed."
    return [*drawings, drawing(level_panel(s, after), alt, f"levels-{index}")]


def _stacked_drawing(s: SpeedMap, after: str, index: int) -> Drawing:
    alt = f"{s.channel}: recorded and simulated spectra at {len(s.speed)} turning speeds, one above the other."
    return drawing(stacked_panel(s, after), alt, f"waterfall-{index}")
