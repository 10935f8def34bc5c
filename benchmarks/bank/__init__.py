"""Random sessions with known answers, each from a seed: what the diagnosis is judged on.

``draw(family, kind, seed)`` makes a campaign in memory and the truth beside it. Nothing of the truth is in the
campaign: names of files, sessions and recordings are the same whatever was left out.
"""

from __future__ import annotations

import numpy as np

from bank.decays import draw_decays, draw_decoupled
from bank.pulls import draw_bench, draw_block, draw_pulls
from bank.rigs import draw_forced, draw_let_go
from bank.truth import BankSession, Truth

__all__ = ["FAMILIES", "KINDS", "SHARES", "BankSession", "Truth", "draw", "mixed"]

FAMILIES = {
    "decays": draw_decays, "decoupled": draw_decoupled, "pulls": draw_pulls, "bench": draw_bench,
    "block": draw_block, "forced": draw_forced, "rig_decay": draw_let_go,
}  # fmt: skip
KINDS = {
    "decays": ("none", "one", "two", "other", "unlisted"),
    "decoupled": ("one",),
    "pulls": ("none", "one", "two"),
    "bench": ("none", "one", "two"),
    "block": ("none", "one"),
    "forced": ("none", "one", "two", "other", "unlisted"),
    "rig_decay": ("none", "one", "two", "other", "unlisted"),
}
SHARES = {"none": 0.2, "one": 0.4, "two": 0.1, "other": 0.2, "unlisted": 0.1}
FAMILY_SHARES = {
    "decays": 0.3, "decoupled": 0.03, "pulls": 0.2, "bench": 0.08, "block": 0.04, "forced": 0.25, "rig_decay": 0.1,
}  # fmt: skip


def draw(
    family: str, kind: str, seed: int, effect: str | None = None, size: float | None = None, short: bool = False
) -> BankSession:
    """One session.

    Parameters
    ----------
    family : str
        Of ``FAMILIES``.
    kind : str
        ``none``, ``one`` (a catalogue effect), ``two`` of them, ``other`` (a catalogue effect in another formula,
        made by the bank's own plants), ``unlisted``.
    seed : int
    effect : str, optional
        For ``one``: which.
    size : float, optional
        0 (the limit) … 1 (plain); drawn evenly otherwise.
    short : bool
        Fewer and shorter recordings, for a great many sessions.
    """
    return FAMILIES[family](kind, seed, effect, size, short)


def mixed(seed: int, families: tuple[str, ...] = tuple(FAMILIES)) -> BankSession:
    """A session whose family and kind the seed decides."""
    random = np.random.default_rng([seed, 0])
    weights = np.array([FAMILY_SHARES[name] for name in families])
    family = str(random.choice(families, p=weights / weights.sum()))
    odds = np.array([SHARES[kind] for kind in KINDS[family]])
    return draw(family, str(random.choice(KINDS[family], p=odds / odds.sum())), seed)
