"""``ident new``: from a folder of logs to a session.yaml and a robot.yaml with what is known, and questions."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.shown import Shown
from ssmr_ident.readers import read
from ssmr_ident.readers.folder import logs_in
from ssmr_ident.session import bundled_robots
from ssmr_ident.session.entry import BASELINES
from ssmr_ident.session.session_file import SCHEMA
from ssmr_ident.workflows.new.log import TODO, LogGuess, guess_log
from ssmr_ident.workflows.new.robot import block_text, rig_text, robot_text

HEAD = """\
# Written by `ident new` from what the logs in this folder hold, and from their names where no sample can say it.
# A line that says TODO needs you; a comment with a question mark is a guess to check. All keys: docs/howto/session.md
"""
_BASELINE = "rigid6: the 6-DOF robot; decoupled: pure rotations; sdof: a rig with one mass; drag: a pulled block"


@dataclass(frozen=True)
class Question:
    """A line to fill in."""

    file: str
    line: int
    text: str
    question: str


@dataclass(frozen=True, eq=False)
class Draft(Shown):
    """A session to be.

    Parameters
    ----------
    folder : Path
    baseline : str
    guesses : tuple of LogGuess
        Recordings that are listed.
    aside : tuple of (str, str)
        Files that are not, and why.
    session_text, robot_text : str
        The two files.
    """

    folder: Path
    baseline: str
    guesses: tuple[LogGuess, ...]
    aside: tuple[tuple[str, str], ...]
    session_text: str
    robot_text: str

    @property
    def questions(self) -> tuple[Question, ...]:
        """Lines that say TODO, in both files."""
        found = []
        for file, text in (("session.yaml", self.session_text), ("robot.yaml", self.robot_text)):
            for number, line in enumerate(text.splitlines(), start=1):
                before, _, comment = line.partition("#")
                if re.search(rf"\b{TODO}\b", before):
                    found.append(Question(file, number, before.strip(" -"), comment.strip()))
        return tuple(found)

    def write(self) -> tuple[Path, Path]:
        """Write both files into the folder.

        Raises
        ------
        InputError
            One of them is there already: nothing is overwritten.
        """
        paths = self.folder / "session.yaml", self.folder / "robot.yaml"
        refuse_existing(self.folder)
        write_text(paths[1], self.robot_text)
        write_text(paths[0], self.session_text)  # last: a session.yaml stands for a whole session
        return paths

    def as_dict(self) -> dict[str, Any]:
        """Plain values for ``--json``."""
        return {
            "session": str(self.folder),
            "files": ["session.yaml", "robot.yaml"],
            "baseline": self.baseline,
            "recordings": [dict(guess.fields) | {"seen": guess.seen} for guess in self.guesses],
            "aside": [{"file": file, "reason": reason} for file, reason in self.aside],
            "questions": [
                {"file": q.file, "line": q.line, "text": q.text, "question": q.question} for q in self.questions
            ],
        }

    def __str__(self) -> str:
        width = max(len(guess.file) for guess in self.guesses)
        lines = [f"{self.folder}: {len(self.guesses)} recordings, baseline {self.baseline}"]
        for guess in self.guesses:
            about = [str(guess.fields[key]) for key in ("motion", "direction", "yaw_rate_deg_s") if key in guess.fields]
            lines.append(f"  {guess.file:<{width}}  {' '.join([str(guess.fields['experiment']), *about])}")
        lines += [f"  {file:<{width}}  left out: {reason}" for file, reason in self.aside]
        if self.questions:
            lines.append(f"{len(self.questions)} line{'s' if len(self.questions) > 1 else ''} to fill in:")
            asked: dict[tuple[str, str, str], list[str]] = {}
            for q in self.questions:
                asked.setdefault((q.file, q.text, q.question), []).append(str(q.line))
            for (file, text, question), numbers in asked.items():
                more = f" and {len(numbers) - 3} more" if len(numbers) > 3 else ""
                lines.append(f"  {file}:{','.join(numbers[:3])}{more}  {text}  # {question}")
        return "\n".join(lines)


def refuse_existing(folder: Path) -> None:
    """Raise InputError where a session.yaml or robot.yaml is there already."""
    for name in ("session.yaml", "robot.yaml"):
        if (folder / name).exists():
            raise InputError(str(folder / name), "is there already and is not overwritten", "Move it away first")


def draft_session(
    folder: Path,
    robot: str = "",
    mass: float | None = None,
    baseline: str = "",
    answers: Mapping[str, str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Draft:
    """Look at every log of a folder and write down what it seems to be.

    Parameters
    ----------
    folder : Path
    robot : str
        A bundled robot whose values robot.yaml starts from; empty leaves questions.
    mass : float or None [kg]
        Of a rig's moving part (kg m² for a rotary one) or of a block.
    baseline : str
        Empty lets the logs decide between a robot and a rig.
    answers : mapping of key to value
        Of session.yaml, for every recording that would ask for it, or that has another guess.
    progress : callable, optional
        Called with the number of logs read and their total.

    Raises
    ------
    InputError
        No such folder, no log in it that can be read, an unknown robot or baseline.
    """
    if not folder.is_dir():
        raise InputError(str(folder), "is no folder", "Put the logs into a folder and name it")
    if robot and robot not in bundled_robots():
        raise InputError("--robot", f"{robot!r} is not bundled", did_you_mean(robot, bundled_robots()))
    if baseline and baseline not in BASELINES:
        raise InputError("--baseline", f"is {baseline!r}", did_you_mean(baseline, BASELINES))
    if mass is not None and not 0 < mass < float("inf"):
        raise InputError("--mass-kg", f"is {mass:g}, expected more than 0")
    files, problems = logs_in([folder])
    if problems:
        raise problems[0]
    guesses: list[LogGuess] = []
    aside: list[tuple[str, str]] = []
    for index, file in enumerate(files):
        found, reason = _look_at(file)
        guesses += found
        if reason:
            aside.append((file.name, reason))
        if progress:
            progress(index + 1, len(files))
    wheels = [guess for guess in guesses if guess.kind == "wheels"]
    listed = tuple(guess for guess in guesses if guess.kind not in ("wheels", "other"))
    aside += [(g.file, g.seen) for g in guesses if g.kind == "other"]
    if not listed:
        raise InputError(
            str(folder),
            f"none of its {len(files)} logs could be used",
            f"{aside[0][0]}: {aside[0][1]}. Say what its columns are: docs/howto/formats.md" if aside else "",
        )
    baseline = baseline or ("sdof" if all(guess.kind == "rig" for guess in listed) else "rigid6")
    wrong = [guess for guess in listed if guess.kind == "rig" and baseline in ("rigid6", "decoupled")]
    aside += [(g.file, f"{g.seen}, which a robot's session has no place for") for g in wrong]
    listed = tuple(guess for guess in listed if guess not in wrong)
    name = re.sub(r"[^\w.-]+", "-", folder.resolve().name).strip("-") or "session"
    texts = {"sdof": lambda: rig_text(name, listed, mass), "drag": lambda: block_text(name, listed, mass)}
    parameters = texts.get(baseline, lambda: robot_text(name, robot, listed))()
    listed = _answered(listed, answers or {})
    session = _session_text(name, baseline, listed, wheels, aside)
    return Draft(folder, baseline, listed, tuple(aside), session, parameters)


def _answered(guesses: tuple[LogGuess, ...], answers: Mapping[str, str]) -> tuple[LogGuess, ...]:
    """Guesses with the caller's own values in the keys that they have."""
    keys = {key for guess in guesses for key in guess.fields} - {"file", "sample"}
    for key in answers:
        if key not in keys:
            raise InputError("--set", f"no recording here asks for {key!r}", did_you_mean(key, keys))
    return tuple(
        replace(
            guess,
            fields={key: yaml.safe_load(answers[key]) if key in answers else v for key, v in guess.fields.items()},
            reasons={key: reason for key, reason in guess.reasons.items() if key not in answers},
        )
        for guess in guesses
    )


def _look_at(file: Path) -> tuple[list[LogGuess], str]:
    try:
        recordings = read(file)
    except InputError as error:
        return [], f"{error.problem}. {error.mend}".rstrip(". ")
    several = len(recordings) > 1
    return [guess_log(file.name, r, k if several else None) for k, r in enumerate(recordings, start=1)], ""


def _session_text(
    name: str, baseline: str, guesses: Sequence[LogGuess], wheels: Sequence[LogGuess], aside: Sequence[tuple[str, str]]
) -> str:
    lines = [f"{HEAD}schema: {SCHEMA}", f"name: {_flow(name)}", "robot: robot.yaml"]
    lines += [f"baseline: {baseline}  # {_BASELINE}", "recordings:"]
    for guess in guesses:
        lines.append(f"  # {guess.seen}")
        fields = dict(guess.fields)
        reasons = dict(guess.reasons)
        experiment = guess.experiment
        if baseline == "drag" and experiment and experiment.drags_everything:
            fields = {key: value for key, value in fields.items() if key not in _OF_ROBOTS}
        if experiment and experiment.turns and wheels:
            partner = max(wheels, key=lambda log: _shared_start(log.file, guess.file))
            fields["wheel_log"], reasons["wheel_log"] = partner.file, "same start of the name?"
            if fields.get("yaw_rate_deg_s") == TODO:
                del fields["yaw_rate_deg_s"]
                fields["wheel_speed_m_s"], reasons["wheel_speed_m_s"] = _wheel_speed(partner), "median of the wheel log"
        entry = [
            f"{key}: {_flow(value)}" + (f"  # {reasons[key]}" if key in reasons else "")
            for key, value in fields.items()
        ]
        lines += [f"  {'-' if index == 0 else ' '} {line}" for index, line in enumerate(entry)]
    if aside:
        lines += [
            "",
            "# Left out; to take one in, give it an entry with what the message asks for (units, columns, channels):",
        ]
        lines += [f"#   {file}: {' '.join(reason.split())}" for file, reason in aside]
    return "\n".join(lines) + "\n"


def _flow(value: Any) -> str:
    """A value on one line; JSON is YAML as well, and quotes what needs quoting."""
    if isinstance(value, str) and re.fullmatch(r"[A-Za-z_][\w./-]*", value) and value.lower() not in _WORDS_OF_YAML:
        return value
    return json.dumps(value, ensure_ascii=False).replace(f'"{TODO}"', TODO)


_OF_ROBOTS = {"direction", "height_m", "wheels_gripping", "wheel_rate_rad_s", "cable"}
_WORDS_OF_YAML = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


def _shared_start(one: str, other: str) -> int:
    return next((k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))


def _wheel_speed(log: LogGuess) -> float:
    """Signed (right − left)/2 [m/s], the median over the log."""
    import numpy as np

    recording = log.recording
    return float(f"{float(np.median(recording['v_right'] - recording['v_left'])) / 2:.3g}")
