"""How a rig's log was made: let go or struck, driven by a force, or shaken by its foot; and which column is what."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.recording import Channel, Recording
from ssmr_ident.experiments import BASE_MOTION, FORCED, FREE_RESPONSE
from ssmr_ident.experiments.releases import parts_of, release_sentence
from ssmr_ident.signals.common_response import Structure, fitted_response
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.workflows.new.log import (
    ALL_MOTIONS,
    AXES,
    DIES_AWAY,
    FORCES,
    TODO,
    Entry,
    LogGuess,
    add_labels,
    begun,
    course_of,
    energy_share,
    held_by,
    quantities_of,
)
from ssmr_ident.workflows.new.names import hints_of
from ssmr_ident.workflows.new.system import Log

FOOT_WORDS = ("base", "table", "foot", "ground", "floor", "input", "shaker", "platform", "tisch", "fuss", "boden")
"""In a header: what is moved, and carries the rig."""

ROTARY = {"torque", "angle", "angular_rate"}

BETTER = 2.0
"""Choice: by how many times the misfit of a foot below a mass must be less than the other way round to be believed."""

ONE_RESPONSE = 0.5
"""Choice: share of one accelerometer that a response to the other explains, from which one drives and one answers."""


def guess_rig(log: Log, experiment: str = "") -> LogGuess:
    """Guess how one log of a rig was made.

    Parameters
    ----------
    log : Log
    experiment : str
        Of every log, as the user says; empty lets the samples decide.
    """
    hints, recording = hints_of(Path(log.file).stem), log.recording
    entry = begun(log.file, log.sample)
    entry.fields["experiment"] = experiment or FREE_RESPONSE.name
    found = quantities_of(recording)
    named, mapping, reason = dict(found.named), dict(found.mapping), found.reason
    _axis_as_acceleration(recording, named, mapping)
    both = tuple(c.label or c.name for c in recording.channels if c.name in ("acceleration", "acceleration_2"))
    if found.alike.get("acceleration") and not set(FORCES) & set(named):
        reason = _foot_and_mass(recording, found.alike["acceleration"], mapping, named) or reason
    elif len(both) == 2 and not set(FORCES) & set(named):
        tried: dict[str, str] = {}
        said = _foot_and_mass(recording, both, tried, named)
        if "base_acceleration" in tried:  # else they are the two accelerometers that their names say
            mapping, reason = mapping | tried, said
            named.pop("acceleration_2")
    elif TODO in mapping.values():
        reason = _first_of_several(found.alike, mapping)
    rotary = bool(ROTARY & set(named)) and not {"force", "position", "acceleration", "base_acceleration"} & set(named)
    channels = {quantity: header for quantity, header in mapping.items()}
    if channels:
        entry.say("channels", channels, reason)
    motion = [name for name in ALL_MOTIONS if name in named]
    if not motion:
        return LogGuess(log.file, "other", entry.fields, entry.reasons, f"{held_by(recording)}; no motion", recording)
    what = _how(recording, named, motion, entry, bool(experiment))
    add_labels(replace(hints, trial=None), entry)
    if hints.amplitude:
        what += f"; its name says {hints.amplitude}?"
    seen = f"{held_by(recording)}; {what}"
    return LogGuess(log.file, "rig", entry.fields, entry.reasons, seen, in_quantities(recording, mapping), rotary)


def in_quantities(recording: Recording, mapping: Mapping[str, str]) -> Recording:
    """Channels under the names that they are given."""
    turned = {header: quantity for quantity, header in mapping.items()}

    def renamed(channel: Channel) -> Channel:
        name = turned.get(channel.label or channel.name, turned.get(channel.name))
        return replace(channel, name=name) if name else channel

    return recording.with_channels([renamed(channel) for channel in recording.channels])


def _how(recording: Recording, named: Mapping[str, np.ndarray], motion: list[str], entry: Entry, told: bool) -> str:
    """The experiment, with what is seen of it."""
    if told:
        return "as --experiment says"
    if set(FORCES) & set(named):
        entry.fields["experiment"] = FORCED.name
        return "measured force and motion"
    if {"base_acceleration", "base_position"} & set(named):
        entry.fields["experiment"] = BASE_MOTION.name
        return "the foot moves, and the mass on it"
    name = motion[0]
    parts = parts_of(in_quantities(recording, entry.fields.get("channels", {})))
    if parts:
        times = [float(f"{part.recording.time[0]:.6g}") for part in parts]
        sentence = release_sentence("found", parts, given=False).removeprefix("found: ")
        entry.say("release_s", times[0] if len(times) == 1 else times, sentence)
        return f"{'let go' if len(times) == 1 else f'let go or struck {len(times)} times'} at {_list(times)} s"
    share = energy_share(course_of(named[name], recording))
    text = f"90 % of the motion in {name} within {100 * share:.0f} % of the record"
    if share < DIES_AWAY:
        return f"{text}: it dies away"
    entry.reasons["experiment"] = "no force and no foot was logged, and it goes on: a free response?"
    return f"{text}: it goes on"


def _list(times: Sequence[float]) -> str:
    return ", ".join(f"{at:g}" for at in times)


def _axis_as_acceleration(recording: Recording, named: dict[str, np.ndarray], mapping: dict[str, str]) -> None:
    """A rig moves along one line: of the axes of a sensor on it, the one that moves most."""
    axes = [name for name in AXES if name in named]
    if not axes or "acceleration" in named:
        return
    loudest = max(axes, key=lambda name: float(np.nanstd(named[name])))
    channel = recording.channel(loudest)
    mapping["acceleration"] = channel.label or channel.name
    named["acceleration"] = named[loudest]


def _foot_and_mass(
    recording: Recording, headers: Sequence[str], mapping: dict[str, str], named: dict[str, np.ndarray]
) -> str:
    """Which of two accelerometers is on the foot; what is said of it, empty where neither is."""
    if len(headers) != 2:
        return _first_of_several({"acceleration": tuple(headers)}, mapping)
    samples = {h: next(c.samples for c in recording.channels if h in (c.label, c.name)) for h in headers}
    by_name = [h for h in headers if any(word in h.lower() for word in FOOT_WORDS)]
    first, second = headers
    even = even_samples(recording.time, np.column_stack([samples[first], samples[second]]))
    ways = {foot: _left_over(even.samples[:, k], even.samples[:, 1 - k]) for k, foot in enumerate((first, second))}
    foot = by_name[0] if len(by_name) == 1 else min(ways, key=lambda header: ways[header])
    mass = second if foot == first else first
    if len(by_name) != 1 and (ways[foot] > 1.0 - ONE_RESPONSE or ways[foot] * BETTER > ways[mass]):
        return _first_of_several({"acceleration": (first, second)}, mapping)
    mapping |= {"base_acceleration": foot, "acceleration": mass}
    named |= {"base_acceleration": samples[foot], "acceleration": samples[mass]}
    how = "by its name" if len(by_name) == 1 else f"for {mass} answers to {foot}, and not {foot} to {mass}"
    return f"{foot} is the foot {how}?"


def _left_over(drive: np.ndarray, answer: np.ndarray) -> float:
    """Share of the answer that a mass on a foot which moves so leaves unexplained."""
    last = int(0.4 * len(drive))
    u, y = np.fft.rfft(drive - drive.mean())[2 : last + 1], np.fft.rfft(answer - answer.mean())[2 : last + 1]
    s = 1j * np.arange(2, last + 1) / last
    rest = fitted_response(s, u, y, np.ones(len(y)), Structure(2, (0, 1))).residual
    return float(np.sum(np.abs(rest) ** 2) / max(float(np.sum(np.abs(y) ** 2)), 1e-300))


def _first_of_several(alike: Mapping[str, tuple[str, ...]], mapping: dict[str, str]) -> str:
    """Of columns that could all be it, the first, and the second accelerometer as such."""
    said = []
    for quantity, headers in alike.items():
        mapping[quantity] = headers[0]
        if quantity == "acceleration" and len(headers) > 1:
            mapping["acceleration_2"] = headers[1]
        said.append(f"which of {', '.join(headers)} is the {quantity}?")
    return " ".join(said)
