"""Explanations of swivels: a baseline with or without one effect, at one place, and what that is worth."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.doctor.swivels.anchor import Anchor
from ssmr_ident.doctor.swivels.candidates import Candidate, Values
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.likelihood import Score


@dataclass(frozen=True, eq=False)
class Explained:
    """One explanation at one place.

    Parameters
    ----------
    candidate : Candidate or None
        None is the baseline.
    values : dict
        Of the candidate's free parameters.
    anchor : Anchor
        Baseline that it goes with.
    target : Score
    share : float
        Of what the anchor misses on calibration recordings, carried over.
    evidence : float
        Log posterior, less what free parameters cost.
    spread : (q,) float or None
        Standard deviations of the free parameters on the scales of the search.
    held : Score or None
        On recordings kept back, where it was asked for.
    """

    candidate: Candidate | None
    values: Values
    anchor: Anchor
    target: Score
    share: float
    evidence: float
    spread: np.ndarray | None = None
    held: Score | None = None

    @property
    def id(self) -> str:
        return "baseline" if self.candidate is None else self.candidate.id

    @property
    def effects(self) -> dict[str, Values]:
        return {} if self.candidate is None else self.candidate.effects(self.values)

    @property
    def place(self) -> np.ndarray:
        """(p + q,) float: the baseline's parameters and the effect's own, on the scales of the search."""
        own = np.zeros(0) if self.candidate is None else self.candidate.position(self.values)
        return np.concatenate([self.anchor.z, own])

    def at(self, place: np.ndarray) -> tuple[Anchor, Values]:
        """Baseline and values of the effect at a place."""
        size = len(self.anchor.priors)
        values = {} if self.candidate is None else self.candidate.values(place[size:])
        return replace(self.anchor, z=place[:size]), values


def cost(candidate: Candidate | None, conditions: tuple[Condition, ...]) -> float:
    """Half the logarithm of the number of independent values per free parameter (BIC)."""
    if candidate is None:
        return 0.0
    values = sum(c.mean.cross.shape[0] * len(c.names) / 2.0 for c in conditions)
    return 0.5 * max(len(candidate.free), 1) * float(np.log(values))


def explained(
    anchor: Anchor, candidate: Candidate | None, values: Values, conditions: tuple[Condition, ...]
) -> Explained | None:
    """Score one explanation with one set of values, its baseline on calibration too; None where they make no robot."""
    effects = {} if candidate is None else candidate.effects(values)
    found = anchor.score(conditions, effects)
    if found is None:
        return None
    evidence = found[0].log_likelihood + anchor.log_prior() - cost(candidate, conditions)
    if anchor.calibration:
        held = replace(anchor, calibration=()).score(anchor.calibration, {})
        if held is None:
            return None
        anchor = replace(anchor, fit=held[0])
        evidence += held[0].log_likelihood
    return Explained(candidate, values, anchor, found[0], found[1], evidence)
