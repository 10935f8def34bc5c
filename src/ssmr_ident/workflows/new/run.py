"""``ident new``: from a folder of logs to a session that fits and diagnoses, with guesses shown and few questions."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.place import Place
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.physics.network import NETWORK
from ssmr_ident.readers import ReadOptions, read
from ssmr_ident.readers.folder import logs_in
from ssmr_ident.readers.options import RATE
from ssmr_ident.session import bundled_robots
from ssmr_ident.session.entry import BASELINES
from ssmr_ident.workflows.new.answers import MASSES, Answers, answered, mass_in
from ssmr_ident.workflows.new.block import block_text, guess_pull
from ssmr_ident.workflows.new.draft import Draft, Guess
from ssmr_ident.workflows.new.log import LogGuess, guess_log
from ssmr_ident.workflows.new.machines import pairs_among
from ssmr_ident.workflows.new.network import modes_seen, network_text, placed
from ssmr_ident.workflows.new.rig import rig_text
from ssmr_ident.workflows.new.rig_log import guess_rig
from ssmr_ident.workflows.new.robot import robot_text
from ssmr_ident.workflows.new.session_text import session_text
from ssmr_ident.workflows.new.system import BASELINE, Log, system_of


@dataclass(frozen=True)
class Told:
    """What the user says beforehand.

    Parameters
    ----------
    robot : str
        A bundled robot whose values robot.yaml starts from; empty leaves questions.
    mass : float or None [kg] or [kg m^2]
        Of a rig's moving part, or of a block.
    baseline, experiment : str
        Empty lets the logs decide.
    columns, units : mapping
        For the readers, of every log.
    sample_rate_hz : float or None
    answers : mapping of key to value
        A key of session.yaml for every recording that has it, ``FILE:KEY`` for one, or a key of robot.yaml.
    """

    robot: str = ""
    mass: float | None = None
    baseline: str = ""
    experiment: str = ""
    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    sample_rate_hz: float | None = None
    answers: Answers = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.robot and self.robot not in bundled_robots():
            raise InputError("--robot", f"{self.robot!r} is not bundled", did_you_mean(self.robot, bundled_robots()))
        if self.baseline and self.baseline not in BASELINES:
            raise InputError("--baseline", f"is {self.baseline!r}", did_you_mean(self.baseline, BASELINES))
        if self.experiment and self.experiment not in EXPERIMENTS:
            raise InputError("--experiment", f"is {self.experiment!r}", did_you_mean(self.experiment, EXPERIMENTS))
        if self.mass is not None and not 0 < self.mass < math.inf:
            raise InputError("--mass-kg", f"is {self.mass:g}, expected more than 0")
        if self.sample_rate_hz is not None:
            RATE.check(Place("--fs"), self.sample_rate_hz)

    @property
    def reading(self) -> dict[str, Any]:
        """The keys of an entry that these become."""
        keys = {"columns": dict(self.columns), "units": dict(self.units), "sample_rate_hz": self.sample_rate_hz}
        return {key: value for key, value in keys.items() if value}


def draft_session(folder: Path, told: Told | None = None, progress: Callable[[int, int], None] | None = None) -> Draft:
    """Look at every log of a folder and write down what it seems to be.

    Parameters
    ----------
    folder : Path
    told : Told, optional
    progress : callable, optional
        Called with the number of logs read and their total.

    Raises
    ------
    InputError
        No such folder, no log in it that can be read, an answer that nothing asks for.
    """
    told = told or Told()
    if not folder.is_dir():
        raise InputError(str(folder), "is no folder", "Put the logs into a folder and name it")
    files, problems = logs_in([folder])
    if problems:
        raise problems[0]
    logs: list[Log] = []
    aside: list[tuple[str, str]] = []
    for index, file in enumerate(files):
        held, reason = _read(file, told)
        logs += held
        aside += [(file.name, reason)] if reason else []
        if progress:
            progress(index + 1, len(files))
    if not logs:
        raise _nothing(folder, len(files), aside)
    system, why = system_of(logs, told.baseline, told.robot, told.mass is not None)
    guesses, found, more = _guesses(system, logs, told)
    aside += more
    wheels = [guess for guess in guesses if guess.kind == "wheels"]
    aside += [(g.file, g.seen) for g in guesses if g.kind == "other"]
    listed = tuple(guess for guess in guesses if guess.kind not in ("wheels", "other"))
    if system == "robot":
        wrong = [guess for guess in listed if guess.kind == "rig"]
        aside += [(g.file, f"{g.seen}, which a robot's session has no place for") for g in wrong]
        listed = tuple(guess for guess in listed if guess not in wrong)
    if not listed:
        raise _nothing(folder, len(files), aside)
    listed = tuple(_with_reading(guess, told) for guess in listed)
    listed, of_parameters = answered(listed, told.answers, system)
    mass = mass_in(of_parameters, told.mass) if system != "robot" else None
    name = re.sub(r"[^\w.-]+", "-", folder.resolve().name).strip("-") or "session"
    baseline = told.baseline or BASELINE[system]
    modes = modes_seen(listed) if system == "rig" and told.baseline in ("", NETWORK) else None
    if baseline == NETWORK and (modes is None or modes.bodies < 2):
        problem = "needs accelerations of two bodies or more, in which as many modes are seen"
        raise InputError("--baseline", f"{NETWORK} {problem}", "Leave it out, or write bodies and springs yourself")
    text = {"rig": rig_text, "block": block_text}.get(system)
    if modes is not None and modes.bodies > 1:
        baseline, listed = NETWORK, tuple(placed(guess, modes) for guess in listed)
        why = f"{len(modes.hz)} modes are seen by {len(modes.sensors)} accelerometers"
        parameters = network_text(name, modes, mass)
    else:
        parameters = text(name, listed, mass) if text else robot_text(name, told.robot, listed, of_parameters)
    file_name = "rig.yaml" if text else "robot.yaml"
    session = session_text(name, file_name, baseline, listed, wheels, aside)
    return Draft(
        folder,
        f"a {system} ({why})",
        baseline,
        listed,
        tuple(aside),
        tuple(found),
        file_name,
        session,
        parameters,
        _mass_guess(parameters) if mass is None and text else None,
    )


def _nothing(folder: Path, count: int, aside: Sequence[tuple[str, str]]) -> InputError:
    return InputError(
        str(folder),
        f"none of its {count} logs could be used",
        f"{aside[0][0]}: {aside[0][1]}. Say what its columns are: docs/howto/formats.md" if aside else "",
    )


def _read(file: Path, told: Told) -> tuple[list[Log], str]:
    options = ReadOptions(fs=told.sample_rate_hz, units=dict(told.units), columns=dict(told.columns))
    try:
        recordings = read(file, options)
    except InputError as error:
        return [], f"{error.problem}. {error.mend}".rstrip(". ")
    several = len(recordings) > 1
    return [Log(file.name, k if several else None, r) for k, r in enumerate(recordings, start=1)], ""


def _guesses(
    system: str, logs: Sequence[Log], told: Told
) -> tuple[tuple[LogGuess, ...], list[str], list[tuple[str, str]]]:
    """What each recording is taken for, what was found of several logs together, and which are left out."""
    if system == "robot":
        return tuple(guess_log(log.file, log.recording, log.sample) for log in logs), [], []
    if system == "block":
        return tuple(guess_pull(log, told.experiment) for log in logs), [], []
    pairs, aside, alone = pairs_among(logs)
    guesses = []
    for pair in pairs:
        guess = guess_rig(pair.together, told.experiment)
        own = {key: value for key, value in guess.fields.items() if key != "file"}
        reasons = dict(guess.reasons) | {"files": pair.sentence}
        channels = pair.channels
        fields = {
            "files": pair.files,
            "experiment": own.pop("experiment"),
            **({"channels": channels} if channels else {}),
        }
        guesses.append(
            replace(guess, fields=fields | {k: v for k, v in own.items() if k != "channels"}, reasons=reasons)
        )
    guesses += [guess_rig(log, told.experiment) for log in alone]
    return tuple(guesses), [pair.sentence for pair in pairs], aside


def _with_reading(guess: LogGuess, told: Told) -> LogGuess:
    """What the user told the readers, for when the session is read."""
    return replace(guess, fields=dict(guess.fields) | told.reading) if told.reading else guess


def _mass_guess(parameters: str) -> Guess | None:
    """The mass where it is a guess: no log tells it, and nobody said it."""
    content = yaml.safe_load(parameters)
    key = next((key for key in MASSES if key in content), "")
    if not key:  # of a network
        return None
    source = str(content[key].get("source", ""))
    guessed = source.startswith(("nobody", "a guess"))
    return Guess(key, content[key]["value"], source) if guessed else None
