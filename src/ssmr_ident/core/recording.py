"""A recording: channels over one time axis, and the account of how they were read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown, html_table

if TYPE_CHECKING:
    import pandas as pd

ENDS = 0.999
"""Share of a sensor's range from which samples count as at its end."""
_GAP = 1.5  # typical steps from which on a step lost at least half a sample
_RARE = 0.01
"""Choice: share of steps up to which long ones are gaps in an even clock; more are the clock's way."""


def rate_of(time: np.ndarray) -> float:
    """Samples per second of a clock, from first and last time, as rounded stamps do not spoil it [Hz].

    Samples lost in a few gaps are counted in: a logger of 200 Hz that drops a sample is one of 200 Hz.

    Parameters
    ----------
    time : (n,) float [s]
        Increasing.

    >>> rate_of(np.delete(np.arange(200.0), [77, 78]) / 200.0)
    200.0
    """
    count, duration = len(time) - 1, float(time[-1] - time[0])
    steps = np.diff(time)
    wide = steps[steps > _GAP * np.median(steps[:: max(1, count // 10_000)])]
    if 0 < len(wide) <= _RARE * count:
        single = (duration - float(wide.sum())) / (count - len(wide))
        count += int(np.rint(wide / single).sum()) - len(wide)
    return count / duration


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
class Series(Shown):
    """Samples on the clock that took them.

    Parameters
    ----------
    time : (n,) float [s]
        Increasing, of the same zero as the recording's.
    samples : (n,) float
    """

    time: np.ndarray
    samples: np.ndarray

    @property
    def rate(self) -> float:
        """Samples per second, lost ones counted [Hz]."""
        return rate_of(self.time)

    def at(self, time: np.ndarray) -> np.ndarray:
        """Samples at other times, (m,) float: as logged where a stamp is met, a cubic spline between even stamps, a
        straight line between uneven ones; NaN outside and beside a sample that is none.

        Parameters
        ----------
        time : (m,) float [s]
        """
        from scipy.interpolate import CubicSpline  # half a second that a log with one clock need not wait

        steps = np.diff(self.time)
        typical = float(np.median(steps))
        missing = ~np.isfinite(self.samples)
        even = len(steps) > 3 and not missing.any() and float(np.abs(steps - typical).max()) < 0.1 * typical
        values = CubicSpline(self.time, self.samples)(time) if even else np.interp(time, self.time, self.samples)
        near = np.clip(np.searchsorted(self.time, time - 1e-3 * typical), 0, len(self.time) - 1)
        met = np.abs(self.time[near] - time) <= 1e-3 * typical
        values = np.where(met, self.samples[near], values)
        inside = (time >= self.time[0] - 1e-3 * typical) & (time <= self.time[-1] + 1e-3 * typical)
        return np.where(inside, values, np.nan)

    def __str__(self) -> str:
        return f"{len(self.time)} samples from {self.time[0]:.6g} to {self.time[-1]:.6g} s, {self.rate:.6g} Hz"


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
    logged : Series or None
        What was logged, in ``unit``, where the channel has a clock of its own: then ``samples`` are that at the
        recording's times.
    """

    name: str
    samples: np.ndarray
    unit: str
    label: str = ""
    rails: tuple[float, float] = (-np.inf, np.inf)
    logged: Series | None = None

    def scaled(self, scale: Callable[[np.ndarray], np.ndarray], unit: str) -> Channel:
        """The channel in another unit.

        Parameters
        ----------
        scale : function of (n,) float to (n,) float
        unit : str
        """
        own = None if self.logged is None else Series(self.logged.time, scale(self.logged.samples))
        return replace(self, samples=scale(self.samples), unit=unit, logged=own)

    def shows(self, limit: float) -> tuple[float, float]:
        """Between which values samples say what there was, of a sensor that ends at ± ``limit``, in ``unit``."""
        return max(self.rails[0], -ENDS * limit), min(self.rails[1], ENDS * limit)


@dataclass(frozen=True)
class Recording(Shown):
    """Channels on one time axis.

    Where channels have clocks of their own, the axis is the one of the channel with most samples, over what all cover;
    ``series`` has each as it was logged, ``on_clock_of`` puts all on the clock of another.

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

    def series(self, name: str) -> Series:
        """A channel as it was logged, on its own clock."""
        channel = self.channel(name)
        return channel.logged or Series(self.time, channel.samples)

    @property
    def clocks_differ(self) -> bool:
        """True when a channel has a clock of its own."""
        return any(channel.logged is not None for channel in self.channels)

    def on_clock_of(self, name: str, among: Sequence[str] = ()) -> Recording:
        """The recording at the times of one channel, over what all cover.

        Parameters
        ----------
        name : str
            Its samples stay as logged; others are taken between theirs (``Series.at``).
        among : sequence of str
            Only these channels and ``name`` count for what is covered, and only they are kept; all when empty.
        """
        kept = [c for c in self.channels if not among or c.name == name or c.name in among]
        time = self.series(name).time
        logged = [self.series(c.name) for c in kept]
        half = 1e-3 * float(np.median(np.diff(time))) if len(time) > 1 else 0.0
        begin, end = max(s.time[0] for s in logged) - half, min(s.time[-1] for s in logged) + half
        time = time[(time >= begin) & (time <= end)]
        if len(time) < 2:
            raise InputError(
                self.provenance.file,
                f"channels {', '.join(c.name for c in kept)} have no time in common",
                "Leave one out with --columns, or give logs of one event.",
            )
        # a channel on the very clock of the axis needs no second copy of itself
        same = [len(s.time) == len(time) and np.array_equal(s.time, time) for s in logged]
        channels = tuple(
            replace(c, samples=s.samples, logged=None) if m else replace(c, samples=s.at(time), logged=s)
            for c, s, m in zip(kept, logged, same, strict=True)
        )
        return replace(self, time=time, channels=channels)

    def on_even_grid(self, most: float = 0.01) -> Recording:
        """The recording with lost samples taken between their neighbours, where few are lost and the rest is even.

        Parameters
        ----------
        most : float
            Share of lost samples from which on nothing is filled.
        """
        steps = np.diff(self.time)
        typical = float(np.median(steps)) if len(steps) else 0.0
        counts = np.round(steps / typical) if typical > 0 else steps
        lost = int(counts.sum() - len(counts))
        uneven = np.abs(steps - counts * typical) > 0.1 * typical
        if not 0 < lost <= most * len(self.time) or bool(uneven.any()):
            return self
        index = np.r_[0, np.cumsum(counts)].astype(int)
        time = np.interp(np.arange(index[-1] + 1), index, self.time)
        channels = [replace(c, samples=Series(self.time, c.samples).at(time), logged=None) for c in self.channels]
        first = self.time[np.flatnonzero(counts > 1)[0]]
        text = f"{lost} sample(s) missing, the first after t = {first:.6g} s: taken between their neighbours"
        return replace(self, time=time, channels=tuple(channels), notes=(*self.notes, Note("warning", text)))

    @property
    def sample_rate(self) -> float:
        """Samples per second, lost ones counted [Hz]; robust against rounded time stamps."""
        if len(self.time) < 2:
            raise ValueError(f"{self.provenance.file}: one sample has no rate")
        return rate_of(self.time)

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

    def to_frame(self) -> pd.DataFrame:
        """A column a channel over ``time_s``; their units are in ``attrs["units"]``, the file in ``attrs["file"]``."""
        import pandas as pd  # half a second, which who asks for no frame need not wait

        made = pd.DataFrame({c.name: c.samples for c in self.channels}, index=pd.Index(self.time, name="time_s"))
        made.attrs.update(units={c.name: c.unit for c in self.channels}, file=self.provenance.file)
        return made

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
