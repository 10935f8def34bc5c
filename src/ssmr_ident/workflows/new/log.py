"""How a log was probably made, from what it holds; its name fills in what no sample can say.

Every entry keeps the reason beside the guess, and the word TODO where there is none to be had.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.core.units import QUANTITY_OF_UNIT
from ssmr_ident.experiments import EXPERIMENTS, FORCED, FREE_RESPONSE, PULL, SWIVEL, VERTICAL_COMPRESSION, Experiment
from ssmr_ident.readers.table.headings import SI_UNIT
from ssmr_ident.session.entry import QUANTITIES
from ssmr_ident.signals.filters import low_pass
from ssmr_ident.workflows.new.names import NameHints, hints_of

TODO = "TODO"
AXES = ("ax", "ay", "az")
RATES = {"wx": "roll", "wy": "pitch", "wz": "yaw"}
FORCES = ("force", "torque")
ALL_MOTIONS = ("position", "velocity", "acceleration", "angle", "angular_rate", "position_reference", "acceleration_2")
SYMBOLS = {"f": "force", "x": "position", "v": "velocity", "a": "acceleration"}
SCALES = ("force", "torque", *ALL_MOTIONS, *AXES, *RATES)

DIES_AWAY = 0.5
"""Share of a record that holds 90 % of its energy: below, it has fallen to less than a tenth of its start. For an
exponential that falls to 1/10 the share is ln(1/(1 - 0.9·0.99))/(2·ln 10) = 0.48; for what goes on it is 0.9."""

LARGER = 4.0
"""Choice: energy ratio of two axes from which one of them counts as the axis of the motion."""

ONE_WAY = 0.8
"""Choice: way from the first to the last twentieth of a record over the whole travel; 0.95 for an even speed."""

STEADY = 0.02
"""Choice: departure from a straight line, over the travel, below which a position is that of a machine's head."""


@dataclass(frozen=True)
class LogGuess:
    """One recording of session.yaml to be.

    Parameters
    ----------
    file : str
    kind : {"robot", "rig", "machine", "wheels", "other"}
        Accelerometers on a robot, force and motion of a rig, a testing machine, a log of wheel speeds, none of these.
    fields : dict of key to value
        Of the entry, in order; ``TODO`` for what is asked for.
    reasons : dict of key to str
        Why, or the question; keys as in ``fields``.
    seen : str
        What the log holds, in a line.
    recording : Recording
    rotary : bool
        Torque or angle instead of force or position.
    """

    file: str
    kind: str
    fields: Mapping[str, Any]
    reasons: Mapping[str, str]
    seen: str
    recording: Recording
    rotary: bool = False

    @property
    def experiment(self) -> Experiment | None:
        """What it is taken for; None where that is asked for."""
        return EXPERIMENTS.get(self.fields["experiment"])


@dataclass
class Entry:
    """Filled key by key."""

    fields: dict[str, Any] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)

    def say(self, key: str, value: Any, reason: str = "") -> None:
        self.fields[key] = value
        if reason:
            self.reasons[key] = reason


def guess_log(name: str, recording: Recording, sample: int | None = None) -> LogGuess:
    """Guess how one recording was made.

    Parameters
    ----------
    name : str
        Of the file, as session.yaml will have it.
    recording : Recording
    sample : int or None
        Its number, for a file that holds several.
    """
    hints = hints_of(Path(name).stem)
    entry = begun(name, sample)
    named = _quantities(recording, entry)
    rotary = bool({"torque", "angle"} & set(named)) and not {"force", "position"} & set(named)
    if {"v_left", "v_right"} & set(recording.names):
        kind, what = "wheels", "wheel speeds"
    elif set(AXES) & set(named):
        kind, what = "robot", _on_robot(recording, named, hints, entry)
    elif set(FORCES) & set(named) and _by_machine(recording, named, hints):
        kind, what = "machine", _on_machine(recording, named, hints, entry)
    elif set(FORCES) & set(named) and set(ALL_MOTIONS) & set(named):
        kind, what = "rig", "measured force and motion"
        entry.fields["experiment"] = FORCED.name
    elif set(ALL_MOTIONS) & set(named):
        kind, what = "rig", free_rig(recording, named, entry)
    elif set(FORCES) & set(named):
        kind, what = "machine", _on_machine(recording, named, hints, entry)
    else:
        kind, what = "other", "no force and no motion that is known by name or unit"
    add_labels(hints, entry)
    return LogGuess(name, kind, entry.fields, entry.reasons, f"{held_by(recording)}; {what}", recording, rotary)


def begun(name: str, sample: int | None) -> Entry:
    """An entry with its file."""
    entry = Entry()
    entry.say("file", name)
    if sample is not None:
        entry.say("sample", sample, "the file holds several recordings")
    return entry


def held_by(recording: Recording) -> str:
    """Channels, rate and length of a log, in a line."""
    rate = f"{recording.sample_rate:.6g} Hz, " if len(recording.time) > 1 else ""
    channels = ", ".join(f"{c.label or c.name} [{c.unit or '?'}]" for c in recording.channels)
    return f"{channels}; {rate}{len(recording.time)} samples"


@dataclass(frozen=True)
class Quantities:
    """What columns stand for.

    Parameters
    ----------
    named : dict of quantity to (n,) float
    mapping : dict of quantity to header
        Where the header does not say it; ``TODO`` where several columns could be.
    reason : str
        For the mapping.
    alike : dict of quantity to tuple of str
        Headers of one unit that could each be it.
    """

    named: Mapping[str, np.ndarray]
    mapping: Mapping[str, str]
    reason: str
    alike: Mapping[str, tuple[str, ...]]


def quantities_of(recording: Recording) -> Quantities:
    """Samples by quantity; a header that names none is taken by its unit where only one column has it."""
    sound = [c for c in recording.channels if c.name not in SI_UNIT or c.unit in (SI_UNIT[c.name], "V", "")]
    named = {c.name: c.samples for c in sound if c.name in SCALES}  # velocity [rad/s] is an angular rate
    mapping: dict[str, str] = {}
    several: dict[str, tuple[str, ...]] = {}
    reason = "by their units?"
    strangers = [c for c in recording.channels if c.name not in QUANTITIES or not any(c is one for one in sound)]
    for channel in strangers:
        header = channel.label or channel.name
        quantity = SYMBOLS.get(header.lower()) if channel.unit == "" else QUANTITY_OF_UNIT.get(channel.unit)
        if quantity not in SCALES or quantity in named:
            continue
        alike = [c.label or c.name for c in strangers if c.unit == channel.unit != ""]
        mapping[quantity] = TODO if len(alike) > 1 else header
        named[quantity] = channel.samples
        if len(alike) > 1:
            several[quantity] = tuple(alike)
            reason = f"which of {', '.join(alike)} is the {quantity}?"
        elif channel.unit == "":
            reason = (
                f"by their letters? the file has no units: SI is taken, others are said by units: {{{header}: lbf}}"
            )
    return Quantities(named, mapping, reason, several)


def _quantities(recording: Recording, entry: Entry) -> Mapping[str, np.ndarray]:
    found = quantities_of(recording)
    entry.fields["experiment"] = TODO  # its place in the entry, before channels
    if found.mapping:
        entry.say("channels", dict(found.mapping), found.reason)
    return found.named


def _on_robot(recording: Recording, named: Mapping[str, np.ndarray], hints: NameHints, entry: Entry) -> str:
    energy = {name: course_of(named[name], recording) for name in AXES if name in named}
    total = np.sum(list(energy.values()), axis=0)
    share = energy_share(total)
    text = f"90 % of the motion within {100 * share:.0f} % of the record"
    if share < DIES_AWAY:
        entry.fields["experiment"] = FREE_RESPONSE.name
        entry.say("motion", *_motion(recording, named, energy, hints))
        return f"{text}: it dies away"
    named_so = hints.experiment
    if named_so and (named_so.free or (named_so.on_wheels and not named_so.turns)):
        entry.say("experiment", named_so.name, f"from the name; {text}?")
        if named_so.free:
            entry.say("motion", *_motion(recording, named, energy, hints))
        return f"{text}: it goes on"
    entry.fields["experiment"] = SWIVEL.name
    if hints.yaw_rate_deg_s is not None:
        entry.say("yaw_rate_deg_s", hints.yaw_rate_deg_s, "from the name")
    elif "wz" in named and abs(np.median(named["wz"])) > 3.0 * np.std(named["wz"]) / math.sqrt(len(named["wz"])):
        entry.say("yaw_rate_deg_s", round(float(np.rad2deg(np.median(named["wz"]))), 1), "median of wz; was it wanted?")
    else:
        entry.say("yaw_rate_deg_s", TODO, "wanted yaw rate in degrees per second")
    return f"{text}: it goes on"


def _motion(
    recording: Recording, named: Mapping[str, np.ndarray], energy: Mapping[str, np.ndarray], hints: NameHints
) -> tuple[str, str]:
    """Motion of a free response and the reason. A roll and a yaw both show in ay."""
    rates = {name: float(np.sum(course_of(named[name], recording))) for name in RATES if name in named}
    sizes = {name: float(np.sum(course)) for name, course in energy.items()}
    largest = max(rates or sizes, key=lambda name: (rates or sizes)[name])
    if hints.motion:
        return hints.motion, f"from the name; largest in {largest}"
    if len(rates) == 3:
        return RATES[largest], f"largest in {largest}?"
    if {"ax", "ay"} <= set(sizes) and sizes["ax"] > LARGER * sizes["ay"]:
        return "pitch", f"ax holds {sizes['ax'] / sizes['ay']:.3g} times the energy of ay?"
    choice = (
        "roll or yaw" if {"ax", "ay"} <= set(sizes) and sizes["ay"] > LARGER * sizes["ax"] else "roll, pitch or yaw"
    )
    return TODO, f"{choice}? largest in {largest}"


def _on_machine(recording: Recording, named: Mapping[str, np.ndarray], hints: NameHints, entry: Entry) -> str:
    speed = head_speed(recording, named)
    force = np.asarray(named["force" if "force" in named else "torque"], float)
    high = int(np.nanargmax(np.abs(force)))
    rises = high > 0.97 * len(force)
    experiment, reason = hints.experiment, "from the name"
    if experiment is None or not experiment.on_a_testing_machine:
        experiment = VERTICAL_COMPRESSION if rises else PULL
        reason = "the force rises to the end: a press? or a pull, a wheel_drag" if rises else "or a wheel_drag?"
    entry.say("experiment", experiment.name, reason)
    if experiment.drags_everything:
        entry.say(
            "direction",
            *((hints.direction, "from the name") if hints.direction else (TODO, "lateral or longitudinal?")),
        )
    if speed is not None:
        entry.say("speed_mm_s", float(f"{1e3 * abs(speed):.3g}"), "slope of the position")
    elif "position" in named:
        speed = moving_speed(np.asarray(named["position"], float), recording.time)
        entry.say("speed_mm_s", float(f"{1e3 * speed:.3g}"), "while the head moves, for it did not run evenly")
    else:
        entry.say("speed_mm_s", TODO, "speed of the head: the log has no position")
    if experiment.drags_everything:
        entry.say("height_m", TODO, "of the cable above the floor")
        if hints.wheels:
            entry.say("wheels_gripping", TODO, "such as [1, 2]: rear left 1, front left 2, front right 3, rear right 4")
        else:
            entry.say("wheels_gripping", [1, 2, 3, 4], "all? those on oiled plates do not grip")
        if hints.spinning:
            entry.say("wheel_rate_rad_s", TODO, "at which rate do the wheels spin?")
        entry.say("cable", hints.cable or "steel", "from the name" if hints.cable else "or rope?")
    if experiment.of_one_wheel and not experiment.vertical:
        entry.say("free_normal", True, "can the wheel move off the surface?")
    moves = "" if speed is None else f" at {1e3 * abs(speed):.3g} mm/s"
    return f"a head moves{moves}, {np.nanmax(np.abs(force)):.4g} N at most"


def free_rig(recording: Recording, named: Mapping[str, np.ndarray], entry: Entry) -> str:
    name = next(name for name in ALL_MOTIONS if name in named)
    share = energy_share(course_of(named[name], recording))
    text = f"90 % of the motion in {name} within {100 * share:.0f} % of the record"
    if share < DIES_AWAY:
        entry.fields["experiment"] = FREE_RESPONSE.name
        return f"{text}: it dies away"
    entry.say("experiment", FREE_RESPONSE.name, "it goes on, and no force was logged: a free response?")
    return f"{text}: it goes on"


def add_labels(hints: NameHints, entry: Entry) -> None:
    for key in ("floor", "frame", "trial", "role"):
        value = getattr(hints, key)
        if value is not None:
            entry.say(key, value, "from the name")


def course_of(samples: np.ndarray, recording: Recording) -> np.ndarray:
    """Squared motion below 50 Hz about the level of the record's end."""
    samples = np.nan_to_num(np.asarray(samples, float), nan=float(np.nanmedian(samples)))
    if recording.sample_rate > 250.0 and len(samples) > 200:
        samples = low_pass(samples, recording.sample_rate, 50.0)
    result: np.ndarray = (samples - np.median(samples[3 * len(samples) // 4 :])) ** 2
    return result


def energy_share(energy: np.ndarray) -> float:
    """Shortest share of a record that holds nine tenths of its energy."""
    total = np.concatenate([[0.0], np.cumsum(energy)])
    if total[-1] <= 0:
        return 1.0
    ends = np.searchsorted(total, total + 0.9 * total[-1])
    fits = ends < len(total)
    return float(np.min((ends - np.arange(len(total)))[fits])) / (len(total) - 1) if fits.any() else 1.0


def _by_machine(recording: Recording, named: Mapping[str, np.ndarray], hints: NameHints) -> bool:
    """The head went from one end of its travel to the other, or the name says so; nothing but its position was logged.

    A rig that is shaken comes back to where it was.
    """
    if "position" not in named or set(ALL_MOTIONS) & set(named) - {"position"}:
        return False
    return goes_one_way(named["position"]) or (hints.experiment is not None and hints.experiment.on_a_testing_machine)


def goes_one_way(position: np.ndarray) -> bool:
    """Whether a position goes from one end of its travel to the other, as a machine's head does."""
    position = np.asarray(position, float)
    piece = max(1, len(position) // 20)
    way = abs(float(np.nanmedian(position[-piece:]) - np.nanmedian(position[:piece])))
    return way > ONE_WAY * float(np.nanmax(position) - np.nanmin(position))


def moving_speed(position: np.ndarray, time: np.ndarray) -> float:
    """Median speed [m/s] over those fortieths of a record in which a head moves (a fifth of the fastest, or more)."""
    at = np.linspace(0, len(time) - 1, 41).round().astype(int)
    speeds = np.abs(np.diff(position[at]) / np.diff(time[at]))
    return float(np.median(speeds[speeds > 0.2 * np.max(speeds)])) if np.nanmax(speeds) > 0 else 0.0


def head_speed(recording: Recording, named: Mapping[str, np.ndarray]) -> float | None:
    """Speed [m/s] of a position that runs straight, None for any other motion."""
    if "position" not in named:
        return None
    position, time = np.asarray(named["position"], float), recording.time
    good = np.isfinite(position)
    if np.count_nonzero(good) < 8:
        return None
    slope, start = np.polyfit(time[good], position[good], 1)
    travel = abs(slope) * float(np.ptp(time[good]))
    off = float(np.std(position[good] - slope * time[good] - start))
    return float(slope) if travel > 0 and off < STEADY * travel else None
