"""The decision: a pure function of the table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ssmr_ident.doctor.rules import (
    CERTAIN,
    FOLLOWS,
    FORMULA,
    HALVED,
    MORE_OVER,
    OVER_NOISE,
    SECOND,
    STATED,
    TIE,
    UNEVEN,
)
from ssmr_ident.doctor.table import FRICTION, UNLISTED, Row, grain

STATIC, MEMORY, GEOMETRY = "static_force", "memory", "geometry"
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
    rows = standing(rows)
    sure = [r for r in rows if certain(r, base)]
    if not sure:
        noise = base.over < OVER_NOISE or (base.left.follows < FOLLOWS and base.left.uneven < UNEVEN)
        return Decision(NOTHING) if noise else Decision(UNDETERMINED, kinds=kind_shares(rows, base))
    best = max(sure, key=lambda r: r.log_evidence)
    shares = kind_shares(rows, base)
    named = [r for r in sure if not r.generic]
    top = max(named, key=lambda r: r.log_evidence, default=None)
    if top is None:
        return Decision(MISSING, best, False, (), _confidence(best, [best], unexplained(best, base)), shares)
    least = min(r.chi2 for r in rows if math.isfinite(r.chi2))
    span = max(base.chi2 - least, 1e-12)
    left = max(top.chi2 - least, 0.0) / span
    beaten = top.log_evidence < best.log_evidence - TIE and left > FORMULA
    if beaten and not needed(top, left, everything):
        return Decision(
            MISSING,
            best,
            False,
            (),
            _confidence(best, [r for r in rows if r.ids], max(left, unexplained(best, base))),
            shares,
            left,
        )
    alike = [r for r in named if r.log_evidence > top.log_evidence - TIE]
    ties = tuple(dict.fromkeys(i for r in alike for i in (*r.ids, *r.equal) if i not in top.ids))
    confidence = _confidence(top, named, max(left, unexplained(top, base)))
    return Decision(MISSING, top, True, ties, confidence, shares, left)


def certain(row: Row, base: Row) -> bool:
    """Whether a row says that something is missing: by what was fitted, and not against what was kept back."""
    least = STATED if set(row.kinds) == {GEOMETRY} else CERTAIN
    return bool(row.ids) and row.log_evidence - base.log_evidence >= least and not row.heldout > base.heldout


def needed(law: Row, left: float, rows: Sequence[Row]) -> bool:
    """Whether a law that takes most of the misfit is there in another formula: its kind in any shape (of friction: in
    any smooth one, for one with a step where the motion turns has friction in it) is certainly worse without it than
    beside it, no other kind alone is better than both, and any shape of the law's own variable takes most of what any
    shape at all takes beside it."""
    own = [r for r in rows if r.generic and set(r.kinds) == {law.kinds[0]}]
    other = [r.log_evidence for r in rows if r.generic and len(r.ids) == 1 and r.kinds[0] != law.kinds[0]]
    if max(other, default=-math.inf) > max(r.log_evidence for r in (law, *own)) + SECOND:
        return False
    own = ([r for r in own if r.smooth] if law.ids == (FRICTION,) else []) or own
    beside = [r for r in own if len(r.ids) == 2 and r.ids[0] == law.ids[0]]
    without = [r.log_evidence for r in own if len(r.ids) == 1]
    if (
        left >= HALVED
        or max((r.log_evidence for r in beside), default=-math.inf) <= max(without, default=-math.inf) + SECOND
    ):
        return False
    if len(law.ids) > 1 or not (law.variables and law.variables[0]):
        return True
    variable = law.variables[0]
    formulas = [
        r.chi2 for r in rows if r.generic and len(r.ids) == 2 and r.ids[0] == law.ids[0] and _formula(r, variable)
    ]
    least = min((r.chi2 for r in beside), default=law.chi2)
    return law.chi2 - min(formulas, default=law.chi2) > HALVED * (law.chi2 - least)


def _formula(row: Row, variable: str) -> bool:
    """Whether a pair is a law with any shape of its own variable beside it; friction may be a memory as well."""
    return row.variables[1] == variable or (row.ids[0] == FRICTION and row.kinds[1] == MEMORY)


def standing(rows: Sequence[Row]) -> list[Row]:
    """Rows but for pairs that do not stand, and for pairs that one of these, with an effect in common, explains better:
    they have no more to show for their second effect."""
    found = [r for r in rows if stands(r, rows)]
    fallen = [r for r in rows if r not in found and not r.generic]

    def weaker(row: Row) -> bool:
        return len(row.ids) > 1 and any(
            set(row.ids) & set(other.ids) and other.log_evidence > row.log_evidence + TIE for other in fallen
        )

    return [r for r in found if not weaker(r)]


def stands(row: Row, rows: Sequence[Row]) -> bool:
    """Whether each of two effects beats the other one in any shape, and halves what that leaves beyond white noise, or
    leaves nothing that goes with the motion or that another model explains, and ``FORMULA`` less; and both any one law,
    by evidence in sizes of what they themselves leave. Neither makes what was kept back worse. Of two functions of one
    variable any shape of it holds both: it need not be worse than the two, and no more is asked of them there."""
    if len(row.ids) < 2:
        return True
    found = [held_against(row, k, rows) for k in (0, 1)]
    single = [r.log_evidence for r in rows if len(r.ids) == 1 and not r.generic]
    if not found[0] or row.log_evidence < max(single, default=-math.inf) + SECOND * _temper(row):
        return False
    for alone in (rows for rows in found if rows):
        apart = without_both(row, alone)
        if row.log_evidence < max(r.log_evidence for r in alone):
            return False
        if not apart:
            continue
        if row.log_evidence < max(r.log_evidence for r in apart) + max(SECOND, grain(rows)):
            return False
        if row.unseen > min((r.unseen for r in apart if math.isfinite(r.unseen)), default=math.inf):
            return False
        best = max(apart, key=lambda r: r.log_evidence)
        least = min(r.over for r in apart)
        halved = least > 1.0 and row.over**2 - 1.0 < HALVED * (least**2 - 1.0)
        explained = HALVED * row.over**2 < min(r.over for r in rows if math.isfinite(r.over)) ** 2
        only_noise = explained and row.left.follows < FOLLOWS and row.left.uneven < UNEVEN
        takes = halved or (only_noise and row.chi2 < (1.0 - FORMULA) * best.chi2)
        if not takes:
            return False
    return True


def held_against(pair: Row, which: int, rows: Sequence[Row]) -> list[Row]:
    """What a pair is held against, one effect of it without the other, in any shape: that of its kind; beside a second
    of the same kind, of its own variable. Dry friction has two kinds: a steep function of speed, and a memory of
    micrometres."""
    kind, law = pair.kinds[which], pair.ids[which]
    beside_friction = [k for i, k in zip(pair.ids, pair.kinds, strict=True) if i != FRICTION]
    alike = (pair.kinds[0] == pair.kinds[1] or beside_friction == [STATIC]) and not pair.generic
    own = pair.variables[which] if alike and pair.variables else ""

    def shape(r: Row, i: int) -> bool:
        variable = r.variables[i] if r.variables else ""
        if law == FRICTION and (r.kinds[i] == MEMORY or (r.kinds[i] == STATIC and variable == "v")):
            return True
        return r.kinds[i] == kind and (not alike or variable == own != "")

    def belongs(r: Row) -> bool:
        others = [i for i, name in enumerate(r.ids) if name != law]
        both = pair.ids[1 - which] in r.ids and pair.ids[1 - which] != UNLISTED
        return not both and (r.generic or not others) and all(shape(r, i) for i in others)

    return [r for r in rows if r is not pair and r.ids and belongs(r)]


def without_both(pair: Row, rows: Sequence[Row]) -> list[Row]:
    """Rows that cannot hold both of two listed effects: of functions of one variable, any shape of it does. Dry
    friction is one of the speed, whatever else it is."""
    laws = list(zip(pair.ids, pair.kinds, pair.variables or ("", ""), strict=True))
    first, second = ((STATIC, "v") if law == FRICTION else (kind, variable) for law, kind, variable in laws)
    if first != second or not first[1] or pair.generic or UNLISTED in pair.ids:
        return list(rows)
    return [r for r in rows if not (r.generic and first[1] in r.variables)]


def kind_shares(rows: Sequence[Row], base: Row) -> tuple[Share, ...]:
    """By kind, the share of the misfit that its best single member takes."""
    least = min(r.chi2 for r in rows if math.isfinite(r.chi2))
    span = max(base.chi2 - least, 1e-12)
    found: dict[str, Share] = {}
    for row in sorted((r for r in rows if len(r.ids) == 1), key=lambda r: -r.log_evidence):
        share = min(max((base.chi2 - row.chi2) / span, 0.0), 1.0)
        found.setdefault(row.kinds[0], Share(row.kinds[0], row, share, row.log_evidence))
    return tuple(found.values())


def _temper(row: Row) -> float:
    """Mean square of what a row leaves, in that of the noise which the evidence is counted in; 1 at the least."""
    return max(row.chi2 / max(row.samples, 1.0), 1.0)


def unexplained(row: Row, base: Row) -> float:
    """Share of the baseline's misfit that a row leaves beyond what may be noise: the world's own law would leave none,
    and nothing says that what leaves much of it is that law."""
    left = row.chi2 / max(row.samples, 1.0) - MORE_OVER**2
    return min(max(left / max(base.chi2 / max(base.samples, 1.0) - 1.0, 1e-12), 0.0), 1.0)


def _confidence(top: Row, others: Sequence[Row], left: float) -> float:
    """Posterior share of the chosen ids; evidence counts in sizes of what the explanation itself leaves, and the share
    ``left`` of the misfit counts against it."""
    temper = _temper(top)
    weights: dict[frozenset[str], float] = {}
    for row in others:
        weight = math.exp(min((row.log_evidence - top.log_evidence) / temper, 0.0))
        for ids in (row.ids, row.equal) if row.equal else (row.ids,):
            weights[frozenset(ids)] = max(weights.get(frozenset(ids), 0.0), weight)
    return (1.0 - min(left, 1.0)) * weights.get(frozenset(top.ids), 1.0) / max(sum(weights.values()), 1.0)
