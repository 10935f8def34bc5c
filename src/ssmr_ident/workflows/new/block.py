"""A block that a head pulls over a surface: how its logs were made, and what it starts a fit from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments import EXPERIMENTS, WHEEL_DRAG
from ssmr_ident.session.parameters_text import parameters_text
from ssmr_ident.workflows.new.log import (
    TODO,
    LogGuess,
    add_labels,
    begun,
    head_speed,
    held_by,
    moving_speed,
    quantities_of,
)
from ssmr_ident.workflows.new.names import hints_of
from ssmr_ident.workflows.new.rig_log import in_quantities
from ssmr_ident.workflows.new.system import Log

GRAVITY = 9.80665
DRY = 0.4
"""Friction of many dry pairs (handbooks give 0.2 to 0.6): what a mass is guessed by where nobody says it."""

LEFT_REST = 0.5
"""Choice: share of the highest force at which a pull has begun: what is before it is slack and a head at rest."""

FIRST_LOOK = "first look at the logs: a start for the fit, no knowledge"


@dataclass(frozen=True)
class Pull:
    """What a pull's force shows at first sight.

    Parameters
    ----------
    top, level : float [N]
        The highest before it slides, and the middle one while it does.
    from_s : float [s]
        When it first slides.
    """

    top: float
    level: float
    from_s: float


def pull_of(time: np.ndarray, force: np.ndarray) -> Pull:
    """A pull's highest force and the level of its sliding; the quiet begin and the rise count for neither."""
    size = np.abs(np.asarray(force, float))
    size = np.where(np.isfinite(size), size, 0.0)
    width = max(1, len(size) // 400)
    smooth = np.convolve(size, np.ones(width) / width, mode="same")
    began = int(np.argmax(smooth > LEFT_REST * float(np.quantile(smooth, 0.95))))
    rest = smooth[began:]
    # it slides from the first top that it falls from by a twentieth of what the pull reaches
    highest = np.maximum.accumulate(rest)
    fell = np.flatnonzero(highest - rest > 0.05 * float(np.max(rest)))
    slides = began + (int(fell[0]) if len(fell) else len(rest) // 2)
    top = float(np.max(size[max(0, began - width) : slides + width + 1]))
    return Pull(top, float(np.median(size[slides:])), float(time[slides]))


def guess_pull(log: Log, experiment: str = "") -> LogGuess:
    """Guess how one log of a pulled block was made."""
    hints, recording = hints_of(Path(log.file).stem), log.recording
    entry = begun(log.file, log.sample)
    entry.fields["experiment"] = experiment or WHEEL_DRAG.name
    found = quantities_of(recording)
    if "force" not in found.named:
        return LogGuess(log.file, "other", entry.fields, entry.reasons, f"{held_by(recording)}; no force", recording)
    mapping = {q: h for q, h in found.mapping.items() if q in ("force", "position") and h != TODO}
    if mapping:
        entry.say("channels", mapping, found.reason)
    speed = head_speed(recording, found.named)
    if speed is not None:
        entry.say("speed_mm_s", float(f"{1e3 * abs(speed):.3g}"), "slope of the position")
    elif "position" in found.named:
        moved = moving_speed(np.asarray(found.named["position"], float), recording.time)
        entry.say("speed_mm_s", float(f"{1e3 * moved:.3g}"), "while the head moves, for it did not run evenly")
    elif hints.head_mm_s is not None:
        entry.say("speed_mm_s", hints.head_mm_s, "from the name?")
    else:
        entry.say("speed_mm_s", 1.0, "nothing tells the head's speed: 1 mm/s? friction that depends on it needs it")
    if EXPERIMENTS[str(entry.fields["experiment"])].of_one_wheel:
        entry.say("free_normal", True, "it can lift off the surface")
    add_labels(replace(hints, trial=None), entry)
    pull = pull_of(recording.time, found.named["force"])
    what = f"pulled; slides from {pull.from_s:.3g} s, {pull.top:.4g} N at first, {pull.level:.4g} N then"
    seen = f"{held_by(recording)}; {what}"
    return LogGuess(log.file, "block", entry.fields, entry.reasons, seen, in_quantities(recording, mapping))


def block_text(name: str, guesses: Sequence[LogGuess], mass: float | None) -> str:
    """rig.yaml of a block: friction from the level and the highest force."""
    pulls = [pull_of(guess.recording.time, guess.recording["force"]) for guess in guesses]
    level = float(np.median([pull.level for pull in pulls]))
    top = max(float(np.median([pull.top for pull in pulls])), level)
    given = mass is not None
    mass = _digits(level / (DRY * GRAVITY)) if mass is None else mass
    source = "given to ident new" if given else f"a guess by a friction of {DRY}, as many dry pairs have: weigh it"
    weight = mass * GRAVITY
    estimates = {
        "mass_kg": Estimate(mass, None, "kg", source),
        "mu_static": Estimate(_digits(top / weight), None, "1", FIRST_LOOK),
        "mu_kinetic": Estimate(_digits(level / weight), None, "1", FIRST_LOOK),
        "cable.stiffness_N_m": Estimate(math.inf, None, "N/m", "taken as stiff; give it where it is known"),
    }
    lines = [
        f"# Written by `ident new`. The force is {top:.4g} N when it first slides, {level:.4g} N in the middle then;",
        "# friction is that over the weight. Add std where you know one: left out, it means unknown.",
    ]
    return "\n".join([*lines, ""]) + parameters_text(ParameterSet(name, estimates))


def _digits(value: float) -> float:
    return float(f"{value:.4g}")
