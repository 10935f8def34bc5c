"""One row per case, as proof.csv and the page show it."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ssmr_ident.core.atomic import write_text
from ssmr_proof.scores.answer import Answer
from ssmr_proof.scores.heldout import HeldOut
from ssmr_proof.scores.score import Mark

COLUMNS = (
    "case", "family", "kind", "trap", "hidden", "strength", "outcome", "verdict", "named", "before_percent",
    "after_percent", "noise_floor_percent", "improvement_low", "improvement_high", "excess", "largest_shift",
    "largest_shift_sigmas", "parameter_errors", "seconds", "problem",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Row:
    """A case with everything that is known of it after unsealing."""

    truth: Mapping[str, Any]
    answer: Answer
    mark: Mark
    heldout: HeldOut
    seconds: float
    failure: str = ""

    @property
    def case(self) -> str:
        return str(self.truth["case"])

    @property
    def missing(self) -> bool:
        """Whether physics was missing."""
        return bool(self.truth["effects"])

    @property
    def faint(self) -> bool:
        """Whether what is hidden lies below the limit, and counts for the power curve alone."""
        return bool(self.truth["kind"] == "faint")

    @property
    def strength(self) -> float:
        """Of the weakest effect hidden; 0 for none."""
        return min((float(effect["strength"]) for effect in self.truth["effects"]), default=0.0)

    def as_dict(self) -> dict[str, str]:
        """Texts by column; empty where there is nothing."""
        before, after, floor = self.heldout.means
        low, high = self.interval()
        shift = self.heldout.shifts[0] if self.heldout.shifts else None
        errors = "; ".join(
            f"{name} {error:+.0%}" + ("" if away is None else f" ({away:+.1f} std)")
            for name, (error, away) in self.mark.parameter_errors.items()
        )
        values: tuple[object, ...] = (
            self.case, self.truth["family"], self.truth["kind"], self.truth["trap"], "+".join(self.mark.hidden),
            self.strength if self.missing else "", self.mark.outcome, self.answer.verdict, "+".join(self.mark.named),
            before, after, floor, low, high, self.heldout.excess, shift.parameter if shift else "",
            shift.sigmas if shift else "", errors, self.seconds, self.failure or self.heldout.problem,
        )  # fmt: skip
        return {name: _text(value) for name, value in zip(COLUMNS, values, strict=True)}

    def interval(self) -> tuple[float, float]:
        """95 % interval of before − after over the held-out recordings [%], by Student's t."""
        from ssmr_proof.scores.intervals import mean_interval

        pairs = zip(self.heldout.before, self.heldout.after, strict=True)
        return mean_interval([before - after for before, after in pairs])


def write_table(path: Path, rows: Sequence[Row]) -> None:
    """Write proof.csv."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(row.as_dict() for row in rows)
    write_text(path, text.getvalue())


def _text(value: object) -> str:
    if isinstance(value, float):
        return "" if value != value else f"{value:.4g}"
    return str(value)
