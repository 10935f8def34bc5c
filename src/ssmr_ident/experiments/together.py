"""One recording of several logs: two machines logged one event, each at a rate and on a clock of its own."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recent import Recent
from ssmr_ident.core.recording import Channel, Note, Provenance, Recording
from ssmr_ident.experiments.experiment import ACCELERATIONS, BASES
from ssmr_ident.session.entry import MOTIONS
from ssmr_ident.signals.alignment import Alignment, Clocked, align
from ssmr_ident.signals.grid import band_limited, even_samples

DRIVES = ("force", "torque", *BASES)
"""What a clock is found by first: what drives, and then what moves."""

FELT = (*DRIVES, *MOTIONS, "acceleration_2", *ACCELERATIONS)

FINER = 4
"""A log that is read between its samples is made so much finer within its band first: a cubic through samples at a
quarter of their distance is true to 0.1 % up to 0.4 of the rate."""

SLOWER = 0.45
"""Share of the grid's rate that a faster log is low-passed at before it is read on it."""

_FOUND: Recent[Alignment] = Recent(64)


@dataclass(frozen=True)
class Log:
    """One log of an event.

    Parameters
    ----------
    recording : Recording
        In SI and this package's words.
    delay_s : float or None
        By how much its clock reads more than the first log's; None lets it be found.
    """

    recording: Recording
    delay_s: float | None = None


def clock_of(first: Recording, second: Recording) -> tuple[Alignment, str, str]:
    """Shift and drift of the second log's clock, and by which channels they were found.

    What drives is taken from the log that has it, whichever comes first.

    Raises
    ------
    InputError
        One of them has no channel that an event is felt in, or they have nothing in common.
    """
    one, other = _felt(first), _felt(second)
    turned = other in DRIVES and one not in DRIVES
    key = first.provenance.sha256, second.provenance.sha256, one, other, len(first.time), len(second.time)
    pair = [Clocked(f"{_short(r)} ({name})", r.time, r[name]) for r, name in ((first, one), (second, other))]
    found = _FOUND.of((*key, turned), lambda: align(*(pair[::-1] if turned else pair)))
    return (_turned(found) if turned else found), one, other


def merged(logs: Sequence[Log]) -> Recording:
    """All channels on the first log's clock, over what all logs cover.

    The grid is that of the fastest log with a motion: what is compared stays as it was logged, and what drives is read
    between its samples, as a force of limited band.

    Raises
    ------
    InputError
        Clocks that cannot be found, logs that do not overlap.
    """
    first = logs[0].recording
    placed, notes = [first], [note for log in logs for note in log.recording.notes]
    for log in logs[1:]:
        time, note = _on_the_first_clock(first, log, logs[0].delay_s or 0.0)
        placed.append(replace(log.recording, time=time))
        notes.append(note)
    begin, end = max(r.time[0] for r in placed), min(r.time[-1] for r in placed)
    moving = [r for r in placed if (set(FELT) - set(DRIVES)) & set(r.names)]
    grid_of = max(moving or placed, key=lambda r: r.sample_rate)
    inside = (grid_of.time >= begin - 1e-9) & (grid_of.time <= end + 1e-9)
    if np.count_nonzero(inside) < 2:
        names = ", ".join(r.provenance.file for r in placed)
        raise InputError(names, "do not overlap", "Are they logs of one event? See delay_s")
    grid = grid_of.time[inside]
    channels = [c for r in placed for c in _read_at(r, grid, None if r is not grid_of else inside)]
    parts = [r.provenance for r in placed]
    provenance = Provenance(
        " + ".join(part.file for part in parts), "+".join(part.sha256 for part in parts), parts[0].reader
    )
    return Recording(grid, tuple(channels), provenance, tuple(notes))


def _on_the_first_clock(first: Recording, log: Log, own: float) -> tuple[np.ndarray, Note]:
    second = log.recording
    if log.delay_s is not None:
        shift = log.delay_s - own
        said = f"{_short(second)}: its clock reads {shift:.4g} s more than that of {_short(first)}"
        return second.time - shift, Note("info", f"{said}, as given by delay_s")
    found, one, other = clock_of(first, second)
    return found.to_first(second.time), Note("info", clock_sentence(first, second, found, one, other))


def clock_sentence(first: Recording, second: Recording, found: Alignment, one: str, other: str) -> str:
    """What was found of two clocks, in words."""
    shift = f"{found.shift_s:.4f} ± {max(found.shift_std_s, 1e-5):.1g} s"
    drift = f"{found.drift_ppm:.0f} ± {max(found.drift_std_ppm, 1.0):.1g} parts in a million"
    return (
        f"{_short(second)}: its clock reads {shift} more than that of {_short(first)} at "
        f"{found.start_s:.4g} s of it, and gains {drift}; found from {one} and {other}, "
        f"{100 * found.explained:.3g} % of which is one response up to {found.band_hz[1]:.3g} Hz"
    )


def _short(recording: Recording) -> str:
    return Path(recording.provenance.file).name


def _felt(recording: Recording) -> str:
    name = next((name for name in FELT if name in recording), None)
    if name is None:
        raise InputError(
            recording.provenance.file,
            f"has nothing that an event is felt in; found {', '.join(recording.names)}",
            f"Map one by channels: {', '.join(FELT)}",
        )
    return name


def _turned(found: Alignment) -> Alignment:
    """The same with the logs in the other order."""
    drift = 1e-6 * found.drift_ppm
    start, end = (at + found.shift_s + drift * (at - found.start_s) for at in (found.start_s, found.end_s))
    return replace(found, shift_s=-found.shift_s, drift_ppm=1e6 * (1.0 / (1.0 + drift) - 1.0), start_s=start, end_s=end)


def _read_at(recording: Recording, grid: np.ndarray, inside: np.ndarray | None) -> list[Channel]:
    """Channels at other times: as they are on their own grid, else within their band."""
    if inside is not None:
        return [replace(c, samples=c.samples[inside]) for c in recording.channels]
    from scipy.interpolate import CubicSpline  # a session without several logs need not wait for these
    from scipy.signal import butter, sosfiltfilt

    rate = (len(grid) - 1) / float(grid[-1] - grid[0])
    even = even_samples(recording.time, np.column_stack([c.samples for c in recording.channels]))
    found = []
    for channel, column in zip(recording.channels, even.samples.T, strict=True):
        if even.sample_rate > rate:
            low_pass = butter(8, SLOWER * rate, fs=even.sample_rate, output="sos")
            fine, time = sosfiltfilt(low_pass, column), even.time
        else:
            fine = band_limited(column, FINER)
            time = even.start + np.arange(len(fine)) / (FINER * even.sample_rate)
        found.append(replace(channel, samples=CubicSpline(time, fine)(grid), rails=(-math.inf, math.inf)))
    return found


def undelayed(recording: Recording, delays: Mapping[str, float]) -> Recording:
    """Channels that are known to come late put back, over what all of them cover.

    Parameters
    ----------
    recording : Recording
    delays : mapping of quantity to float [s]

    Raises
    ------
    InputError
        A quantity that the log has not, or a delay longer than the log.
    """
    for name in delays:
        if name not in recording:
            found = ", ".join(recording.names)
            raise InputError(f"{recording.provenance.file}: delay_s", f"has no {name}; found {found}", "Check its name")
    time = recording.time
    begin = max(0.0, -min(delays.values()))
    end = max(0.0, *delays.values())
    inside = (time >= time[0] + begin - 1e-9) & (time <= time[-1] - end + 1e-9)
    if np.count_nonzero(inside) < 2:
        raise InputError(f"{recording.provenance.file}: delay_s", f"is more than its {recording.duration:g} s")
    channels, notes = [], []
    for channel in recording.channels:
        late = delays.get(channel.name, 0.0)
        if late:
            alone = replace(recording, time=time - late, channels=(channel,))
            channels += _read_at(alone, time[inside], None)
            notes.append(Note("info", f"{channel.name}: {late:.6g} s late, as given by delay_s, and put back"))
        else:
            channels.append(replace(channel, samples=channel.samples[inside]))
    return replace(recording, time=time[inside], channels=tuple(channels), notes=recording.notes + tuple(notes))


def one_of_each(recordings: Mapping[str, Recording], wanted: Mapping[str, str]) -> None:
    """Refuse a quantity that several logs have and no entry assigns.

    Parameters
    ----------
    recordings : mapping of file to Recording
    wanted : mapping of quantity to file
    """
    seen: dict[str, str] = {}
    for file, recording in recordings.items():
        for name in recording.names:
            if name in seen and name not in wanted:
                raise InputError(
                    f"{seen[name]}, {file}", f"both have {name}", f"Say which one counts: files: {{{name}: {file}}}"
                )
            seen.setdefault(name, file)
