"""The proof in numbers: what must hold, with intervals, and whether it does."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_proof.scores.intervals import NAN, between, median_interval, share_interval
from ssmr_proof.scores.score import CLEAN, FALSE_ALARM, MEANING, NAMED
from ssmr_proof.scores.table import Row


@dataclass(frozen=True)
class Share(Shown):
    """Hits out of a total, with the 95 % interval of Clopper and Pearson."""

    hits: int
    total: int

    @property
    def value(self) -> float:
        return self.hits / self.total if self.total else NAN

    def __str__(self) -> str:
        if not self.total:
            return "no such case"
        low, high = share_interval(self.hits, self.total)
        return f"{self.hits} of {self.total} = {self.value:.0%} ({low:.0%} … {high:.0%})"


@dataclass(frozen=True)
class Summary(Shown):
    """What a proof came to.

    Parameters
    ----------
    outcomes : Counter
        Cases by outcome.
    right : Share
        Named right or in a tie, or rightly found clean, of all cases but the faint ones.
    named : Share
        Named right or in a tie, of the cases with hidden physics above the limit.
    false_alarms : Share
        Of the cases without.
    reduced : Share
        Held-out error lower after than before, of the same cases.
    after_over_floor : (float, float, float)
        Median over the same cases, and its 95 % interval.
    faint, faint_reduced : Share
        Named, and reduced, of the cases with hidden physics below the limit.
    """

    outcomes: Counter[str]
    right: Share
    named: Share
    false_alarms: Share
    reduced: Share
    after_over_floor: tuple[float, float, float]
    faint: Share
    faint_reduced: Share

    def __str__(self) -> str:
        middle, low, high = self.after_over_floor
        lines = [f"  {self.outcomes[outcome]:>4}  {outcome:<12} {MEANING[outcome]}" for outcome in MEANING]
        lines = [line for line in lines if not line.startswith("     0")]
        lines += [
            f"  answered right or in a tie: {self.right}",
            f"  hidden effects named:       {self.named}",
            f"  false alarms:               {self.false_alarms}",
            f"  held-out error reduced:     {self.reduced}",
            f"  after over noise floor:     median {middle:.2f}{between(low, high)}",
        ]
        if self.faint.total:
            lines.append(f"  below the limit, named:     {self.faint}; error reduced in {self.faint_reduced.hits}")
        return "\n".join(lines)


def summarised(rows: Sequence[Row]) -> Summary:
    """Count."""
    missing = [row for row in rows if row.missing and not row.faint]
    faint = [row for row in rows if row.faint]
    clean = [row for row in rows if not row.missing]
    named = _named_right(missing)
    ratios = [row.heldout.means[1] / row.heldout.means[2] for row in missing if row.heldout.after]
    return Summary(
        Counter(row.mark.outcome for row in rows),
        Share(named + sum(row.mark.outcome == CLEAN for row in clean), len(missing) + len(clean)),
        Share(named, len(missing)),
        Share(sum(row.mark.outcome == FALSE_ALARM for row in clean), len(clean)),
        Share(_reduced(missing), len(missing)),
        (float(np.median(ratios)) if ratios else NAN, *median_interval(ratios)),
        Share(_named_right(faint), len(faint)),
        Share(_reduced(faint), len(faint)),
    )


def _named_right(rows: Sequence[Row]) -> int:
    return sum(row.mark.outcome in NAMED for row in rows)


def _reduced(rows: Sequence[Row]) -> int:
    return sum(bool(row.heldout.after) and row.heldout.means[1] < row.heldout.means[0] for row in rows)


def confusion(rows: Sequence[Row]) -> tuple[tuple[str, ...], tuple[str, ...], np.ndarray]:
    """Hidden physics against what was named first.

    Returns
    -------
    tuple of str, tuple of str, (h, n) int
        Hidden (two at once joined by +; "nothing"), named, and how many cases. A tie counts under the hidden id when
        that is in it.
    """
    pairs = [(_hidden(row), _named(row)) for row in rows]
    hidden = tuple(sorted({pair[0] for pair in pairs}, key=_order))
    named = tuple(sorted({pair[1] for pair in pairs}, key=_order))
    counts = np.zeros((len(hidden), len(named)), dtype=int)
    for left, right in pairs:
        counts[hidden.index(left), named.index(right)] += 1
    return hidden, named, counts


NOTHING = "nothing"


def _order(name: str) -> tuple[int, str]:
    return (name == "unlisted") + 2 * ("+" in name) + 3 * (name == NOTHING) + 4 * (name == "failed"), name


def _hidden(row: Row) -> str:
    return "+".join(sorted(row.mark.hidden)) or NOTHING


def _named(row: Row) -> str:
    if row.answer.verdict == "failed":
        return "failed"
    if not row.answer.says_missing:
        return NOTHING
    if row.mark.outcome in NAMED:
        return _hidden(row)
    return "+".join(sorted(claim.id for claim in row.answer.claims)) or "undetermined"
