"""One line per family: what was answered, what is left on recordings kept back, and what it took."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from scoring import GOOD, Row, share

from doctor.frozen import FAMILIES
from doctor.judged import OUTCOMES

SURE = 0.9
"""Confidence from which an answer is sure."""

SHOWN = (*OUTCOMES[:5], "unseen", *OUTCOMES[5:])
HEAD = "| family | n | " + " | ".join(SHOWN) + " | after/floor | 90 % | s | worst | in 3 std | sure, and right |"
NOTE = """unseen: missed or named in part, and the session does not show what was not named, so that nobody could;
after/floor: held-out error with the effects over what the true signals leave, median and 90 % of sessions;
s: seconds of processor, median and worst; in 3 std: parameters of effects named rightly whose truth is known; sure:
every name at a confidence of 0.9 or more, and how many of these are right or a tie."""


def table(rows: Sequence[Row]) -> str:
    """As Markdown."""
    lines = [HEAD, "| --- |" + " ---: |" * (HEAD.count("|") - 2)]
    for family in FAMILIES:
        if own := [row for row in rows if row["family"] == family]:
            lines.append(line(family, own))
    return "\n".join(lines) + f"\n\n{NOTE}"


def line(family: str, rows: Sequence[Row]) -> str:
    """Of one family."""
    counts = Counter(row["outcome"] for row in rows)
    cells = [family, str(len(rows)), *(str(counts[name] or "·") for name in SHOWN)]
    over = over_floor(rows)
    cells += [f"{np.median(over):.2f}", f"{np.percentile(over, 90):.2f}"] if over else ["–", "–"]
    seconds = [row["seconds"] for row in rows]
    cells += [f"{np.median(seconds):.1f}", f"{max(seconds):.0f}"]
    errors = [error for row in rows for path, error in effect_errors(row).items()]
    cells.append(f"{sum(abs(error) < 3.0 for error in errors)} of {len(errors)}" if errors else "–")
    sure = [row for row in rows if row.get("named") and min(row["confidence"]) >= SURE]
    cells.append(f"{sum(row['outcome'] in GOOD for row in sure)} of {len(sure)}" if sure else "–")
    return "| " + " | ".join(cells) + " |"


def over_floor(rows: Sequence[Row]) -> list[float]:
    """After over the floor of every session that has both."""
    ratios = [row["after"] / row["floor"] for row in rows if row.get("floor")]
    return [ratio for ratio in ratios if math.isfinite(ratio)]


def effect_errors(row: Row) -> dict[str, float]:
    """Errors of the named effects' parameters in their standard deviations, where the names are right."""
    found: dict[str, float] = row.get("errors", {}) if row["outcome"] in GOOD else {}
    return {path: error for path, error in found.items() if path.split(".")[0] in row["named"]}


def answers(rows: Sequence[Row]) -> str:
    """Right or a tie, with its interval: where something is missing that can be seen, and where nothing is."""
    seen = [row for row in rows if row["outcome"] != "unseen"]
    missing, nulls = ([row for row in seen if ("null" in row["family"]) == null] for null in (False, True))
    parts = [("something missing that can be seen, right or tie", missing), ("nothing missing and none named", nulls)]
    return "\n".join(f"{name}: {share(sum(r['outcome'] in GOOD for r in own), len(own))}" for name, own in parts)


def said(row: Row) -> str:
    """The answer in a few words."""
    if row["outcome"] == "failed":
        return f"failed: {row['error'].strip().splitlines()[-1]}"
    tie = sorted({name for ties in row["ties"] for name in ties})
    names = "+".join(row["named"]) or row["verdict"]
    return names + (f" (or {', '.join(tie)})" if tie else "") + ("?" if row["verdict"] == "undetermined" else "")
