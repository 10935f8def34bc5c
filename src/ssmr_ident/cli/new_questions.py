"""What ``ident new`` asks in a terminal: one question at a time, each with what the logs suggest."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import typer

from ssmr_ident.core.errors import InputError
from ssmr_ident.workflows.new.answers import value_of
from ssmr_ident.workflows.new.draft import Draft


def typed(draft: Draft) -> dict[str, str]:
    """Answers by key, as ``--set`` takes them.

    An empty line takes a guess as it is. A mass that nobody said stays a guess then, for nothing tells it; what no log
    suggests stays open. What cannot be is asked again.
    """
    given: dict[str, str] = {}
    suggestions, open_keys = draft.suggestions, draft.open_keys
    if not suggestions and not open_keys:
        return given
    count = f"{len(draft.guesses)} recording{'s' if len(draft.guesses) > 1 else ''}"
    typer.echo(f"{draft.folder}: {count} of {draft.system}. An empty line keeps [what is shown].")
    for guess in suggestions:
        shown = f"{guess.value:g}" if isinstance(guess.value, float) else str(guess.value)
        typer.echo(f"  {guess.why}")
        answer = typer.prompt(f"  {guess.key}", default=shown, value_proc=_checked(guess.key))
        if answer != shown or guess is not draft.mass_guess:
            given[guess.key] = answer
    for key, question in open_keys:
        answer = typer.prompt(f"  {key}: {question}", default="", show_default=False, value_proc=_checked(key))
        if answer:
            given[key] = answer
    return given


def _checked(key: str) -> Callable[[Any], str]:
    """Refuses what the key may not be, which has the question asked again."""

    def check(text: Any) -> str:
        answer = str(text).strip()
        if answer:
            try:
                value_of(key, answer)
            except InputError as error:
                raise typer.BadParameter(error.problem) from error
        return answer

    return check
