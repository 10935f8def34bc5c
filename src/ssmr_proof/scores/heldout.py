"""How well a diagnosis predicts recordings that it never saw, and how well the baseline had hidden the effect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.compare import compare
from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import load
from ssmr_ident.session import read_parameters

SHOWN = 1  # shifts named in a table


@dataclass(frozen=True)
class Shift:
    """A parameter of the refitted baseline: away from what was known, in its standard deviations, and from the truth,
    as a share of it."""

    parameter: str
    sigmas: float
    off: float | None


@dataclass(frozen=True)
class HeldOut:
    """One case on its sealed recordings [%], each tuple in the order of the recordings.

    Parameters
    ----------
    before, after, floor : tuple of float
        Of the refitted baseline, of the extended model, of noise alone.
    shifts : tuple of Shift
        Largest first.
    problem : str
        Why there is nothing, if so.
    """

    before: tuple[float, ...] = ()
    after: tuple[float, ...] = ()
    floor: tuple[float, ...] = ()
    shifts: tuple[Shift, ...] = field(default=())
    problem: str = ""

    @property
    def means(self) -> tuple[float, float, float]:
        """Before, after, floor; NaN where there is nothing."""
        if not self.before:
            return (float("nan"), float("nan"), float(np.mean(self.floor)) if self.floor else float("nan"))
        return (float(np.mean(self.before)), float(np.mean(self.after)), float(np.mean(self.floor)))

    @property
    def excess(self) -> float:
        """What the refitted baseline leaves beyond the noise, over the noise: √(before² − floor²)/floor."""
        before, _, floor = self.means
        return float(np.sqrt(max(before**2 - floor**2, 0.0)) / floor)


def judged(heldout: Path, answer: Path, truth: Mapping[str, Any]) -> HeldOut:
    """Simulate the held-out recordings with the baseline and with the extended model that a diagnosis wrote.

    Parameters
    ----------
    heldout : Path
        Session folder.
    answer : Path
        With before.yaml and after.yaml.
    truth : mapping
    """
    floors = tuple(map(float, truth["heldout"]["noise_floors"]))
    try:
        campaign = load(heldout)
        before, after = (read_parameters(str(answer / f"{name}.yaml")) for name in ("before", "after"))
        errors = [tuple(r.value for r in compare(campaign, model).recordings) for model in (before, after)]
    except (InputError, SimulationError) as error:
        return HeldOut(floor=floors, problem=str(error))
    return HeldOut(errors[0], errors[1], floors, shifts(campaign.parameters, before, truth["true_robot"]))


def shifts(known: ParameterSet, fitted: ParameterSet, true: Mapping[str, float]) -> tuple[Shift, ...]:
    """How far a refit moved the parameters that have a prior, largest first."""
    found = []
    for name, estimate in known.items():
        if estimate.std and name in fitted and np.ndim(estimate.value) == 0:
            value = float(fitted[name].value)
            off = value / true[name] - 1.0 if true.get(name) else None
            found.append(Shift(name, (value - float(estimate.value)) / estimate.std, off))
    return tuple(sorted(found, key=lambda shift: -abs(shift.sigmas)))
