"""A session to be: its two files, what in them is a guess, and what nobody but the user knows."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_ident.workflows.new.log import TODO, LogGuess
from ssmr_ident.workflows.new.robot import QUESTIONS

NAMES = ("session.yaml", "robot.yaml", "rig.yaml")


@dataclass(frozen=True)
class Question:
    """A line to fill in."""

    file: str
    line: int
    text: str
    question: str


@dataclass(frozen=True)
class Guess:
    """A value that the logs or their names suggest, to be looked at.

    Parameters
    ----------
    key : str
        As ``--set`` takes it: a key of every recording, or ``FILE:KEY`` of one, or a key of the parameter file.
    value : object
    why : str
    """

    key: str
    value: Any
    why: str


@dataclass(frozen=True, eq=False)
class Draft(Shown):
    """A session to be.

    Parameters
    ----------
    folder : Path
    system : str
        What it was made on, and why that is thought.
    baseline : str
    guesses : tuple of LogGuess
        Recordings that are listed.
    aside : tuple of (str, str)
        Files that are not, and why.
    found : tuple of str
        What was found out about several logs together.
    parameters_name : str
        Of the parameter file.
    session_text, parameters_text : str
        The two files.
    mass_guess : Guess or None
        Where nobody said a mass and nothing tells it.
    """

    folder: Path
    system: str
    baseline: str
    guesses: tuple[LogGuess, ...]
    aside: tuple[tuple[str, str], ...]
    found: tuple[str, ...]
    parameters_name: str
    session_text: str
    parameters_text: str
    mass_guess: Guess | None = None

    @property
    def questions(self) -> tuple[Question, ...]:
        """Lines that say TODO, in both files."""
        found = []
        for file, text in (("session.yaml", self.session_text), (self.parameters_name, self.parameters_text)):
            for number, line in enumerate(text.splitlines(), start=1):
                before, _, comment = line.partition("#")
                if re.search(rf"\b{TODO}\b", before):
                    found.append(Question(file, number, before.strip(" -"), comment.strip()))
        return tuple(found)

    @property
    def suggestions(self) -> tuple[Guess, ...]:
        """Values with a question mark, each once where all recordings share it."""
        found = [] if self.mass_guess is None else [self.mass_guess]
        for key in dict.fromkeys(key for guess in self.guesses for key in guess.fields):
            asked = [g for g in self.guesses if "?" in g.reasons.get(key, "") and g.fields.get(key) != TODO]
            if not asked or isinstance(asked[0].fields[key], dict):
                continue
            if len({repr(g.fields[key]) for g in asked}) == 1:
                found.append(Guess(key, asked[0].fields[key], asked[0].reasons[key]))
            else:
                found += [Guess(f"{g.file}:{key}", g.fields[key], g.reasons[key]) for g in asked]
        return tuple(found)

    @property
    def open_keys(self) -> tuple[tuple[str, str], ...]:
        """Keys, as ``--set`` takes them, of what says TODO, each once with its question."""
        found: dict[str, str] = {}
        for guess in self.guesses:
            found |= {
                key: guess.reasons.get(key, "")
                for key, value in guess.fields.items()
                if value == TODO and key not in found
            }
        if any(question.file == self.parameters_name for question in self.questions):
            asked = {question.text.partition(":")[0].strip() for question in self.questions}
            found |= {key: text for key, text in QUESTIONS.items() if key.rsplit(".", 1)[-1] in asked}
        return tuple(found.items())

    @property
    def next_command(self) -> str:
        """What to type now."""
        folder = str(self.folder)
        name = f"'{folder}'" if re.search(r"\s", folder) else folder
        out = f"'{folder.rstrip('/')}-diagnosis'" if re.search(r"\s", folder) else f"{folder.rstrip('/')}-diagnosis"
        return f"ident diagnose {name} -o {out}"

    def write(self) -> tuple[Path, Path]:
        """Write both files into the folder.

        Raises
        ------
        InputError
            One of them is there already: nothing is overwritten.
        """
        paths = self.folder / "session.yaml", self.folder / self.parameters_name
        refuse_existing(self.folder)
        write_text(paths[1], self.parameters_text)
        write_text(paths[0], self.session_text)  # last: a session.yaml stands for a whole session
        return paths

    def as_dict(self) -> dict[str, Any]:
        """Plain values for ``--json``."""
        return {
            "session": str(self.folder),
            "files": ["session.yaml", self.parameters_name],
            "system": self.system,
            "baseline": self.baseline,
            "recordings": [dict(guess.fields) | {"seen": guess.seen} for guess in self.guesses],
            "aside": [{"file": file, "reason": reason} for file, reason in self.aside],
            "found": list(self.found),
            "guesses": [{"key": g.key, "value": g.value, "why": g.why} for g in self.suggestions],
            "questions": [
                {"file": q.file, "line": q.line, "text": q.text, "question": q.question} for q in self.questions
            ],
            "next": self.next_command,
        }

    def __str__(self) -> str:
        width = max(len(guess.file) for guess in self.guesses)
        count = f"{len(self.guesses)} recording{'s' if len(self.guesses) > 1 else ''}"
        lines = [f"{self.folder}: {count}, {self.system}; baseline {self.baseline}"]
        for guess in self.guesses:
            keys = ("motion", "direction", "yaw_rate_deg_s", "speed_mm_s", "release_s")
            about = [_about(key, guess.fields[key]) for key in keys if key in guess.fields]
            channels = guess.fields.get("channels", {})
            about += [", ".join(f"{q} = {_header(header)}" for q, header in channels.items())] if channels else []
            about += [f" # {guess.reasons['channels']}"] if "?" in guess.reasons.get("channels", "") else []
            lines.append(f"  {guess.file:<{width}}  {' '.join([str(guess.fields['experiment']), *about])}")
        lines += [f"  {file:<{width}}  left out: {reason}" for file, reason in self.aside]
        lines += [f"  {sentence}" for sentence in self.found]
        values = [line.strip() for line in self.parameters_text.splitlines() if line.startswith(_SHOWN)]
        lines += [f"  {line.partition('  #')[0]}" for line in values if TODO not in line]
        if self.suggestions:
            lines.append("guesses, each to be changed by --set KEY=VALUE:")
            lines += [f"  {g.key} = {g.value}  # {g.why}" for g in self.suggestions]
        return "\n".join([*lines, *_asked(self.questions)])


_SHOWN = ("mass_kg:", "inertia_kg_m2: {", "stiffness_", "damping_", "mu_")


def _header(said: Any) -> str:
    return f"{said['column']} of {said['body']}" if isinstance(said, dict) else str(said)


def _about(key: str, value: Any) -> str:
    if key == "speed_mm_s":
        return f"{value} mm/s"
    if key == "release_s":
        times = value if isinstance(value, list) else [value]
        return f"from {', '.join(f'{at:g}' for at in times)} s"
    return str(value)


def _asked(questions: Sequence[Question]) -> list[str]:
    if not questions:
        return []
    lines = [f"{len(questions)} line{'s' if len(questions) > 1 else ''} to fill in:"]
    asked: dict[tuple[str, str, str], list[str]] = {}
    for q in questions:
        asked.setdefault((q.file, q.text, q.question), []).append(str(q.line))
    for (file, text, question), numbers in asked.items():
        more = f" and {len(numbers) - 3} more" if len(numbers) > 3 else ""
        lines.append(f"  {file}:{','.join(numbers[:3])}{more}  {text}  # {question}")
    return lines


def refuse_existing(folder: Path) -> None:
    """Raise InputError where one of the files is there already."""
    for name in NAMES:
        if (folder / name).exists():
            raise InputError(str(folder / name), "is there already and is not overwritten", "Move it away first")
