"""A session with its logs read: every recording in SI and in this package's words, beside how it was made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.experiments.experiment import Experiment
from ssmr_ident.experiments.quantities import UNITS, to_quantities
from ssmr_ident.physics.robot import accelerometer_from_parameters
from ssmr_ident.physics.sensor import Accelerometer
from ssmr_ident.readers import ReadOptions, read_one
from ssmr_ident.session import Entry, Session, read_parameters, read_session


@dataclass(frozen=True, eq=False)
class Measurement:
    """One recording of a campaign: how it was made, and what was measured (SI)."""

    entry: Entry
    recording: Recording
    wheels: Recording | None = None

    @property
    def name(self) -> str:
        return self.entry.file if self.entry.sample is None else f"{self.entry.file}#{self.entry.sample}"

    @property
    def experiment(self) -> Experiment:
        return EXPERIMENTS[self.entry.experiment]


@dataclass(frozen=True, eq=False)
class Campaign(Shown):
    """A session with its parameters and recordings read."""

    session: Session
    parameters: ParameterSet
    measurements: tuple[Measurement, ...]

    def of(self, experiment: str, **fields: object) -> tuple[Measurement, ...]:
        """Measurements of one experiment whose entry has the given field values."""
        return tuple(
            m
            for m in self.measurements
            if m.entry.experiment == experiment and all(getattr(m.entry, k) == v for k, v in fields.items())
        )

    def __str__(self) -> str:
        lines = [f"campaign {self.session.name}: {len(self.measurements)} recordings"]
        for m in self.measurements:
            r = m.recording
            lines.append(f"  {m.name:<36} {m.entry.experiment:<20} {r.duration:8.3f} s  {', '.join(r.names)}")
        return "\n".join(lines)


def load(path: str | Path, progress: Callable[[int, int], None] | None = None) -> Campaign:
    """Read a session folder and all its logs.

    Parameters
    ----------
    path : path of the folder or of its session.yaml
    progress : callable, optional
        Called with the number of logs read and their total.

    Raises
    ------
    InputError
        Names the file and key, or the log and the place in it.
    """
    session = read_session(path)
    parameters = read_parameters(session.robot)
    accelerometer = accelerometer_from_parameters(parameters)
    measurements = []
    for index, entry in enumerate(session.entries):
        measurements.append(_measure(session, entry, accelerometer))
        if progress:
            progress(index + 1, len(session.entries))
    return Campaign(session, parameters, tuple(measurements))


def _measure(session: Session, entry: Entry, accelerometer: Accelerometer) -> Measurement:
    options = read_options(entry)
    recording = to_quantities(read_one(session.path(entry), options), entry, accelerometer)
    recording = on_its_clock(recording, EXPERIMENTS[entry.experiment]).on_even_grid()
    for group in EXPERIMENTS[entry.experiment].channels:
        if not any(name in recording for name in group):
            raise InputError(
                str(session.path(entry)),
                f"{entry.experiment} needs {' or '.join(group)}; found {', '.join(recording.names) or 'nothing'}",
                f"Map the header in session.yaml: channels: {{{group[0]}: HEADER}}",
            )
    wheels = None
    if entry.wheel_log:
        wheels = read_one(session.folder / entry.wheel_log, ReadOptions())
    return Measurement(entry, recording, wheels)


def on_its_clock(recording: Recording, experiment: Experiment) -> Recording:
    """Where channels have clocks of their own: the recording at the times of the one that answers, so that what is
    compared is what was sampled and only the drive is taken between its samples."""
    if not recording.clocks_differ:
        return recording
    used = [channel.name for channel in recording.channels if channel.name in UNITS]
    answers = [name for name in used if name in experiment.channels[-1]]
    if not answers:
        return recording
    slowest = min(answers, key=lambda name: recording.series(name).rate)
    return recording.on_clock_of(slowest, among=used)


def read_options(entry: Entry) -> ReadOptions:
    """What the entry tells the reader."""
    return ReadOptions(
        reader=entry.reader,
        fs=entry.sample_rate_hz,
        units=dict(entry.units),
        columns=dict(entry.columns),
        skip="auto" if entry.skip_rows is None else entry.skip_rows,
        sheets=dict(entry.sheets),
        channels=dict(entry.channels),
        time_unit=entry.time_unit,
        on_bad=entry.on_bad,
        stamps=entry.stamps,
        trim=entry.trim,
        load_scale=entry.load_scale,
        sample=entry.sample,
        decimal=entry.decimal,
    )
