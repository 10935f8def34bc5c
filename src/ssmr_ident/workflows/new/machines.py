"""Logs of one event by two machines: a force without a motion, a motion without a force, and a clock for both."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording
from ssmr_ident.experiments.together import Log as Timed
from ssmr_ident.experiments.together import clock_of, clock_sentence, merged
from ssmr_ident.workflows.new.log import quantities_of
from ssmr_ident.workflows.new.rig_log import guess_rig, in_quantities
from ssmr_ident.workflows.new.system import Log, moving, pulling

ALIKE = 0.5
"""Choice: the shorter log of an event over the longer one, at the least."""


@dataclass(frozen=True, eq=False)
class Pair:
    """Logs of one event.

    Parameters
    ----------
    driving, answering : Log
    together : Log
        Both on one clock, under both names.
    sentence : str
        By how much the clocks differ.
    """

    driving: Log
    answering: Log
    together: Log
    sentence: str

    @property
    def files(self) -> dict[str, str]:
        """As session.yaml has it: quantity: file."""
        own = {}
        for log in (self.driving, self.answering):
            named = in_rig_quantities(log).names
            first = next(name for name in QUANTITY_ORDER if name in named)
            own[first] = log.file
        return own

    @property
    def channels(self) -> dict[str, str]:
        """Headers of what the logs' own do not name."""
        found: dict[str, str] = dict(quantities_of(self.driving.recording).mapping)
        return found | dict(guess_rig(self.answering).fields.get("channels", {}))


QUANTITY_ORDER = ("force", "torque", "acceleration", "velocity", "position", "angle", "angular_rate")


def in_rig_quantities(log: Log) -> Recording:
    """A log's recording under the names that a rig's entry would give it."""
    if moving(log.recording):
        return guess_rig(log).recording
    return in_quantities(log.recording, quantities_of(log.recording).mapping)


def pairs_among(logs: Sequence[Log]) -> tuple[list[Pair], list[tuple[str, str]], list[Log]]:
    """Logs that belong together, those that should and do not (file, why), and the others.

    Names tell which may: the same number at the end, or the only two that there are. Samples tell whether they do.
    """
    forces = [log for log in logs if pulling(log.recording) and not moving(log.recording)]
    motions = [log for log in logs if moving(log.recording) and not pulling(log.recording)]
    others = [log for log in logs if log not in forces and log not in motions]
    if not forces or not motions:
        return [], [], list(logs)
    pairs: list[Pair] = []
    aside: list[tuple[str, str]] = []
    for force in forces:
        partner = _partner(force, motions, len(forces))
        if partner is None:
            aside.append((force.file, "a force without a motion, and no log of a motion has its number or length"))
            continue
        motions.remove(partner)
        try:
            pairs.append(_pair(force, partner))
        except InputError as error:
            aside += [(force.file, f"{error.problem}. {error.mend}"), (partner.file, f"see {force.file}")]
    return pairs, aside, [*others, *motions]


def _partner(force: Log, motions: Sequence[Log], count: int) -> Log | None:
    fits = [m for m in motions if ALIKE < m.recording.duration / max(force.recording.duration, 1e-9) < 1.0 / ALIKE]
    same = [m for m in fits if _number(m.stem) == _number(force.stem)]
    if len(same) == 1:
        return same[0]
    return fits[0] if len(fits) == 1 and count == 1 else None


def _number(stem: str) -> str:
    """The last number of a name."""
    numbers = re.findall(r"\d+", stem)
    return str(int(numbers[-1])) if numbers else ""


def _pair(force: Log, motion: Log) -> Pair:
    first, second = (replace(log, recording=in_rig_quantities(log)).recording for log in (force, motion))
    found, one, other = clock_of(first, second)
    both = merged([Timed(first), Timed(second)])
    name = f"{force.file} + {motion.file}"
    return Pair(force, motion, Log(name, None, both), clock_sentence(first, second, found, one, other))
