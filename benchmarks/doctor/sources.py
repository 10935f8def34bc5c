"""Where the frozen set's sessions come from: drawn ones here, folders and recordings in files of their own."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator

import numpy as np
from bank import KINDS, SHARES, BankSession, draw
from bank.swivels import draw_swivels

from doctor.folders import SHARED, from_practice, from_practice_rigs, from_strangers, practice_cases, stranger_cases
from doctor.frozen import STREAMS, Case
from doctor.opened import Opened
from doctor.recordings import from_recordings, recording_cases

FULL = 0.25
"""Share of drawn nulls that are as long as other sessions; the rest are short, so that there can be many."""


def drawn_by(key: str) -> BankSession:
    """``bank/family/kind/seed``; the seed decides what is left out and how much of it."""
    _, family, kind, number = key.split("/")
    seed = int(number)
    random = np.random.default_rng([seed, 0])
    if kind == "none":
        return draw(family, "none", seed, short=bool(random.random() >= FULL))
    kinds = [kind for kind in KINDS[family] if kind != "none"]
    odds = np.array([SHARES[kind] for kind in kinds])
    return draw(family, str(random.choice(kinds, p=odds / odds.sum())), seed)


def from_bank(key: str) -> Opened:
    """What is kept back of the session is judged by the floor of its true signals."""
    drawn = drawn_by(key)
    truth = drawn.truth
    return Opened(drawn.campaign, drawn.seed, (truth.ids,), truth.effects, truth.parameters, truth.noise_floor)


def from_swivels(key: str) -> Opened:
    """``swivels/kind/seed``."""
    _, kind, number = key.split("/")
    campaign, truth = draw_swivels(int(number), missing=kind != "none")
    names = (truth["effect"],) if truth["effect"] else ()
    return Opened(campaign, int(number), (names,), truth["effects"])


SOURCES = {
    "bank": from_bank, "swivels": from_swivels, "practice": from_practice, "practice-robot": from_practice,
    "practice-rigs": from_practice_rigs, "strangers": from_strangers, "recordings": from_recordings,
}  # fmt: skip
BESIDE = ("practice", "practice-rigs", "practice-robot", "strangers", "recordings")
"""Sources that are folders beside the checkout."""


def opened(case: Case) -> Opened:
    """Draw or read it."""
    return SOURCES[case.key.split("/")[0]](case.key)


def absent() -> list[str]:
    """Sources that this machine does not have."""
    return [str(SHARED / name) for name in BESIDE if not (SHARED / name).is_dir()]


def cases(families: tuple[str, ...], count: int, start: int = 0) -> Iterator[Case]:
    """Sessions of some families, family by family.

    Parameters
    ----------
    families : tuple of str
        Of ``FAMILIES``.
    count : int
        N: drawn sessions of a stream of share 1, and tenths of what lies in folders, all of it from ten on. With a
        ``start`` nothing of folders is asked.
    start : int
        Sessions of each stream that are passed over: others than the frozen ones, for a look with fresh eyes.
    """
    folders = [] if start else [*practice_cases(), *stranger_cases(), *recording_cases()]
    beside = [case for case in folders if zlib.crc32(case.key.encode()) % 10 < count]
    for family in families:
        for stream in STREAMS:
            if stream.family == family:
                begin = stream.first + start
                for seed in range(begin, begin + math.ceil(stream.share * count)):
                    yield Case(family, f"{stream.drawn}/{stream.kind}/{seed}")
        yield from (case for case in beside if case.family == family)
