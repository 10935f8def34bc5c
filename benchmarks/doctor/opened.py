"""A session of the frozen set with its campaign and what is right."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.experiments.campaign import Campaign


@dataclass(frozen=True, eq=False)
class Opened:
    """What an engine is given, and what its answer is held against.

    Parameters
    ----------
    campaign : Campaign
    seed : int
        Of the engine's own permutations.
    right : tuple of tuples of str
        Sets of names any of which is right; one empty set where nothing is missing.
    effects : mapping of effect to parameter to float
        True values, as far as the catalogue's formula has them.
    parameters : mapping of path to float
        True values of the plant.
    floors : mapping of recording to float
        What the true signals leave of the metric.
    heldout : callable, optional
        Before, after and the floor on recordings that the engine never saw, where there are some.
    claims : callable, optional
        What the answer must show beside the names, in words, and whether it does.
    """

    campaign: Campaign
    seed: int
    right: tuple[tuple[str, ...], ...]
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    floors: Mapping[str, float] = field(default_factory=dict)
    heldout: Callable[[Diagnosis], tuple[float, float, float]] | None = None
    claims: Callable[[Diagnosis], Sequence[tuple[str, bool]]] | None = None
