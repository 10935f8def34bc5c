"""A recording: channels over one time axis, and the account of how they were read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ssmr_ident.core.shown import Shown, html_table

ENDS = 0.999
"""Share of a sensor's range from which samples count as at its end."""


@dataclass(frozen=True)
class Note(Shown):
    """Something the reader noticed: a conversion, a skipped part, a doubt.

    ``level`` is ``info`` for what was done as expected and ``warning`` for what the user should look at.
    ``where`` is the place in the file (sheet, row, line), or empty for the whole file.
    """

    level: str
    text: str
    where: str = ""

    def __str__(self) -> str:
        place = f" [{self.where}]" if self.where else ""
        return f"{self.level}: {self.text}{place}"


@dataclass(frozen=True)
class Provenance:
    """Where a recording came from: file, its SHA-256, reader, and the part of the file (sheets, rows)."""

    file: str
    sha256: str
    reader: str
    part: str = ""


@dataclass(frozen=True)
class Channel:
    """One measured quantity.

    Parameters
    ----------
    name : str
        The quantity in this package's words: time-independent names such as ``ax``, ``force``, ``position``;
        for a quantity that could not be recognised, the file's own header.
    samples : (n,) float
        In ``unit``.
    unit : str
        SI (``N``, ``m``, ``m/s^2``, ``rad``, ``rad/s``), or ``V`` while a sensor's volts await its calibration.
    label : str
        The header as the file has it.
    rails : (float, float)
        Values, in ``unit``, at which whatever logged it came to its end: a sample at one of them says only that there
        was as much or more.
    """

    name: str
    samples: np.ndarray
    unit: str
    label: str = ""
    rails: tuple[float, float] = (-np.inf, np.inf)

    def shows(self, limit: float) -> tuple[float, float]:
        """Between which values samples say what there was, of a sensor that ends at ± ``limit``, in ``unit``."""
        return max(self.rails[0], -ENDS * limit), min(self.rails[1], ENDS * limit)


@dataclass(frozen=True)
class Recording(Shown):
    """Channels on one time axis.

    Parameters
    ----------
    time : (n,) float [s]
        Increasing; starts where the file starts.
    channels : tuple of Channel
        Each with n samples.
    provenance : Provenance
    notes : tuple of Note
    header : dict
        Facts from the file's header that are no channel (operator, date, sample name), as text.
    """

    time: np.ndarray
    channels: tuple[Channel, ...]
    provenance: Provenance
    notes: tuple[Note, ...] = ()
    header: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for channel in self.channels:
            if channel.samples.shape != self.time.shape:
                raise ValueError(
                    f"{self.provenance.file}: channel {channel.name!r} has shape {channel.samples.shape}, "
                    f"time has {self.time.shape}"
                )

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(channel.name for channel in self.channels)

    def __contains__(self, name: str) -> bool:
        return name in self.names

    def __getitem__(self, name: str) -> np.ndarray:
        """Samples of a channel, (n,) float."""
        return self.channel(name).samples

    def channel(self, name: str) -> Channel:
        for channel in self.channels:
            if channel.name == name:
                return channel
        raise KeyError(f"{self.provenance.file} has no channel {name!r}; it has {', '.join(self.names)}")

    @property
    def sample_rate(self) -> float:
        """Samples per second from first and last time [Hz]; robust against rounded time stamps."""
        if len(self.time) < 2:
            raise ValueError(f"{self.provenance.file}: one sample has no rate")
        return (len(self.time) - 1) / float(self.time[-1] - self.time[0])

    @property
    def duration(self) -> float:
        """Last minus first time [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def warnings(self) -> tuple[Note, ...]:
        return tuple(note for note in self.notes if note.level == "warning")

    def with_channels(self, channels: Sequence[Channel], *notes: Note) -> Recording:
        """The same recording with other channels and further notes."""
        return replace(self, channels=tuple(channels), notes=self.notes + notes)

    def _repr_html_(self) -> str:
        rows = [
            (c.name, c.label, c.unit, f"{np.nanmin(c.samples):.5g}", f"{np.nanmax(c.samples):.5g}")
            for c in self.channels
            if len(c.samples)
        ]
        rate = f", {self.sample_rate:.6g} Hz" if len(self.time) > 1 else ""
        title = f"{self.provenance.file} ({self.provenance.reader}): {len(self.time)} samples{rate}"
        return html_table(("channel", "header", "unit", "min", "max"), rows, title, map(str, self.notes))

    def __str__(self) -> str:
        rate = f"{self.sample_rate:.6g} Hz" if len(self.time) > 1 else "no rate"
        lines = [f"{self.provenance.file} ({self.provenance.reader}): {len(self.time)} samples, {rate}"]
        lines += [
            f"  {c.name:<14} {c.unit:<6} {np.nanmin(c.samples):>12.5g} … {np.nanmax(c.samples):.5g}"
            for c in self.channels
            if len(c.samples)
        ]
        return "\n".join(lines + [f"  {note}" for note in self.notes])
