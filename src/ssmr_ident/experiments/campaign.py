"""A session with its logs read: every recording in SI and in this package's words, beside how it was made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments import BASE_MOTION, EXPERIMENTS
from ssmr_ident.experiments.experiment import BASES, RIGS, Experiment
from ssmr_ident.experiments.quantities import UNITS, restricted, to_quantities
from ssmr_ident.experiments.releases import parts_of, release_sentence
from ssmr_ident.experiments.together import Log, merged, one_of_each, undelayed
from ssmr_ident.physics.network import NETWORK, bodies_of
from ssmr_ident.physics.robot import accelerometer_from_parameters
from ssmr_ident.physics.sensor import Accelerometer
from ssmr_ident.physics.voltage_drive import DRIVE, VoltageDrive, drive_from_parameters
from ssmr_ident.readers import ReadOptions, read_one
from ssmr_ident.session import Entry, Reading, Session, read_parameters, read_session

LEAST = 1e-100
"""SI: a channel that moves by less is taken for one that does not move."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """One recording of a campaign: how it was made, and what was measured (SI).

    ``release_s`` tells decays of one log apart, where it holds several; ``found`` says what was found out about it that
    no file says, such as releases, or by how much two clocks differ.
    """

    entry: Entry
    recording: Recording
    wheels: Recording | None = None
    release_s: float | None = None
    found: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        name = self.entry.file if self.entry.sample is None else f"{self.entry.file}#{self.entry.sample}"
        return name if self.release_s is None else f"{name}@{self.release_s:.4g}s"

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

    @property
    def found(self) -> tuple[str, ...]:
        """What was found out about recordings that no file says, each once."""
        return tuple(dict.fromkeys(sentence for m in self.measurements for sentence in m.found))

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
    return load_logs(read_session(path), progress)


def load_logs(session: Session, progress: Callable[[int, int], None] | None = None) -> Campaign:
    """As ``load``, of a session whose file is read already."""
    parameters = read_parameters(session.robot)
    places_known(session, parameters)
    motor = drive_from_parameters(parameters)
    drives_known(session, parameters, motor)
    accelerometer = accelerometer_from_parameters(parameters)
    measurements: list[Measurement] = []
    for index, entry in enumerate(session.entries):
        measurements += _decays(_measure(session, entry, accelerometer, motor), session.baseline)
        if progress:
            progress(index + 1, len(session.entries))
    return Campaign(session, parameters, tuple(measurements))


def places_known(session: Session, parameters: ParameterSet) -> None:
    """Refuse a network of which no file describes the bodies, and channels that belong to none of them.

    Raises
    ------
    InputError
        With the entry and the channel.
    """
    where = f"{session.folder / 'session.yaml'}"
    bodies = bodies_of(parameters)
    if (session.baseline == NETWORK) != bool(bodies):
        problem = f"is {session.baseline}, and {Path(parameters.file).name} has {'' if bodies else 'no '}bodies:"
        raise InputError(
            f"{where}: baseline", problem, f"Write baseline: {NETWORK} for bodies on springs, and for no other"
        )
    for index, entry in enumerate(session.entries):
        here = f"{where}: recordings[{index}].channels"
        for quantity, body in entry.bodies.items():
            if body not in bodies:
                raise InputError(
                    f"{here}.{quantity}.body", f"is {body!r}, which is no body", did_you_mean(body, bodies)
                )
        for quantity in entry.channels if len(bodies) > 1 else ():
            if quantity not in (*entry.bodies, *BASES, "time"):
                mend = f"Write {quantity}: {{column: {entry.channels[quantity]}, body: {' or '.join(bodies)}}}"
                raise InputError(f"{here}.{quantity}", "names no body", mend)


def drives_known(session: Session, parameters: ParameterSet, motor: VoltageDrive | None) -> None:
    """Refuse what a motor is given where no file describes the motor, and a motor on what has no joint.

    Raises
    ------
    InputError
        With the entry and the key.
    """
    file = Path(parameters.file).name
    if motor is not None and (session.baseline != "sdof" or "inertia_kg_m2" not in parameters):
        mend = "Write inertia_kg_m2 and its spring in rotary units, with baseline: sdof; or take drive: out"
        raise InputError(f"{parameters.file}: {DRIVE}", "turns the one joint of a rotary rig, and here is none", mend)
    for index, entry in enumerate(session.entries):
        here = f"{session.folder / 'session.yaml'}: recordings[{index}]"
        asked = [f"channels.{name}" for name in ("voltage", "enabled") if name in entry.channels]
        asked += ["controller"] if entry.controller is not None else []
        if asked and motor is None:
            mend = f"Write {DRIVE}: {{kt_N_m_A: {{value: …}}, R_ohm: {{value: …}}}} in {file}"
            raise InputError(f"{here}.{asked[0]}", f"is of a motor, and {file} has no {DRIVE}:", mend)
        if asked and not EXPERIMENTS[entry.experiment].driven:
            raise InputError(
                f"{here}.{asked[0]}", f"drives nothing in a {entry.experiment}", "Write experiment: forced"
            )


def _measure(session: Session, entry: Entry, accelerometer: Accelerometer, motor: VoltageDrive | None) -> Measurement:
    if entry.files:
        recording = _of_several(session, entry, accelerometer)
    else:
        options = read_options(entry, entry.channels)
        recording = to_quantities(read_one(session.folder / entry.file, options), entry, accelerometer)
        if session.baseline in RIGS:
            recording = restricted(recording, entry)
        recording = on_its_clock(recording, EXPERIMENTS[entry.experiment]).on_even_grid()
    if any(entry.delay_s.values()):
        recording = undelayed(recording, entry.delay_s)
    entry = replace(entry, experiment=_as_logged(entry, recording).name)
    groups = EXPERIMENTS[entry.experiment].channels
    # under a controller the goal drives
    for group in groups if entry.controller is None else (("position_reference",), *groups[1:]):
        if not any(name in recording and (name != "voltage" or motor is not None) for name in group):
            raise InputError(
                str(session.folder / entry.file),
                f"{entry.experiment} needs {' or '.join(group)}; found {', '.join(recording.names) or 'nothing'}",
                f"Map the header in session.yaml: channels: {{{group[0]}: HEADER}}",
            )
    answers = [name for name in EXPERIMENTS[entry.experiment].channels[-1] if name in recording]
    if not any(_changes(recording[name]) for name in answers):
        raise InputError(
            str(session.folder / entry.file),
            f"{' and '.join(answers)} {'does' if len(answers) == 1 else 'do'} not change from beginning to end",
            "Look whether the sensor was connected, or map another column by channels:",
        )
    wheels = None
    if entry.wheel_log:
        wheels = read_one(session.folder / entry.wheel_log, ReadOptions())
    clocks = tuple(note.text for note in recording.notes if entry.files and "its clock reads" in note.text)
    doubts = tuple(f"{Path(recording.provenance.file).name}: {note.text}" for note in recording.warnings)
    return Measurement(entry, recording, wheels, found=(*clocks, *doubts))


def _changes(samples: np.ndarray) -> bool:
    """Whether a channel holds anything; (n,) float. Below the least that is asked for its squares are nothing."""
    seen = samples[np.isfinite(samples)]
    return len(seen) > 1 and float(np.ptp(seen)) > LEAST


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


def _as_logged(entry: Entry, recording: Recording) -> Experiment:
    """A rig called forced of which the foot's motion was logged, and no force, stands on what moves it."""
    experiment = EXPERIMENTS[entry.experiment]
    forces = any(name in recording for name in ("force", "torque"))
    if experiment.driven and not forces and any(name in recording for name in BASES):
        return BASE_MOTION
    return experiment


def _of_several(session: Session, entry: Entry, accelerometer: Accelerometer) -> Recording:
    """One recording of the logs that an entry names by quantity."""
    owner = {quantity: log.file for quantity, log in entry.files.items()}
    read: dict[str, Recording] = {}
    delays: dict[str, float | None] = {}
    for log in {log.file: log for log in entry.files.values()}.values():
        own = {quantity: header for quantity, header in entry.channels.items() if owner.get(quantity) == log.file}
        recording = read_one(session.folder / log.file, read_options(log.over(entry), own))
        here = {
            quantity: header
            for quantity, header in entry.channels.items()
            if owner.get(quantity, log.file) == log.file
            and (quantity in owner or any(header in (c.label, c.name) for c in recording.channels))
        }
        recording = to_quantities(recording, replace(entry, file=log.file, channels=here), accelerometer)
        kept = [c for c in recording.channels if owner.get(c.name, log.file) == log.file]
        read[log.file], delays[log.file] = recording.with_channels(kept), log.delay_s
    for quantity, file in owner.items():
        if quantity not in read[file]:
            raise InputError(
                str(session.folder / file),
                f"has no {quantity}; found {', '.join(read[file].names) or 'nothing'}",
                f"Map its header: channels: {{{quantity}: HEADER}}",
            )
    one_of_each(read, owner)
    return merged([Log(recording, delays[file]) for file, recording in read.items()])


def _decays(measurement: Measurement, baseline: str) -> list[Measurement]:
    """A rig's free response from each release on; a robot's finds its own in the fit."""
    if baseline not in RIGS or not measurement.experiment.free:
        return [measurement]
    given = measurement.entry.release_s
    parts = parts_of(measurement.recording, given)
    if not parts:
        return [measurement]
    said = (*measurement.found, release_sentence(measurement.name, parts, bool(given)))
    several = len(parts) > 1
    return [
        replace(measurement, recording=p.recording, release_s=p.release_s if several else None, found=said)
        for p in parts
    ]


def read_options(entry: Reading, channels: Mapping[str, str]) -> ReadOptions:
    """What an entry tells the reader."""
    return ReadOptions(
        reader=entry.reader,
        fs=entry.sample_rate_hz,
        units=dict(entry.units),
        columns=dict(entry.columns),
        skip="auto" if entry.skip_rows is None else entry.skip_rows,
        sheets=dict(entry.sheets),
        channels=dict(channels),
        time_unit=entry.time_unit,
        on_bad=entry.on_bad,
        stamps=entry.stamps,
        trim=entry.trim,
        load_scale=entry.load_scale,
        sample=entry.sample,
        decimal=entry.decimal,
    )
