"""Which answers nobody could have given: what was not named does not show in the session."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from scoring import Row, read

UNNAMED = ("missed", "part")
SHOWS = math.log(1e3)
"""Log evidence from which a session shows an effect: odds of a thousand."""
NO_GAIN = 1.02
"""Held-out error of the baseline over the noise floor up to which nothing could be gained by naming anything."""
KEPT = Path(__file__).parents[1] / "results" / "doctor" / "true_evidence.jsonl"


def known_evidence() -> dict[str, dict[str, float]]:
    """What ``visible`` has worked out, by the session's key."""
    return {row["key"]: row["evidence"] for row in read(KEPT)}


def with_unseen(rows: Sequence[Row]) -> list[Row]:
    """The rows, with the outcome ``unseen`` where nobody could have named what was not named."""
    evidence = known_evidence()
    return [{**row, "outcome": "unseen"} if is_unseen(row, evidence.get(row["key"], {})) else row for row in rows]


def is_unseen(row: Row, evidence: Mapping[str, float]) -> bool:
    """Missed, or named in part, where the session does not show what was not named.

    The baseline explains even recordings that were never fitted down to their noise, or the truth itself, refitted from
    the true values, has no more evidence with that effect than noise alone gives some.
    """
    if row["outcome"] not in UNNAMED:
        return False
    hidden = [evidence.get(name, math.inf) < SHOWS for name in row["right"][0] if name not in row["named"]]
    no_gain = row["outcome"] == "missed" and row["before"] <= NO_GAIN * row["floor"]
    return bool(no_gain or (hidden and all(hidden)))
