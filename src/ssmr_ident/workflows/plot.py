"""One call that draws whatever it is given; a notebook shows the figure by itself."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from matplotlib.figure import Figure

from ssmr_ident.compare.comparison import Comparison, RecordingComparison
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.recording import Recording
from ssmr_ident.diagnose import Diagnosis
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.experiment import ACCELERATIONS
from ssmr_ident.physics.effect import Effect
from ssmr_ident.report.courses import courses_figure
from ssmr_ident.report.diagnosis_charts import after_name
from ssmr_ident.report.effect_figure import effect_figure
from ssmr_ident.report.figures_diagnosis import overlay_panel
from ssmr_ident.report.figures_fit import backbone_figure, sawtooth_figure
from ssmr_ident.report.figures_spectrum import NamedAnalysis, recording_figure
from ssmr_ident.report.overlay import overlay_figure
from ssmr_ident.simulate.simulation import Simulation
from ssmr_ident.workflows.effects.panels import panels
from ssmr_ident.workflows.fit.result import SessionFit
from ssmr_ident.workflows.spectrum.files import MOST_PANELS
from ssmr_ident.workflows.spectrum.run import SpectrumReport


@singledispatch
def plot(thing: Any, name: str = "") -> Figure:
    """Draw a result.

    Parameters
    ----------
    thing : Recording, Measurement, Simulation, Prediction, Comparison, SessionFit, SpectrumReport, Effect, Diagnosis
        Courses over time; recorded over simulated; frequency over amplitude, or a pull taken apart; spectra; what an
        effect does; what a diagnosis explains.
    name : str
        Which recording, for results with several; empty takes the one that tells most.

    Returns
    -------
    Figure
        Shows itself in a notebook; ``figure.savefig(path)`` writes it.
    """
    kinds = sorted(kind.__name__ for kind in plot.registry if kind is not object)
    raise TypeError(f"{type(thing).__name__} cannot be drawn; {', '.join(kinds)} can")


@plot.register
def _(thing: Recording, name: str = "") -> Figure:
    return courses_figure(thing)


@plot.register
def _(thing: Measurement, name: str = "") -> Figure:
    return courses_figure(thing.recording, f"{thing.name}: {thing.experiment.words}")


@plot.register
def _(thing: Simulation, name: str = "") -> Figure:
    return courses_figure(thing.recording(*(("force",) if thing.scenario.pulled else ACCELERATIONS)))


@plot.register
def _(thing: Prediction, name: str = "") -> Figure:
    return overlay_figure(thing, name or "recorded and simulated")


@plot.register
def _(thing: RecordingComparison, name: str = "") -> Figure:
    return overlay_figure(thing.prediction, f"{thing.file}: {thing.experiment.replace('_', ' ')}")


@plot.register
def _(thing: Comparison, name: str = "") -> Figure:
    """The recording that is farthest apart."""
    files = [recording.file for recording in thing.recordings]
    _known(name, files)
    return plot(thing[name] if name else max(thing.recordings, key=lambda recording: recording.value))


@plot.register
def _(thing: SessionFit, name: str = "") -> Figure:
    """Frequency and damping over amplitude where decays were fitted, else the first pull."""
    _known(name, [pull.name for pull in thing.pulls])
    if thing.backbones and not name:
        return backbone_figure(thing.backbones)
    if thing.pulls:
        return sawtooth_figure(next(pull for pull in thing.pulls if name in ("", pull.name)))
    raise InputError(thing.session, "has neither decays nor pulls to draw", "Plot a comparison with it instead")


@plot.register
def _(thing: SpectrumReport, name: str = "") -> Figure:
    files = list(dict.fromkeys(row.label.file for row in thing.rows))
    _known(name, files)
    rows = [row for row in thing.rows if row.label.file == (name or files[0])]
    chosen = ([row for row in rows if row.unit == "m/s^2"] or rows)[:MOST_PANELS]
    return recording_figure(name or files[0], [NamedAnalysis(row.channel, row.unit, row.analysis) for row in chosen])


@plot.register
def _(thing: Effect, name: str = "") -> Figure:
    return effect_figure(thing.id, thing.sentence, panels(thing, thing.values()))


@plot.register
def _(thing: Diagnosis, name: str = "") -> Figure:
    """The held-out recording on which the added physics gains most."""
    overlays = [o for o in thing.evidence.overlays if o.heldout] or list(thing.evidence.overlays)
    _known(name, [overlay.recording for overlay in thing.evidence.overlays])
    chosen = [o for o in thing.evidence.overlays if o.recording == name] if name else overlays
    if not chosen:
        raise InputError(thing.session, "holds no evidence to draw", "Keep the one that diagnose returned")
    return overlay_panel(max(chosen, key=lambda o: o.metric[0] - o.metric[1]), after_name(thing))


def _known(name: str, names: list[str]) -> None:
    if name and name not in names:
        raise InputError("plot", f"no recording {name!r} to draw", did_you_mean(name, names))
