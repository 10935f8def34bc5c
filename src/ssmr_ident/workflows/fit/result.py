"""What ``ident fit`` found, as a value that prints, draws itself and travels as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.parameter import FITTED, ParameterSet
from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.lmfit_report import Variable, variables_frame
from ssmr_ident.report.figures_fit import (
    NamedBackbone,
    NamedDecay,
    NamedPull,
    backbone_figure,
    envelope_figure,
    sawtooth_figure,
)
from ssmr_ident.report.style import save
from ssmr_ident.report.text_fit import file_variables, fit_report

if TYPE_CHECKING:
    import pandas as pd


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
    decays : tuple of NamedDecay
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
    decays: tuple[NamedDecay, ...] = ()

    def to_frame(self) -> pd.DataFrame:
        """A row an unknown of the fit, by name: ``value``, ``std``, ``unit``, ``before``, ``before_std``, ``source``.

        All parameters, those that stayed among them, are ``parameters.to_frame()``.
        """
        return variables_frame(self.variables or file_variables(self.before, self.parameters, self.changed))

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
        """Draw decays under their envelopes, frequency and damping over amplitude, each pull taken apart.

        Frequency and damping over amplitude are also a table, ``over_amplitude.csv``.

        Parameters
        ----------
        folder : Path
            Made where it is missing.
        """
        drawn = [save(backbone_figure(self.backbones), folder / "backbone")] if self.backbones else []
        if self.backbones:
            write_text(folder / "over_amplitude.csv", over_amplitude(self.backbones))
        return (
            *drawn,
            *(
                save(envelope_figure([d for d in self.decays if d.motion == motion]), folder / f"envelope-{motion}")
                for motion in dict.fromkeys(decay.motion for decay in self.decays)
            ),
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
                {"name": v.name, "value": v.value, "std": v.std, "unit": v.unit, "source": _told_by(v.source)}
                for v in self.variables
            ],
            "recordings": [{"file": file, **numbers} for file, numbers in self.results.items()],
            "parameters_in_conflict": [dict(conflict) for conflict in self.conflicts],
            "findings": list(self.findings),
        }


def over_amplitude(backbones: Sequence[NamedBackbone]) -> str:
    """Frequency and damping of every window of every decay, comma-separated."""
    lines = ["recording,motion,amplitude,unit,omega_n_rad_s,omega_n_std_rad_s,xi,xi_std"]
    for own in backbones:
        trend = own.backbone
        columns = (trend.amplitude, trend.omega_n, trend.omega_n_std, trend.xi, trend.xi_std)
        for amplitude, *rest in zip(*columns, strict=True):
            numbers = ",".join(f"{value:.8g}" for value in rest)
            lines.append(f'"{own.name}",{own.group},{amplitude:.8g},{own.unit},{numbers}')
    return "\n".join(lines) + "\n"


def _told_by(source: str) -> str:
    """Whether recordings or a prior tell a value, in the two words of the answer."""
    return "data" if source.startswith(("data", FITTED)) else "prior"


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value
