"""Every result shows itself in a notebook, escaped, and figures need no pyplot."""

from __future__ import annotations

import dataclasses
import importlib
import pkgutil
from collections.abc import Iterator

import numpy as np

import ssmr_ident
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Note, Provenance, Recording

NEEDS = {"mujoco"}  # beside the package's own dependencies


def _results() -> Iterator[type]:
    """Dataclasses of the package that say how they print."""
    for module in pkgutil.walk_packages(ssmr_ident.__path__, "ssmr_ident."):
        if module.name.endswith("__main__"):
            continue
        try:
            content = importlib.import_module(module.name)
        except ModuleNotFoundError as error:
            if error.name in NEEDS:
                continue
            raise
        for thing in vars(content).values():
            if isinstance(thing, type) and dataclasses.is_dataclass(thing) and thing.__module__ == module.name:
                yield thing


def test_what_prints_shows_itself_in_a_notebook() -> None:
    prints = [result for result in _results() if "__str__" in vars(result)]
    silent = [f"{r.__module__}.{r.__name__}" for r in prints if not hasattr(r, "_repr_html_")]
    assert len(prints) > 30
    assert not silent


def test_text_is_escaped() -> None:
    recording = Recording(
        np.arange(3.0),
        (Channel("ay", np.array([-1.0, 0.0, 1.0]), "m/s^2", "<b>a</b>"),),
        Provenance("log<1>.csv", "", "csv"),
        (Note("warning", "x < 0 & more"),),
    )
    shown = recording._repr_html_()
    assert "&lt;b&gt;a" in shown
    assert "<b>a" not in shown
    assert "x &lt; 0 &amp; more" in shown
    assert "1 Hz" in shown


def test_a_parameter_set_is_a_table_with_its_sources() -> None:
    known = ParameterSet("rig", {"mass_kg": Estimate(8.0, 0.1, "kg", "weighed", fixed=True)})
    shown = known._repr_html_()
    assert "8 ± 0.1 kg" in shown
    assert "weighed, fixed" in shown


def test_a_figure_shows_itself_as_png() -> None:
    from ssmr_ident.report.style import new_figure

    figure = new_figure(2.0, 1.0)
    figure.subplots().plot([0, 1])
    assert figure._repr_png_().startswith(b"\x89PNG")
