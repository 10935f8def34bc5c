"""The main job, end to end: raw logs to spectra, to parameters, to a simulation, and back to the logs."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from ssmr_ident.compare import Comparison, compare
from ssmr_ident.core.atomic import make_folder
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import load
from ssmr_ident.session import write_parameters
from ssmr_ident.workflows.demo.simulated import write_simulated_session
from ssmr_ident.workflows.demo.table import DemoTable, demo_table
from ssmr_ident.workflows.fit.result import SessionFit
from ssmr_ident.workflows.fit.run import fit_session
from ssmr_ident.workflows.spectrum.files import write as write_spectrum
from ssmr_ident.workflows.spectrum.run import SpectrumReport, spectrum

COMPARED = ("free_response/session.yaml", "pulls/concrete.yaml", "swivel-frame/concrete.yaml")
SWIVELS = ("swivel-frame/session.yaml", "swivel-platform/session.yaml")
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, eq=False)
class Demo:
    """Everything that the main job found.

    Parameters
    ----------
    spectra : tuple of SpectrumReport
        Of the swivels.
    pulls, carpet, decays : SessionFit
        Pulls on two floors, then the free responses with what the pulls told as prior knowledge.
    parameters : ParameterSet
        The outcome.
    comparisons : tuple of Comparison
    table : DemoTable
        Published, identified and simulated values side by side.
    output : Path
    """

    spectra: tuple[SpectrumReport, ...]
    pulls: SessionFit
    carpet: SessionFit
    decays: SessionFit
    parameters: ParameterSet
    comparisons: tuple[Comparison, ...]
    table: DemoTable
    output: Path


def check_data(data: Path) -> None:
    """Whether a folder holds the reference campaign.

    Raises
    ------
    InputError
        It does not.
    """
    if not (data / "raw" / "free_response" / "session.yaml").is_file():
        problem = "holds no reference campaign (raw/free_response/session.yaml)"
        raise InputError(str(data), problem, "In a checkout the folder is data")


def run_demo(data: Path, output: Path, progress: Progress) -> Demo:
    """Run the main job.

    Parameters
    ----------
    data : Path
        Folder with ``raw`` and ``published``.
    output : Path
        Parameters, tables and simulated logs go here; made when it does not exist.
    progress : callable
        Called with the name of a stage, how much of it is done, and of how much.
    """
    raw = data / "raw"
    make_folder(output)
    spectra = []
    for index, name in enumerate(SWIVELS):
        progress("spectra of the swivels", index, len(SWIVELS))
        report = spectrum([raw / name])
        spectra.append(write_spectrum(report, output / f"spectra-{Path(name).parent.name}", figures=False))
    progress("spectra of the swivels", len(SWIVELS), len(SWIVELS))
    progress("parameters from pulls and decays", 0, 3)
    pulls = fit_session(raw / "pulls" / "concrete.yaml")
    progress("parameters from pulls and decays", 1, 3)
    carpet = fit_session(raw / "pulls" / "carpet.yaml")
    progress("parameters from pulls and decays", 2, 3)
    decays = fit_session(raw / "free_response", parameters=pulls.parameters)
    progress("parameters from pulls and decays", 3, 3)
    parameters = _joined(pulls, decays)
    write_parameters(output / "parameters.yaml", parameters)
    comparisons = []
    for name in COMPARED:
        stage = f"simulation against {Path(name).parent.name}"
        campaign = load(raw / name)
        comparisons.append(compare(campaign, parameters, partial(progress, stage)))
    progress("the simulator's own logs, identified again", 0, 1)
    simulated = _identify_simulated(parameters, output / "simulated")
    progress("the simulator's own logs, identified again", 1, 1)
    table = demo_table(data / "published", pulls, carpet, decays, simulated)
    return Demo(tuple(spectra), pulls, carpet, decays, parameters, tuple(comparisons), table, output)


def _joined(pulls: SessionFit, decays: SessionFit) -> ParameterSet:
    """The last fit's parameters with the origin of both."""
    provenance = {"first": dict(pulls.parameters.provenance), "then": dict(decays.parameters.provenance)}
    return replace(decays.parameters, provenance=provenance, file="out/parameters.yaml")


def _identify_simulated(parameters: ParameterSet, folder: Path) -> SessionFit:
    """Write what the simulator makes of the parameters as logs, and identify those like any other."""
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    write_simulated_session(parameters, folder)
    return fit_session(folder)
