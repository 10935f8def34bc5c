"""The decision: a pure function of the table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ssmr_ident.doctor.rules import CERTAIN, FOLLOWS, FORMULA, HALVED, OVER_NOISE, SECOND, TIE
from ssmr_ident.doctor.table import Row

MISSING, NOTHING, UNDETERMINED = "missing_physics", "nothing_missing", "undetermined"


@dataclass(frozen=True)
class Share:
    """What a kind takes of the misfit by ``row``, its best member alone."""

    kind: str
    row: Row
    share: float
    log_evidence: float


@dataclass(frozen=True, eq=False)
class Decision:
    """What the table says.

    Parameters
    ----------
    verdict : str
    chosen : Row or None
        The explanation; None where nothing is missing or nothing names it.
    listed : bool
        False where no law of the catalogue is within a tie of the best that takes any shape.
    ties : tuple of str
        Other ids that fit alike.
    confidence : float
    kinds : tuple of Share
        Largest first.
    left : float
        Share of the baseline's misfit that the chosen one leaves beside the best of all.
    """

    verdict: str
    chosen: Row | None = None
    listed: bool = True
    ties: tuple[str, ...] = ()
    confidence: float = 0.0
    kinds: tuple[Share, ...] = ()
    left: float = 0.0


def decide(rows: Sequence[Row]) -> Decision:
    """Verdict and name.

    Parameters
    ----------
    rows : sequence of Row
        The baseline among them.
    """
    base = next(r for r in rows if not r.ids)
    everything = rows
    rows = [r for r in rows if stands(r, rows)]
    best = max(rows, key=lambda r: r.log_evidence)
    if best.log_evidence - base.log_evidence < CERTAIN:
        noise = base.over < OVER_NOISE or base.follows < FOLLOWS
        return Decision(NOTHING) if noise else Decision(UNDETERMINED, kinds=kind_shares(rows, base))
    shares = kind_shares(rows, base)
    named = [r for r in rows if r.ids and not r.generic and r.log_evidence > base.log_evidence + CERTAIN]
    top = max(named, key=lambda r: r.log_evidence, default=None)
    if top is None:
        return Decision(MISSING, best, False, (), _confidence(best, [best], 0.0), shares)
    least = min(r.chi2 for r in rows if math.isfinite(r.chi2))
    span = max(base.chi2 - least, 1e-12)
    left = max(top.chi2 - least, 0.0) / span
    beaten = top.log_evidence < best.log_evidence - TIE and left > FORMULA
    if beaten and not needed(top, left, everything):
        return Decision(MISSING, best, False, (), _confidence(best, [r for r in rows if r.ids], left), shares, left)
    alike = [r for r in named if r.log_evidence > top.log_evidence - TIE]
    ties = tuple(dict.fromkeys(i for r in alike for i in r.ids if i not in top.ids))
    return Decision(MISSING, top, True, ties, _confidence(top, named, left), shares, left)


def needed(law: Row, left: float, rows: Sequence[Row]) -> bool:
    """Whether a law that takes most of the misfit is there in another formula: its kind in any shape, as smooth as that
    is, is certainly worse without it than beside it."""
    own = [r for r in rows if r.generic and set(r.kinds) == {law.kinds[0]}]
    beside = [r.log_evidence for r in own if len(r.ids) == 2 and r.ids[0] == law.ids[0]]
    without = [r.log_evidence for r in own if len(r.ids) == 1]
    return left < HALVED and bool(beside) and max(beside) > max(without, default=math.inf) + SECOND


def stands(row: Row, rows: Sequence[Row]) -> bool:
    """Whether a second effect beats the first one in any shape, and halves what that leaves beyond noise.

    Any shape is that of the first one's kind; beside a second of the same kind, of the first one's own variable.
    """
    if len(row.ids) < 2:
        return True
    kind, law = row.kinds[0], row.ids[0]
    alike = row.kinds[1] == kind and not row.generic
    own = row.variables[0] if alike and row.variables else ""

    def first_alone(r: Row) -> bool:
        shapes = [v for i, v in zip(r.ids, r.variables, strict=False) if i != law]
        return (r.generic or r.ids[0] == law) and (not alike or all(v == own != "" for v in shapes))

    first = [r for r in rows if r is not row and r.ids and set(r.kinds) == {kind} and first_alone(r)]
    if not first:
        return False
    best = max(first, key=lambda r: r.log_evidence)
    halved = row.over**2 - 1.0 < HALVED * (min(r.over for r in first) ** 2 - 1.0)
    return halved and row.log_evidence > best.log_evidence + SECOND


def kind_shares(rows: Sequence[Row], base: Row) -> tuple[Share, ...]:
    """By kind, the share of the misfit that its best single member takes."""
    least = min(r.chi2 for r in rows if math.isfinite(r.chi2))
    span = max(base.chi2 - least, 1e-12)
    found: dict[str, Share] = {}
    for row in sorted((r for r in rows if len(r.ids) == 1), key=lambda r: -r.log_evidence):
        share = min(max((base.chi2 - row.chi2) / span, 0.0), 1.0)
        found.setdefault(row.kinds[0], Share(row.kinds[0], row, share, row.log_evidence))
    return tuple(found.values())


def _confidence(top: Row, others: Sequence[Row], left: float) -> float:
    """Posterior share of the chosen ids; evidence counts in sizes of what the explanation itself leaves, and what it
    leaves beside the best of any shape counts against it."""
    temper = max(top.chi2 / max(top.samples, 1.0), 1.0)
    weights: dict[tuple[str, ...], float] = {}
    for row in others:
        weight = math.exp(min((row.log_evidence - top.log_evidence) / temper, 0.0))
        weights[row.ids] = max(weights.get(row.ids, 0.0), weight)
    return (1.0 - min(left, 1.0)) * weights.get(top.ids, 1.0) / max(sum(weights.values()), 1.0)
