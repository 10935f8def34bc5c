"""session.yaml as text: what each log is taken for, and why."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from ssmr_ident.session.session_file import SCHEMA
from ssmr_ident.workflows.new.log import TODO, LogGuess

HEAD = """\
# Written by `ident new` from what the logs in this folder hold, and from their names where no sample can say it.
# A line that says TODO needs you; a comment with a question mark is a guess to check. All keys: docs/howto/session.md
"""
_BASELINE = "rigid6: the 6-DOF robot; decoupled: pure rotations; sdof: a rig; network: bodies on springs; drag: a block"


def session_text(
    name: str,
    parameters: str,
    baseline: str,
    guesses: Sequence[LogGuess],
    wheels: Sequence[LogGuess],
    aside: Sequence[tuple[str, str]],
) -> str:
    """session.yaml, each guess with its reason as a comment."""
    lines = [f"{HEAD}schema: {SCHEMA}", f"name: {_flow(name)}", f"robot: {parameters}"]
    lines += [f"baseline: {baseline}  # {_BASELINE}", "recordings:"]
    for guess in guesses:
        lines.append(f"  # {guess.seen}")
        fields = dict(guess.fields)
        reasons = dict(guess.reasons)
        experiment = guess.experiment
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


_WORDS_OF_YAML = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


def _shared_start(one: str, other: str) -> int:
    return next((k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))


def _wheel_speed(log: LogGuess) -> float:
    """Signed (right − left)/2 [m/s], the median over the log."""
    recording = log.recording
    return float(f"{float(np.median(recording['v_right'] - recording['v_left'])) / 2:.3g}")
