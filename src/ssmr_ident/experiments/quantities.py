"""What a log's columns stand for: quantities by the entry's own names, in SI, and what volts mean."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.recording import Channel, Note, Recording
from ssmr_ident.core.units import OF_A_GOAL
from ssmr_ident.physics.sensor import Accelerometer
from ssmr_ident.readers.health import ends_of_supply
from ssmr_ident.session import Entry
from ssmr_ident.session.entry import FURTHER, MOTIONS

UNITS = {
    **{"force": "N", "torque": "N m", "position": "m", "position_reference": "m", "velocity": "m/s"},
    **{"voltage": "V", "enabled": "1"},
    **dict.fromkeys(("acceleration", "base_acceleration", "ax", "ay", "az"), "m/s^2"),
    **{"base_position": "m"},
    **{"angle": "rad", "angular_rate": "rad/s", "wx": "rad/s", "wy": "rad/s", "wz": "rad/s"},
    **{"v_left": "m/s", "v_right": "m/s"},
}
UNITS |= {name: UNITS[name.rpartition("_")[0]] for name in FURTHER}


def to_quantities(recording: Recording, entry: Entry, accelerometer: Accelerometer) -> Recording:
    """Rename channels as the entry says, and turn volts into the quantity they stand for.

    Raises
    ------
    InputError
        A header that is not in the log, volts that nothing calibrates, a unit of another quantity.
    """
    named = _renamed(recording, entry)
    notes: list[Note] = []
    channels = []
    for channel in named:
        if channel.unit == "V" and channel.name != "voltage":
            channel, note = _from_volts(channel, recording, entry, accelerometer)
            notes += [note] if note else []
        expected = UNITS.get(channel.name)
        if channel.name == "position_reference" and channel.unit in OF_A_GOAL:
            expected = channel.unit
        if expected and channel.unit == "" and channel.name in entry.channels:
            channel = replace(channel, unit=expected)
            if expected != "1":
                notes.append(Note("warning", f"{channel.label}: no unit in the file, taken as {expected}"))
        elif expected and channel.unit not in (expected, "", "V" if channel.name not in entry.channels else expected):
            raise InputError(
                f"{recording.provenance.file}: {channel.label or channel.name}",
                f"has unit {channel.unit!r}, but {channel.name} is in {expected}",
                f"Give the right unit in session.yaml: units: {{{channel.label}: …}}",
            )
        channels.append(channel)
    return recording.with_channels(channels, *notes)


def restricted(recording: Recording, entry: Entry) -> Recording:
    """Of a rig's log only the motions that its entry names, where it names any; all where it names none."""
    named = {*entry.channels} & {*MOTIONS, *FURTHER}
    kept = [c for c in recording.channels if c.name in named or c.name not in (*MOTIONS, *FURTHER)]
    return recording.with_channels(kept) if named else recording


def _renamed(recording: Recording, entry: Entry) -> list[Channel]:
    wanted: dict[str, str] = {}
    for quantity, header in entry.channels.items():
        matches = [c for c in recording.channels if header in (c.label, c.name)]
        if not matches:
            labels = [c.label or c.name for c in recording.channels]
            raise InputError(
                f"{recording.provenance.file}",
                f"has no column {header!r} for {quantity}",
                did_you_mean(header, labels),
            )
        wanted[matches[0].name] = quantity
    taken = set(wanted.values())
    result = []
    for channel in recording.channels:
        if channel.name in wanted:
            result.append(replace(channel, name=wanted[channel.name]))
        elif channel.name not in taken:
            result.append(channel)
    return result


def _from_volts(
    channel: Channel, recording: Recording, entry: Entry, accelerometer: Accelerometer
) -> tuple[Channel, Note | None]:
    unit = UNITS.get(channel.name)
    if channel.name in entry.per_volt:
        if unit is None:
            raise InputError(f"session entry {entry.file}: per_volt", f"{channel.name} is no known quantity")
        factor = entry.per_volt[channel.name]
        return channel.scaled(lambda volts: volts * factor, unit), None
    if channel.name in ("ax", "ay", "az", "acceleration"):
        axis = max("xyz".find(channel.name[-1]), 0) if channel.name != "acceleration" else 0
        scaled = channel.scaled(lambda volts: accelerometer.to_acceleration(volts, axis), "m/s^2")
        samples = scaled.samples
        scale = f"{accelerometer.volts_zero:g} V + {accelerometer.volts_per_m_s2:.6g} V s^2/m · a"
        note = Note("info", f"{channel.label or channel.name}: volts to m/s^2 by {scale}")
        # counted here, where the volts are still at hand
        low, high = np.sort(accelerometer.to_acceleration(np.array(ends_of_supply(channel.samples)), axis))
        found = replace(scaled, rails=(float(low), float(high)))
        low, high = found.shows(accelerometer.range_m_s2)
        clipped = (samples <= low) | (samples >= high)
        if clipped.any():
            ends = f"{low:.4g} … {high:.4g} m/s^2"
            note = Note("warning", f"{channel.name}: {int(clipped.sum())} samples at the ends of what it shows, {ends}")
        return found, note
    if channel.name in entry.channels:
        raise InputError(
            f"{recording.provenance.file}: {channel.label}",
            f"is in volts, {channel.name} is wanted in {unit}",
            f"Say in session.yaml what a volt stands for: per_volt: {{{channel.name}: …}}",
        )
    return channel, None
