"""``ident effects --check``: all that an effect promises, asked of a file of one's own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.effects import effects_of
from ssmr_ident.workflows.effects import promises
from ssmr_ident.workflows.effects.promises import Outcome
from ssmr_ident.workflows.effects.recovery import clearest, recovered


@dataclass(frozen=True, eq=False)
class Checked(Shown):
    """An effect of a file, and what its checks found, in order."""

    file: str
    effect: Effect
    outcomes: tuple[Outcome, ...]

    @property
    def failed(self) -> int:
        """How many promises it does not keep."""
        return sum(not outcome.passed for outcome in self.outcomes)

    def __str__(self) -> str:
        return "\n".join([f"{self.effect.id}, of {self.file}", *(f"  {outcome}" for outcome in self.outcomes)])

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "file": self.file,
            "id": self.effect.id,
            "passed": not self.failed,
            "checks": [vars(outcome) for outcome in self.outcomes],
        }


def check_file(file: str | Path) -> Checked:
    """Ask an effect of a file what the contract tests ask of the catalogue.

    Raises
    ------
    InputError
        The file holds no effect, or its law cannot be run.
    """
    with effects_of(file) as (effect,):
        return Checked(str(file), effect, tuple(_outcomes(effect)))


def _outcomes(effect: Effect) -> Iterator[Outcome]:
    """What cannot be run is not asked."""
    for first in (promises.declared(effect), promises.named_in_the_law(effect)):
        yield first
        if not first.passed:
            return
    robot = promises.robot_for_checks()
    yield promises.nested(effect, robot)
    found = promises.traces(effect, robot)
    yield promises.shows(effect, found)
    yield promises.moves(effect, robot)
    yield promises.inputs_left(effect, robot)
    if effect.moves and any(kind.free and kind.shows(effect) for kind in EXPERIMENTS.values()):
        yield promises.passive(effect, robot)
    if case := clearest(effect, found):
        yield recovered(effect, case, robot)
