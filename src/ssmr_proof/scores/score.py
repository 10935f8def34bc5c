"""Truth against answer: named right, in a tie, in part, wrongly, not at all; a false alarm, or clean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Any

from ssmr_proof.scores.answer import Answer, Claim

LARGEST_TIE = 3
"""Ids that a claim may hold together and still count as named."""

RIGHT, TIE, SURPLUS, PARTLY, WRONG, MISSED, FALSE_ALARM, CLEAN, FAILED = (
    "right", "tie", "surplus", "partly", "wrong", "missed", "false alarm", "clean", "failed"
)  # fmt: skip
NAMED = (RIGHT, TIE)
MEANING = {
    RIGHT: "every hidden effect named, none besides",
    TIE: f"the same, within ties of at most {LARGEST_TIE}",
    SURPLUS: "every hidden effect named, and another one besides",
    PARTLY: "one of two hidden effects named",
    WRONG: "physics is said to be missing, but other physics",
    MISSED: "physics was missing, and none was said to be",
    FALSE_ALARM: "nothing was missing, but physics was said to be",
    CLEAN: "nothing was missing, and so it was said",
    FAILED: "no answer",
}


@dataclass(frozen=True)
class Mark:
    """How an answer fares against a truth.

    Parameters
    ----------
    outcome : str
        A key of MEANING.
    hidden, named : tuple of str
        Ids; the named ones with their ties behind a slash.
    parameter_errors : mapping of str to (relative error, standard deviations or None)
        Of those parameters of rightly named effects that the truth has under the same name.
    """

    outcome: str
    hidden: tuple[str, ...]
    named: tuple[str, ...]
    parameter_errors: Mapping[str, tuple[float, float | None]]


def marked(truth: Mapping[str, Any], answer: Answer) -> Mark:
    """Mark an answer.

    Parameters
    ----------
    truth : mapping
        A truth.json.
    answer : Answer
    """
    effects = truth["effects"]
    hidden = tuple(effect["id"] for effect in effects)
    named = tuple("/".join(claim.ids) for claim in answer.claims)
    matched = _matched(effects, answer.claims)
    return Mark(_outcome(effects, answer, matched), hidden, named, _errors(effects, matched))


def _outcome(effects: Sequence[Mapping[str, Any]], answer: Answer, matched: Sequence[Claim | None]) -> str:
    if answer.verdict == "failed":
        return FAILED
    if not effects:
        return FALSE_ALARM if answer.says_missing else CLEAN
    if not answer.says_missing:
        return MISSED
    found = [claim for claim in matched if claim is not None]
    if len(found) < len(effects):
        return PARTLY if found else WRONG
    if len(answer.claims) > len(effects):
        return SURPLUS
    return RIGHT if all(claim.id in _accepted(e) for claim, e in zip(found, effects, strict=True)) else TIE


def _matched(effects: Sequence[Mapping[str, Any]], claims: Sequence[Claim]) -> list[Claim | None]:
    """For every hidden effect the claim that names it: as many as can be, each claim for one effect only."""
    best: list[Claim | None] = [None] * len(effects)
    blanks: list[Claim | None] = [*claims, *[None] * len(effects)]
    for order in permutations(range(len(blanks)), len(effects)):
        trial = [
            claim if (claim := blanks[n]) is not None and _names(claim, effect) else None
            for n, effect in zip(order, effects, strict=True)
        ]
        if _worth(trial, effects) > _worth(best, effects):
            best = trial
    return best


def _worth(trial: Sequence[Claim | None], effects: Sequence[Mapping[str, Any]]) -> tuple[int, int]:
    """Effects named, and of these by the first id."""
    pairs = [(claim, effect) for claim, effect in zip(trial, effects, strict=True) if claim is not None]
    return len(pairs), sum(claim.id in _accepted(effect) for claim, effect in pairs)


def _names(claim: Claim, effect: Mapping[str, Any]) -> bool:
    if claim.id in _accepted(effect):
        return True
    return len(claim.ids) <= LARGEST_TIE and any(tie in _accepted(effect) for tie in claim.ties)


def _accepted(effect: Mapping[str, Any]) -> tuple[str, ...]:
    return tuple(effect.get("accepted", (effect["id"],)))


def _errors(
    effects: Sequence[Mapping[str, Any]], matched: Sequence[Claim | None]
) -> dict[str, tuple[float, float | None]]:
    errors = {}
    for effect, claim in zip(effects, matched, strict=True):
        if claim is None or claim.id != effect["id"]:
            continue
        for name, (value, std) in claim.parameters.items():
            true = effect["parameters"].get(name, {}).get("value")
            if true:
                away = value - true
                errors[f"{effect['id']}.{name}"] = (away / abs(true), away / std if std else None)
    return errors
