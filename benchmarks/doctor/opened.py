"""A session of the frozen set with its campaign and what is right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from bank import KINDS, SHARES, draw

from doctor.frozen import Case
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.experiments.campaign import Campaign

FULL = 0.25
"""Share of drawn nulls that are as long as other sessions; the rest are short, so that there can be many."""


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
    """

    campaign: Campaign
    seed: int
    right: tuple[tuple[str, ...], ...]
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    floors: Mapping[str, float] = field(default_factory=dict)
    heldout: Callable[[Opened, Diagnosis], tuple[float, float, float]] | None = None


def opened(case: Case) -> Opened:
    """Draw or read it."""
    source, rest = case.key.split("/", 1)
    return SOURCES[source](rest)


def from_bank(rest: str) -> Opened:
    """``family/kind/seed``; the seed decides what is left out and how much of it."""
    family, kind, number = rest.split("/")
    seed = int(number)
    random = np.random.default_rng([seed, 0])
    if kind == "none":
        drawn = draw(family, "none", seed, short=bool(random.random() >= FULL))
    else:
        kinds = [kind for kind in KINDS[family] if kind != "none"]
        odds = np.array([SHARES[kind] for kind in kinds])
        drawn = draw(family, str(random.choice(kinds, p=odds / odds.sum())), seed)
    truth = drawn.truth
    return Opened(drawn.campaign, seed, (truth.ids,), truth.effects, truth.parameters, truth.noise_floor)


SOURCES = {"bank": from_bank}
