"""What the user answers, by key: checked as the keys of the two files are, and put in the place of guesses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import yaml

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.nested_domain import declared
from ssmr_ident.core.place import Place
from ssmr_ident.session.entry import Entry
from ssmr_ident.session.schema import KEYS
from ssmr_ident.workflows.new.log import LogGuess
from ssmr_ident.workflows.new.robot import QUESTIONS

Answers = Mapping[str, str]
MASSES = ("mass_kg", "inertia_kg_m2")


def value_of(key: str, text: str) -> Any:
    """An answer as the file will have it.

    Parameters
    ----------
    key : str
        Of session.yaml or of the parameter file, with or without ``FILE:`` before it.
    text : str

    Raises
    ------
    InputError
        What the key may not be.
    """
    own = key.rpartition(":")[2]
    domain = KEYS[own].domain if own in KEYS else declared(Entry)[own][0]
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise InputError("--set", f"{key}={text} cannot be read", "Write a number, a word, or [a, b, c]") from error
    domain.check(Place("--set", (key,)), value)
    return value


def answered(guesses: Sequence[LogGuess], answers: Answers, system: str) -> tuple[tuple[LogGuess, ...], dict[str, Any]]:
    """Guesses with the user's own values in the keys that they have; and what is left for the parameter file.

    Raises
    ------
    InputError
        An answer that nothing asks for, or that cannot be.
    """
    keys = {key for guess in guesses for key in guess.fields} - {"file", "files", "sample"}
    files = {guess.file for guess in guesses}
    known = set(QUESTIONS) if system == "robot" else set(MASSES)
    of_parameters: dict[str, Any] = {}
    of_entries: dict[str, Any] = {}
    for key, text in answers.items():
        file, colon, own = key.rpartition(":")
        if colon and (file not in files or own not in keys):
            raise InputError("--set", f"no recording here is {file!r} with {own!r}", did_you_mean(file, files))
        if not colon and key not in keys | known:
            raise InputError("--set", f"no recording here asks for {key!r}", did_you_mean(key, keys | known))
        (of_parameters if not colon and key in known else of_entries)[key] = value_of(key, text)
    return tuple(_one(guess, of_entries) for guess in guesses), of_parameters


def _one(guess: LogGuess, values: Mapping[str, Any]) -> LogGuess:
    given = {key: values.get(f"{guess.file}:{key}", values.get(key)) for key in guess.fields}
    fields = {key: value if given[key] is None else given[key] for key, value in guess.fields.items()}
    reasons = {key: reason for key, reason in guess.reasons.items() if given.get(key) is None}
    return replace(guess, fields=fields, reasons=reasons)


def mass_in(values: Mapping[str, Any], told: float | None) -> float | None:
    """The mass or inertia among the answers, else the one that was told."""
    return next((float(values[key]) for key in MASSES if key in values), told)
