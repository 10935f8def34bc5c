"""``ident fit``: every recording by its own method, then the parameters that explain all of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ssmr_ident import __version__
from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import Campaign, Measurement, load
from ssmr_ident.physics.network import NETWORK
from ssmr_ident.workflows.fit.drag import fit_drag_session
from ssmr_ident.workflows.fit.network import fit_network_session
from ssmr_ident.workflows.fit.result import SessionFit
from ssmr_ident.workflows.fit.rig import fit_rig_session
from ssmr_ident.workflows.fit.robot import fit_robot_session

METHODS = ("output-error", "modal")


def fit_session(
    path: str | Path,
    seed: int = 0,
    coulomb: bool = True,
    parameters: ParameterSet | None = None,
    method: str | None = None,
    progress: Callable[[str, int, int], None] | None = None,
) -> SessionFit:
    """Fit a session folder.

    Parameters
    ----------
    path : path of the folder or of its session.yaml
    seed : int
        Of the random starts of output error; written into the result.
    coulomb : bool
        Allow dry friction and a force offset where a drive without a spring is fitted.
    parameters : ParameterSet or None
        What is known beforehand; None takes the session's robot file.
    method : {"output-error", "modal"} or None
        How a robot's free responses are fitted; None takes output error wherever it can be had. Rigs and blocks have
        one method, which is output error already.
    progress : callable, optional
        Called with what is being done, how much of it is done, and of how much.

    Returns
    -------
    SessionFit

    Raises
    ------
    InputError
        Names the file, the place and the mend.
    """
    if method not in (None, *METHODS):
        raise InputError("--method", f"is {method!r}, expected {' or '.join(METHODS)}", did_you_mean(method, METHODS))
    step = progress or (lambda stage, done, total: None)
    campaign = load(path, lambda done, total: step("reading logs", done, total))
    return fit_campaign(campaign, seed, coulomb, parameters, method, step)


def fit_campaign(
    campaign: Campaign,
    seed: int = 0,
    coulomb: bool = True,
    parameters: ParameterSet | None = None,
    method: str | None = None,
    step: Callable[[str, int, int], None] = lambda stage, done, total: None,
) -> SessionFit:
    """As ``fit_session``, of a session whose logs are read already."""
    if parameters is not None:
        campaign = replace(campaign, parameters=parameters)
    chosen = fitted_measurements(campaign)
    if campaign.session.baseline == "sdof":
        step("fitting the rig", 0, 1)
        fit = fit_rig_session(campaign, chosen, coulomb)
        step("fitting the rig", 1, 1)
    elif campaign.session.baseline == NETWORK:
        step("fitting the network", 0, 1)
        fit = fit_network_session(campaign, chosen)
        step("fitting the network", 1, 1)
    elif campaign.session.baseline == "drag":
        step("fitting the block", 0, 1)
        fit = fit_drag_session(campaign, chosen)
        step("fitting the block", 1, 1)
    else:
        fit = fit_robot_session(campaign, chosen, method, seed, step)
    return _with_provenance(fit, campaign, chosen, seed, {"coulomb": coulomb, "method": method or "best"})


def fitted_measurements(campaign: Campaign) -> tuple[Measurement, ...]:
    """Calibration recordings where there are any, otherwise the targets; never the held-out ones.

    Raises
    ------
    InputError
        When nothing is left.
    """
    for role in ("calibration", "target"):
        chosen = tuple(m for m in campaign.measurements if m.entry.role == role)
        if chosen:
            return chosen
    raise InputError(
        f"{campaign.session.folder}/session.yaml: recordings",
        "all are heldout, so nothing may be fitted",
        "Give at least one recording role: target",
    )


def _with_provenance(
    fit: SessionFit, campaign: Campaign, chosen: tuple[Measurement, ...], seed: int, settings: Mapping[str, Any]
) -> SessionFit:
    """Add who, from what and how: no time and no absolute path, so that the same command writes the same file."""
    provenance = {
        "command": "ident fit",
        "version": __version__,
        "session": campaign.session.name,
        "baseline": campaign.session.baseline,
        "seed": seed,
        "settings": {**settings, "role": chosen[0].entry.role},
        "files": [
            {"file": m.name, "sha256": m.recording.provenance.sha256, "reader": m.recording.provenance.reader}
            for m in chosen
        ],
        "findings": list(fit.findings),
    }
    return replace(fit, parameters=replace(fit.parameters, provenance=provenance))
