"""Two engines on the same sessions: where they differ, and whether by more than chance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import binomtest
from scoring import GOOD, Row

from doctor.frozen import FAMILIES
from doctor.tables import said

ALIKE = 1.01
"""Ratio of two held-out errors or times up to which neither is the larger."""


def differences(first: Sequence[Row], second: Sequence[Row]) -> str:
    """Per family the tests, then every session that the engines answer unlike."""
    old = {row["key"]: row for row in first}
    pairs = [(old[row["key"]], row) for row in second if row["key"] in old]
    lines = []
    for family in FAMILIES:
        if own := [(a, b) for a, b in pairs if b["family"] == family]:
            lines += [f"{family}, {len(own)} sessions of both", *(f"  {line}" for line in _tests(own))]
    unlike = [(a, b) for a, b in pairs if a["outcome"] != b["outcome"]]
    lines.append(f"answered unlike: {len(unlike)}")
    for a, b in unlike:
        lines.append(f"  {b['key']:<34} {_truth(b):<36} {a['outcome']}: {said(a)}  ->  {b['outcome']}: {said(b)}")
    return "\n".join(lines)


def _truth(row: Row) -> str:
    return " or ".join("+".join(names) or "nothing" for names in row.get("right", []))


def _tests(pairs: Sequence[tuple[Row, Row]]) -> list[str]:
    """McNemar's exact test of right or not, sign tests of held-out error and of processor time."""
    gained = sum(b["outcome"] in GOOD and a["outcome"] not in GOOD for a, b in pairs)
    lost = sum(a["outcome"] in GOOD and b["outcome"] not in GOOD for a, b in pairs)
    lines = [f"right only by the first {lost}, only by the second {gained}: {_chance(lost, gained)}"]
    for name, figure in (("held-out error", "after"), ("seconds", "seconds")):
        ratios = np.array([b[figure] / a[figure] for a, b in pairs if _has(a, figure) and _has(b, figure)])
        if len(ratios):
            more, less = int(np.sum(ratios > ALIKE)), int(np.sum(ratios < 1.0 / ALIKE))
            lines.append(
                f"{name}, second over first: median {np.median(ratios):.3g}; larger in {more}, smaller in {less}: "
                f"{_chance(more, less)}"
            )
    return lines


def _has(row: Mapping[str, float], figure: str) -> bool:
    return row.get(figure, float("nan")) > 0.0


def _chance(one: int, other: int) -> str:
    """Whether two counts that chance would make alike differ by more than that, at 5 %."""
    if one + other == 0:
        return "no difference"
    p = float(binomtest(one, one + other).pvalue)
    return f"p = {p:.2g}, {'more than' if p < 0.05 else 'no more than'} chance"
