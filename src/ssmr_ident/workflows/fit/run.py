"""``ident fit``: every recording by its own method, then the parameters that explain all of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ssmr_ident import __version__
from ssmr_ident.campaign import Campaign, Measurement, load
from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.posterior.lmfit_report import Variable
from ssmr_ident.report.figures_fit import NamedBackbone, NamedPull, backbone_figure, sawtooth_figure
from ssmr_ident.report.style import save
from ssmr_ident.report.text_fit import fit_report

METHODS = ("output-error", "modal")


@dataclass(frozen=True, eq=False)
class SessionFit(Shown):
    """What ``ident fit`` found.

    Parameters
    ----------
    session : str
    before, parameters : ParameterSet
        As the file has them, and with the fit's values, standard deviations and sources.
    changed : tuple of str
        Paths that the fit was free to move.
    statistics : tuple of str
    recordings : dict of file to lines
    results : dict of file to numbers
        The same for programs, SI units in the keys.
    tables : tuple of str
    correlations : tuple of (name, name, number)
    findings : tuple of str
    conflicts : tuple of dict
        As in diagnosis.yaml.
    variables : tuple of Variable
        Every unknown of the fit, arrays part by part; empty takes ``changed``.
    backbones : tuple of NamedBackbone
    pulls : tuple of NamedPull
        For figures.
    """

    session: str
    before: ParameterSet
    parameters: ParameterSet
    changed: tuple[str, ...]
    statistics: tuple[str, ...]
    recordings: Mapping[str, tuple[str, ...]]
    results: Mapping[str, Mapping[str, Any]]
    tables: tuple[str, ...] = ()
    correlations: tuple[tuple[str, str, float], ...] = ()
    findings: tuple[str, ...] = ()
    conflicts: tuple[Mapping[str, Any], ...] = field(default_factory=tuple)
    variables: tuple[Variable, ...] = ()
    backbones: tuple[NamedBackbone, ...] = ()
    pulls: tuple[NamedPull, ...] = ()

    def __str__(self) -> str:
        return fit_report(
            self.session,
            self.statistics,
            self.recordings,
            self.tables,
            self.before,
            self.parameters,
            self.changed,
            self.correlations,
            self.findings,
            self.variables,
        )

    def write_figures(self, folder: Path) -> tuple[Path, ...]:
        """Draw frequency and damping over amplitude, and each pull taken apart; the files written.

        Parameters
        ----------
        folder : Path
            Made where it is missing.
        """
        drawn = [save(backbone_figure(self.backbones), folder / "backbone")] if self.backbones else []
        return (
            *drawn,
            *(save(sawtooth_figure(pull), folder / f"sawtooth-{Path(pull.name).stem}") for pull in self.pulls),
        )

    def as_dict(self) -> dict[str, Any]:
        """Plain values for ``--json``."""
        return {
            "session": self.session,
            "parameters": {
                path: {
                    "value": _plain(self.parameters[path].value),
                    "std": self.parameters[path].std,
                    "unit": self.parameters[path].unit,
                    "source": self.parameters[path].source,
                    "at_bound": self.parameters[path].at_bound,
                }
                for path in self.changed
            },
            "variables": [
                {"name": v.name, "value": v.value, "std": v.std, "unit": v.unit, "source": v.source}
                for v in self.variables
            ],
            "recordings": [{"file": file, **numbers} for file, numbers in self.results.items()],
            "parameters_in_conflict": [dict(conflict) for conflict in self.conflicts],
            "findings": list(self.findings),
        }


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


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
    if parameters is not None:
        campaign = replace(campaign, parameters=parameters)
    chosen = fitted_measurements(campaign)
    if campaign.session.baseline == "sdof":
        from ssmr_ident.workflows.fit.rig import fit_rig_session

        step("fitting the rig", 0, 1)
        fit = fit_rig_session(campaign, chosen, coulomb)
        step("fitting the rig", 1, 1)
    elif campaign.session.baseline == "drag":
        from ssmr_ident.workflows.fit.drag import fit_drag_session

        step("fitting the block", 0, 1)
        fit = fit_drag_session(campaign, chosen)
        step("fitting the block", 1, 1)
    else:
        from ssmr_ident.workflows.fit.robot import fit_robot_session

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
