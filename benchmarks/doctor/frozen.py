"""Which sessions the frozen set has: seeds of what is drawn, folders of what lies beside the checkout."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

FAMILIES = ("rigs", "rig-nulls")


@dataclass(frozen=True)
class Case:
    """One session by its name, ``source/what/kind/seed`` or ``source/folder``, which ``opened`` makes or reads."""

    family: str
    key: str


@dataclass(frozen=True)
class Stream:
    """Drawn sessions of one kind, of consecutive seeds.

    Parameters
    ----------
    family : str
    drawn : str
        Of ``bank.FAMILIES``.
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


STREAMS = (
    # from 600,000 on no seed has been drawn before; each stream has ten thousand of its own
    Stream("rigs", "forced", "missing", 600_000),
    Stream("rigs", "rig_decay", "missing", 610_000, 0.5),
    Stream("rig-nulls", "forced", "none", 700_000),
    Stream("rig-nulls", "rig_decay", "none", 710_000, 0.5),
)


def cases(families: tuple[str, ...], count: int, start: int = 0) -> Iterator[Case]:
    """Sessions of some families, family by family.

    Parameters
    ----------
    families : tuple of str
        Of ``FAMILIES``.
    count : int
        N: sessions of a stream of share 1.
    start : int
        Sessions of each stream that are passed over: others than the frozen ones, for a look with fresh eyes.
    """
    for family in families:
        for stream in STREAMS:
            if stream.family == family:
                begin = stream.first + start
                for seed in range(begin, begin + math.ceil(stream.share * count)):
                    yield Case(family, f"bank/{stream.drawn}/{stream.kind}/{seed}")
