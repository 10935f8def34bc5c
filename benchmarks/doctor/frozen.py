"""Which sessions the frozen set draws: families, kinds and seeds, written down once."""

from __future__ import annotations

from dataclasses import dataclass

FAMILIES = ("rigs", "rig-nulls", "decays", "decay-nulls", "pulls", "pull-nulls", "swivels", "swivel-nulls", "open")
"""Pulls are pulls and drags; nulls have nothing missing; open are recordings of others."""


@dataclass(frozen=True)
class Case:
    """One session: its key begins with its source, of ``sources.SOURCES``, and goes on as that needs it."""

    family: str
    key: str


@dataclass(frozen=True)
class Stream:
    """Drawn sessions of one kind, of consecutive seeds.

    Parameters
    ----------
    family : str
    drawn : str
        ``bank`` and a family of ``bank.FAMILIES``, or ``swivels``.
    kind : str
        ``missing`` (the seed says what) or ``none``.
    first : int
        Seed of the first session.
    share : float
        Sessions over the N that is asked for.
    """

    family: str
    drawn: str
    kind: str
    first: int
    share: float = 1.0


# no seed from 600,000 to 799,999 had been drawn before; each stream has ten thousand of its own
STREAMS = (
    Stream("rigs", "bank/forced", "missing", 600_000),
    Stream("rigs", "bank/rig_decay", "missing", 610_000, 0.5),
    Stream("rig-nulls", "bank/forced", "none", 700_000),
    Stream("rig-nulls", "bank/rig_decay", "none", 710_000, 0.5),
    Stream("decays", "bank/decays", "missing", 620_000),
    Stream("decays", "bank/decoupled", "missing", 630_000, 0.1),
    Stream("decay-nulls", "bank/decays", "none", 720_000),
    Stream("pulls", "bank/pulls", "missing", 640_000, 0.3),
    Stream("pulls", "bank/bench", "missing", 650_000, 0.2),
    Stream("pulls", "bank/block", "missing", 660_000, 0.2),
    Stream("pull-nulls", "bank/pulls", "none", 740_000, 0.3),
    Stream("pull-nulls", "bank/bench", "none", 750_000, 0.2),
    Stream("pull-nulls", "bank/block", "none", 760_000, 0.2),
    Stream("swivels", "swivels", "missing", 680_000, 0.2),
    Stream("swivel-nulls", "swivels", "none", 780_000, 0.2),
)
