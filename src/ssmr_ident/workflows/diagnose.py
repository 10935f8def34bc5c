"""``ident diagnose``: from a session to what physics was left out, its files and its report."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from ssmr_ident.core.atomic import make_folder, write_text
from ssmr_ident.core.documents import yaml_text
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.diagnosis import Diagnosis, NamedEffect
from ssmr_ident.doctor.blocks import BLOCK, diagnose_block
from ssmr_ident.doctor.decays.decoupled import diagnose as diagnose_decoupled
from ssmr_ident.doctor.decays.run import diagnose as diagnose_decays
from ssmr_ident.doctor.decays.run import takes as of_decays
from ssmr_ident.doctor.robots.run import diagnose as diagnose_robot
from ssmr_ident.doctor.run import diagnose as diagnose_rig
from ssmr_ident.experiments.campaign import Campaign, load
from ssmr_ident.experiments.experiment import RIGS
from ssmr_ident.session import write_parameters
from ssmr_ident.session.effects_block import in_rotary_units
from ssmr_ident.workflows.files_read import files_read

Progress = Callable[[str, int, int], None]


def diagnose(
    campaign: Campaign,
    parameters: ParameterSet | None = None,
    seed: int = 0,
    progress: Progress | None = None,
    budget: float = math.inf,
) -> Diagnosis:
    """Locate the mismatch between recordings and baseline, name it, model it, and prove it on recordings kept back.

    Parameters
    ----------
    campaign : Campaign
    parameters : ParameterSet, optional
        What is known beforehand, in place of the session's own file.
    seed : int
        Of permutations and simulated floors.
    progress : callable, optional
        Called with the name of a stage, what of it is done, and of how much.
    budget : float [s]
        Of a rig: after it nothing new is tried, and the answer says what was not.

    Raises
    ------
    InputError
        A recording that the baseline has no model of, or nothing to fit.
    """
    known = campaign.parameters if parameters is None else parameters
    # recordings are simulated side by side; matrices are small, and threads of their own would stand in the way
    with threadpool_limits(1, user_api="blas"):
        found = _diagnosed(replace(campaign, parameters=known), known, seed, progress, budget)
    return in_rig_units(found) if known.rotary else found


def in_rig_units(found: Diagnosis) -> Diagnosis:
    """The diagnosis of a rotary rig with its effects' parameters in moments and angles, on the page and in files."""
    named = tuple(
        replace(
            effect, sentence=_told_in_moments(effect), parameters=in_rotary_units(effect.parameters),
            curve=_over_angle(effect.curve),
        )
        for effect in found.effects
    )  # fmt: skip
    after = {name: in_rotary_units(estimates) for name, estimates in found.after.effects.items()}
    return replace(found, effects=named, after=replace(found.after, effects=after))


def _told_in_moments(effect: NamedEffect) -> str:
    """Its sentence with the numbers that it ends in as they are on a rotary rig."""
    sentence = effect.sentence
    for (name, straight), (turned, moment) in zip(
        effect.parameters.items(), in_rotary_units(effect.parameters).items(), strict=True
    ):
        sentence = sentence.replace(f"{name} = {straight}", f"{turned} = {moment}")
    return sentence


def _over_angle(curve: Mapping[str, Any] | None) -> Mapping[str, Any] | None:
    """A curve of a rotary rig, over an angle or a turning speed."""
    turned = {"displacement [m]": "angle [rad]", "velocity [m/s]": "turning speed [rad/s]"}
    return {**curve, "variable": turned.get(curve["variable"], curve["variable"])} if curve else curve


def _diagnosed(
    campaign: Campaign, known: ParameterSet, seed: int, progress: Progress | None, budget: float
) -> Diagnosis:
    if campaign.session.baseline in RIGS:
        return diagnose_rig(campaign, known, seed, progress, budget)
    if math.isfinite(budget):
        raise InputError("--budget", f"limits a rig's search; this session's baseline is {campaign.session.baseline}",
                         "Leave it out")  # fmt: skip
    if campaign.session.baseline == BLOCK:
        return diagnose_block(campaign, known, progress)
    if not all(m.experiment.repeats for m in campaign.measurements):
        from ssmr_ident.doctor.swivels import diagnose_swivels

        return diagnose_swivels(campaign, known, seed, progress)
    if campaign.session.baseline == "decoupled":
        return diagnose_decoupled(campaign, known, seed, progress)
    search = diagnose_decays if of_decays(campaign, known) else diagnose_robot
    return search(campaign, known, seed, progress)


def diagnose_session(
    path: str | Path, parameters: ParameterSet | None = None, seed: int = 0, progress: Progress | None = None
) -> Diagnosis:
    """Read a session folder and diagnose it; see ``diagnose``."""
    return diagnose(load(path), parameters, seed, progress)


def write_diagnosis(
    diagnosis: Diagnosis,
    campaign: Campaign,
    out: Path,
    command: str = "",
    seed: int = 0,
    files: Sequence[Path] = (),
    report: bool = True,
) -> None:
    """diagnosis.yaml, before.yaml, after.yaml, report.html and its figures.

    Parameters
    ----------
    diagnosis : Diagnosis
    campaign : Campaign
    out : Path
        A folder; made where it is missing.
    command : str
        The call, for the report's last lines.
    seed : int
    files : sequence of Path
        What was read, for their SHA-256; empty takes the session's file, robot and logs.
    report : bool
        Whether report.html and its figures are drawn.
    """
    make_folder(out)
    write_parameters(out / "before.yaml", diagnosis.before)
    write_parameters(out / "after.yaml", diagnosis.after)
    write_text(out / "diagnosis.yaml", yaml_text(diagnosis.as_dict()))
    if report:  # what was found stands before anything is drawn of it
        from ssmr_ident.report.diagnosis_page import write_report

        write_report(diagnosis, out / "report.html", command, seed, files or files_read(campaign.session.folder))
