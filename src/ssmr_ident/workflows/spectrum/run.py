"""``ident spectrum``: logs in, table and figures out (thesis section 3.2, appendices A and B)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.frame import frame
from ssmr_ident.core.recording import Channel, Note, Recording
from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments.campaign import load
from ssmr_ident.readers import ReadOptions, read_one
from ssmr_ident.report.figures_speed import SpeedAverage
from ssmr_ident.signals.analysis import AnalysisOptions, analyse
from ssmr_ident.signals.filters import BAND_HALF_WIDTH_HZ, FREE_RESPONSE_LOW_PASS_HZ, SWIVEL_LOW_PASS_HZ
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.signals.peaks import BAND_HZ
from ssmr_ident.signals.spectra import FREE_RESPONSE_LENGTH, SWIVEL_LENGTH
from ssmr_ident.workflows.spectrum.table import (
    RATE_LABEL,
    RecordingLabel,
    SpectrumRow,
    average_row,
    average_swivels,
    label_of,
    label_of_file,
    speed_label,
)

if TYPE_CHECKING:
    import pandas as pd

ACCELEROMETERS = ("ax", "ay", "az")
VOLTS_ZERO = 2.6
VOLTS_PER_M_S2 = 5 / (3.4 * 9.8)
"""The thesis' sensor (section 1): a = 3.4·9.8/5·(V − 2.6) m/s²; for volts without a session only."""


@dataclass(frozen=True)
class SpectrumChoices:
    """What the caller chose; None leaves it to the experiment (thesis section 3.2).

    Parameters
    ----------
    part : str or None
        Free responses: ``beginning`` (2¹¹ samples); everything else: ``middle`` (2¹⁴).
    low_pass_hz : float or None [Hz]
        Free responses of the robot: 20; everything else, rigs too: 50.
    half_width_hz : float [Hz]
    band_hz : (float, float) [Hz]
        Where peaks are searched; a slow rig needs a lower edge below 1 Hz.
    """

    part: str | None = None
    low_pass_hz: float | None = None
    half_width_hz: float = BAND_HALF_WIDTH_HZ
    band_hz: tuple[float, float] = BAND_HZ

    def options(self, label: RecordingLabel) -> AnalysisOptions:
        free = label.experiment is not None and label.experiment.free
        # The 20 Hz are the robot's: its frame's free responses lie below 8 Hz. A rig's need not.
        usual_hz = FREE_RESPONSE_LOW_PASS_HZ if free and label.motion else SWIVEL_LOW_PASS_HZ
        return AnalysisOptions(
            part=self.part or ("beginning" if free else "middle"),
            length=FREE_RESPONSE_LENGTH if free else SWIVEL_LENGTH,
            low_pass_hz=usual_hz if self.low_pass_hz is None else self.low_pass_hz,
            half_width_hz=self.half_width_hz,
            band_hz=self.band_hz,
        )


@dataclass(frozen=True, eq=False)
class SpectrumReport(Shown):
    """Rows, their averages over repeated swivels, what was noticed, and the files written."""

    source: str
    rows: tuple[SpectrumRow, ...]
    averages: tuple[SpeedAverage, ...]
    notes: tuple[tuple[str, Note], ...]
    speed_label: str
    files: tuple[Path, ...] = ()

    @property
    def speed_key(self) -> str:
        return "yaw_rate_deg_s" if self.speed_label == RATE_LABEL else "wheel_speed_m_s"

    def average_rows(self) -> list[dict[str, Any]]:
        return [average_row(average, self.speed_key) for average in self.averages]

    def to_frame(self) -> pd.DataFrame:
        """A row a channel of a recording, as in the table that ``ident spectrum`` writes with NaN for nothing."""
        rows = [row.as_dict() for row in self.rows]
        return frame(rows, list(rows[0]) if rows else (), source=self.source)

    def __str__(self) -> str:
        lines = [f"spectra of {self.source}: {len(self.rows)} channels"]
        lines += [f"  {row.label.file} {row.channel}: {row.analysis}" for row in self.rows[:12]]
        if len(self.rows) > 12:
            lines.append(f"  and {len(self.rows) - 12} more")
        return "\n".join(lines)


def spectrum(
    paths: Sequence[str | Path],
    choices: SpectrumChoices | None = None,
    *,
    options: ReadOptions | None = None,
    progress: Callable[[str], None] | None = None,
) -> SpectrumReport:
    """Analyse a session, or one or more logs on their own.

    Parameters
    ----------
    paths : sequence of path
        A single session folder (or its session.yaml), or log files.
    choices : SpectrumChoices
    options : ReadOptions, optional
        How bare logs are read.
    progress : callable, optional
        Called with a line on each log before it is analysed.

    Raises
    ------
    InputError
        Names the log and channel.
    """
    choices = choices or SpectrumChoices()
    logs, notes = _logs([Path(path) for path in paths], options or ReadOptions())
    rows: list[SpectrumRow] = []
    for label, recording in logs:
        if progress:
            progress(f"analysing {label.file}")
        new_rows, new_notes = _rows(label, recording, choices.options(label))
        rows += new_rows
        notes += new_notes
    names = ", ".join(str(path) for path in paths)
    return SpectrumReport(names, tuple(rows), tuple(average_swivels(rows)), tuple(notes), speed_label(rows))


def _logs(
    paths: list[Path], options: ReadOptions
) -> tuple[list[tuple[RecordingLabel, Recording]], list[tuple[str, Note]]]:
    if any(path.is_dir() or path.suffix in (".yaml", ".yml") for path in paths):
        if len(paths) > 1:
            raise InputError(str(paths[0]), "is a session", "Give one session, or log files only.")
        if options != ReadOptions():
            raise InputError(
                "--reader, --sample, --fs, --units",
                "are for bare logs",
                "Say reader, sample, sample_rate_hz or units in session.yaml.",
            )
        campaign = load(paths[0])
        logs = [(label_of(m), m.recording) for m in campaign.measurements]
        return logs, [(m.name, note) for m in campaign.measurements for note in m.recording.warnings]
    logs, notes = [], []
    names = [path.name for path in paths]
    for path in paths:
        recording = read_one(path, options)
        label = label_of_file(path)
        if names.count(path.name) > 1:
            label = replace(label, file=str(path))
        converted, note = _volts_by_the_thesis(recording)
        notes += [(label.file, each) for each in (*recording.warnings, *([note] if note else []))]
        logs.append((label, converted))
    return logs, notes


def _volts_by_the_thesis(recording: Recording) -> tuple[Recording, Note | None]:
    channels: list[Channel] = []
    for channel in recording.channels:
        if channel.name in ACCELEROMETERS and channel.unit == "V":
            samples = (channel.samples - VOLTS_ZERO) / VOLTS_PER_M_S2
            channel = replace(channel, samples=samples, unit="m/s^2")
        channels.append(channel)
    if all(new is old for new, old in zip(channels, recording.channels, strict=True)):
        return recording, None
    note = Note("warning", "volts without a session: a = 3.4·9.8/5·(V − 2.6) m/s², the thesis' accelerometer")
    return recording.with_channels(channels, note), note


def _rows(
    label: RecordingLabel, recording: Recording, options: AnalysisOptions
) -> tuple[list[SpectrumRow], list[tuple[str, Note]]]:
    even = even_samples(recording.time, _matrix(label, recording))
    rows = []
    for channel, samples in zip(recording.channels, even.samples.T, strict=True):
        try:
            analysis = analyse(samples, even.sample_rate, options, start=even.start)
        except InputError as error:
            raise InputError(f"{label.file}: {channel.name}: {error.where}", error.problem, error.mend) from None
        rows.append(SpectrumRow(label, channel.name, channel.unit, analysis))
    notes = [*even.notes]
    slow = [row.channel for row in rows if row.analysis.slower_line_hz is not None]
    if slow:
        text = f"a line below the searched {options.band_hz[0]:g} Hz is higher than every peak: {', '.join(slow)}"
        notes.append(Note("info", text + "; slow motion or drift, see --band"))
    return rows, [(label.file, note) for note in notes]


def _matrix(label: RecordingLabel, recording: Recording) -> np.ndarray:
    if not recording.channels:
        raise InputError(label.file, "no channel", "Name its columns, or choose another reader.")
    return np.stack([channel.samples for channel in recording.channels], axis=1)
