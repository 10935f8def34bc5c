"""Rows of ``ident spectrum``: one per recording and channel, and their averages over repeats."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.atomic import make_folder, write_text
from ssmr_ident.experiments import SWIVEL, Experiment
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.report.figures_speed import SpeedAverage, mean_and_spread
from ssmr_ident.signals.analysis import ChannelAnalysis
from ssmr_ident.signals.peaks import COUNT

_THESIS_NAME = re.compile(r"v0-w(?P<rate>-?\d+(?:\.\d+)?)-t20-(?P<configuration>.+)\.\w+$")
_FLOORS = ("carpet", "concrete", "tiles", "tile", "wood")
RATE_LABEL = r"yaw rate $|\omega_z^*|$ [deg/s]"
WHEEL_LABEL = "wheel speed [m/s]"
SAME_SPEED = 0.1
"""Choice: a tenth, so that a speed set-point met to a few per cent stays one speed."""


@dataclass(frozen=True)
class RecordingLabel:
    """What the table says of a recording beside its numbers; nothing is computed from it."""

    file: str
    experiment: Experiment | None = None
    motion: str = ""
    floor: str = ""
    frame: str = ""
    role: str = ""
    yaw_rate_deg_s: float = math.nan
    wheel_speed_m_s: float = math.nan

    @property
    def turns(self) -> bool:
        """Whether the robot turned on the spot."""
        return self.experiment is not None and self.experiment.turns

    @property
    def made(self) -> tuple[str, ...]:
        """What was done and where, as printed."""
        words = (self.experiment.words if self.experiment else "", self.motion, self.floor, self.frame)
        return tuple(word for word in words if word)

    @property
    def configuration(self) -> str:
        """Floor and frame, as printed."""
        return ", ".join(word for word in (self.floor, self.frame) if word) or "all swivels"


def label_of(measurement: Measurement) -> RecordingLabel:
    """From session.yaml."""
    entry = measurement.entry
    return RecordingLabel(
        file=measurement.name,
        experiment=measurement.experiment,
        motion=entry.motion or "",
        floor=entry.floor or "",
        frame=entry.frame or "",
        role=entry.role,
        yaw_rate_deg_s=math.nan if entry.yaw_rate_deg_s is None else float(entry.yaw_rate_deg_s),
        wheel_speed_m_s=math.nan if entry.wheel_speed_m_s is None else float(entry.wheel_speed_m_s),
    )


def label_of_file(path: Path) -> RecordingLabel:
    """From the thesis' pattern of file names, for a log without a session.

    >>> label = label_of_file(Path("v0-w30-t20-frame-concrete.xlsx"))
    >>> label.yaw_rate_deg_s, label.floor, label.frame
    (30.0, 'concrete', 'frame')
    """
    match = _THESIS_NAME.match(path.name)
    if not match:
        return RecordingLabel(path.name)
    words = match["configuration"].split("-")
    floor = [word for word in words if word.lower() in _FLOORS]
    rest = [word for word in words if word not in floor]
    return RecordingLabel(
        path.name,
        experiment=SWIVEL,
        floor=" ".join(floor),
        frame=" ".join(rest),
        yaw_rate_deg_s=float(match["rate"]),
    )


@dataclass(frozen=True, eq=False)
class SpectrumRow:
    """One channel of one recording."""

    label: RecordingLabel
    channel: str
    unit: str
    analysis: ChannelAnalysis

    def as_dict(self) -> dict[str, Any]:
        """Flat, with units in the keys where they are always the same; None for what is not known."""
        analysis, label = self.analysis, self.label
        row: dict[str, Any] = {
            "file": label.file,
            "experiment": label.experiment.name if label.experiment else "",
            "motion": label.motion,
            "floor": label.floor,
            "frame": label.frame,
            "role": label.role,
            "yaw_rate_deg_s": _known(label.yaw_rate_deg_s),
            "wheel_speed_m_s": _known(label.wheel_speed_m_s),
            "channel": self.channel,
            "unit": self.unit,
            "sample_rate_hz": analysis.sample_rate,
            "range": analysis.part.name,
            "first_sample": analysis.part.first,
            "samples": analysis.part.count,
            "resolution_hz": analysis.spectrum.resolution,
            "low_pass_hz": analysis.options.low_pass_hz,
        }
        lines = analysis.lines
        for rank in range(COUNT):
            there = rank < len(lines)
            row[f"peak_{rank + 1}_hz"] = float(lines.frequency[rank]) if there else None
            row[f"peak_{rank + 1}_hz_std"] = float(lines.frequency_std[rank]) if there else None
            row[f"peak_{rank + 1}_width_hz"] = float(lines.width[rank]) if there else None
            row[f"peak_{rank + 1}_amplitude"] = float(lines.amplitude[rank]) if there else None
        row["amplitude"] = analysis.amplitude
        row["mean"] = float(np.mean(analysis.samples[analysis.part.indices]))
        row["mains_60_hz_amplitude"] = None if analysis.mains is None else analysis.mains.amplitude
        row["mains_60_hz_std"] = None if analysis.mains is None else analysis.mains.amplitude_std
        return row


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _padded(analysis: ChannelAnalysis) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and heights of exactly three peaks, NaN where there are fewer."""
    missing = np.full(COUNT - len(analysis.lines), np.nan)
    return np.r_[analysis.lines.frequency, missing], np.r_[analysis.lines.amplitude, missing]


def write_rows(path: Path, rows: Iterable[dict[str, Any]]) -> Path:
    """A CSV file; empty cells for what is not known, numbers to the last bit."""
    rows = list(rows)
    make_folder(path.parent)
    stream = io.StringIO(newline="")
    writer = csv.DictWriter(stream, list(rows[0]))
    writer.writeheader()
    writer.writerows(rows)
    return write_text(path, stream.getvalue())


def speed_label(rows: Sequence[SpectrumRow]) -> str:
    """The axis that all swivels share: yaw rate, or else wheel speed; empty when neither is known of all."""
    swivels = [row.label for row in rows if row.label.turns]
    if swivels and all(math.isfinite(label.yaw_rate_deg_s) for label in swivels):
        return RATE_LABEL
    if swivels and all(math.isfinite(label.wheel_speed_m_s) for label in swivels):
        return WHEEL_LABEL
    return ""


def average_swivels(rows: Sequence[SpectrumRow]) -> list[SpeedAverage]:
    """Repeats of a configuration, speed and channel together; turning left and right count as the same speed.

    Yaw rates are commanded, so repeats have the same; wheel speeds are measured, and those within
    ``SAME_SPEED`` of the slowest of a group count as repeats of it. Accelerations only. Empty when the swivels
    share no speed axis.
    """
    axis = speed_label(rows)
    groups: dict[tuple[str, str], list[tuple[float, SpectrumRow]]] = {}
    for row in rows:
        if axis and row.label.turns and row.unit == "m/s^2":
            speed = row.label.yaw_rate_deg_s if axis == RATE_LABEL else row.label.wheel_speed_m_s
            groups.setdefault((row.label.configuration, row.channel), []).append((abs(speed), row))
    tolerance = 0.0 if axis == RATE_LABEL else SAME_SPEED
    return [
        _average(*key, members)
        for key, own in sorted(groups.items(), key=lambda item: item[0])
        for members in _same_speed(own, tolerance)
    ]


def _same_speed(members: list[tuple[float, SpectrumRow]], tolerance: float) -> list[list[tuple[float, SpectrumRow]]]:
    groups: list[list[tuple[float, SpectrumRow]]] = []
    for speed, row in sorted(members, key=lambda member: member[0]):
        if groups and speed <= groups[-1][0][0] * (1 + tolerance):
            groups[-1].append((speed, row))
        else:
            groups.append([(speed, row)])
    return groups


def _average(configuration: str, channel: str, members: list[tuple[float, SpectrumRow]]) -> SpeedAverage:
    padded = [_padded(row.analysis) for _, row in members]
    return SpeedAverage(
        configuration,
        channel,
        members[0][1].unit,
        float(np.mean([speed for speed, _ in members])),
        peak_hz=np.array([frequency for frequency, _ in padded]),
        peak_amplitude=np.array([amplitude for _, amplitude in padded]),
        amplitude=np.array([row.analysis.amplitude for _, row in members]),
    )


def average_row(average: SpeedAverage, speed_key: str) -> dict[str, Any]:
    """Flat row of an average: means and standard deviations (n − 1) over the repeats."""
    row: dict[str, Any] = {
        "configuration": average.configuration,
        "channel": average.channel,
        "unit": average.unit,
        speed_key: average.speed,
        "repeats": average.repeats,
    }
    for rank in range(COUNT):
        for key, values in (("hz", average.peak_hz), ("amplitude", average.peak_amplitude)):
            mean, spread = mean_and_spread(values[:, rank])
            row[f"peak_{rank + 1}_{key}_mean"], row[f"peak_{rank + 1}_{key}_std"] = _known(mean), _known(spread)
    mean, spread = mean_and_spread(average.amplitude)
    row["amplitude_mean"], row["amplitude_std"] = _known(mean), _known(spread)
    return row
