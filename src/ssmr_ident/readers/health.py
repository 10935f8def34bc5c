"""What a recording's numbers say about the recording: rate, jitter, repeats, clipping. Nothing is changed here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.recording import Channel, Note, Recording, Series
from ssmr_ident.core.shown import Shown

# The thesis' accelerometer: 2.6 V at rest and 5/(3.4*9.8) V per m/s^2, so that +-1.7 g is 0.1 to 5.1 V; its supply
# ends at 5 V. A session's robot.yaml may say otherwise; these rails raise a warning, and the supply's end is one for
# whatever reads its volts.
VOLTS_LOW, VOLTS_HIGH = 0.1, 5.0
RAIL_TOLERANCE = 1.25e-3  # V: the last code of a 12-bit card over 5 V stands 1.22 mV below them
COARSEST = 0.02  # V, the step of an 8-bit card; values of a log that are farther apart tell no step
_SATURATED = 50  # equal samples at the largest value, see ``saturated``
_RUN = 3  # equal samples in a row, see ``cut_off``
_PLACES = 3  # where they stand
_RESTS = 0.3
"""Choice: share of samples within the range that equal the one before, up to which a channel does not rest."""
_AMPLIFIED = ("N", "N m", "m/s^2", "Pa", "V")
AXES = ("ax", "ay", "az")


@dataclass(frozen=True)
class ChannelHealth:
    """One channel's numbers, in its unit.

    Parameters
    ----------
    minimum, maximum, mean, std : float
    missing : int
        Samples that are no number.
    repeated : float
        Share of samples that equal the one before: 0 for a noisy signal, high for a slow clock or coarse steps.
    clipped : int
        Samples at the rails of the accelerometer (axes in volts), or at a value that the channel does not leave.
    samples : int
        As logged, on the channel's own clock.
    rate_hz, start_s, last_time_s : float
        Of that clock.
    """

    name: str
    label: str
    unit: str
    minimum: float
    maximum: float
    mean: float
    std: float
    missing: int
    repeated: float
    clipped: int
    samples: int = 0
    rate_hz: float = 0.0
    start_s: float = 0.0
    last_time_s: float = 0.0


@dataclass(frozen=True)
class LogHealth(Shown):
    """The time axis and the channels of a recording; of channels with clocks of their own, the fastest clock.

    Parameters
    ----------
    sample_rate : float [Hz]
        From first and last time, lost samples counted.
    jitter : float [s]
        Largest distance of a stamp from the even grid; rounding of printed stamps counts as well.
    gaps : int
        Steps of more than 1.5 times the median one.
    """

    samples: int
    duration: float
    sample_rate: float
    jitter: float
    gaps: int
    channels: tuple[ChannelHealth, ...]

    def __str__(self) -> str:
        lines = [
            f"{self.samples} samples, {self.duration:.6g} s, {self.sample_rate:.6g} Hz, "
            f"jitter {self.jitter:.2g} s, {self.gaps} gaps"
        ]
        lines += [
            f"  {c.name:<14} {c.minimum:.6g} … {c.maximum:.6g} {c.unit}, mean {c.mean:.6g}, {c.clipped} clipped, "
            f"{c.missing} missing, {100 * c.repeated:.0f} % repeated"
            for c in self.channels
        ]
        return "\n".join(lines)


def health_of(recording: Recording) -> LogHealth:
    """Look over a recording.

    Parameters
    ----------
    recording : Recording
    """
    longest = max(recording.names, key=lambda name: len(recording.series(name).time))
    time = recording.series(longest).time
    grid = np.linspace(time[0], time[-1], len(time))
    steps = np.diff(time)
    gaps = int((steps > 1.5 * np.median(steps)).sum())
    return LogHealth(
        len(time),
        float(time[-1] - time[0]),
        recording.series(longest).rate,
        float(np.abs(time - grid).max()),
        gaps,
        tuple(_channel_health(channel, recording.series(channel.name)) for channel in recording.channels),
    )


def _channel_health(channel: Channel, logged: Series) -> ChannelHealth:
    finite = logged.samples[np.isfinite(logged.samples)]
    repeated = float(np.mean(np.diff(finite) == 0)) if len(finite) > 1 else 0.0
    return ChannelHealth(
        channel.name,
        channel.label,
        channel.unit,
        float(finite.min(initial=np.inf)),
        float(finite.max(initial=-np.inf)),
        float(finite.mean()) if len(finite) else float("nan"),
        float(finite.std()) if len(finite) else float("nan"),
        len(logged.samples) - len(finite),
        repeated,
        at_rails(channel) or saturated(logged.samples) or int(cut_off(logged.samples).sum()),
        len(logged.samples),
        logged.rate,
        float(logged.time[0]),
        float(logged.time[-1]),
    )


def at_rails(channel: Channel) -> int:
    """Samples of an accelerometer axis in volts that stand at its rails."""
    if channel.unit != "V" or channel.name not in AXES:
        return 0
    samples = channel.samples[np.isfinite(channel.samples)]
    within = _tolerance(samples)
    low = samples <= VOLTS_LOW + within
    high = samples >= VOLTS_HIGH - within
    return int(low.sum() + high.sum())


def ends_of_supply(volts: np.ndarray) -> tuple[float, float]:
    """Volts at which samples of an accelerometer are at the end of its supply; infinite for one that goes beyond it,
    which has another supply.

    Parameters
    ----------
    volts : (n,) float [V]
        Gaps are NaN.
    """
    if np.any(volts < 0.0) or np.any(volts > VOLTS_HIGH):
        return -np.inf, np.inf
    within = _tolerance(volts)
    return within, VOLTS_HIGH - within


def _tolerance(volts: np.ndarray) -> float:
    """How far from an end a converter's last code may stand: its step, as the log's own values tell it [V]."""
    steps = np.diff(np.unique(volts[np.isfinite(volts)]))
    step = float(steps.min(initial=np.inf))
    return max(RAIL_TOLERANCE, 1.02 * step) if step <= COARSEST else RAIL_TOLERANCE


def saturated(samples: np.ndarray) -> int:
    """Length of the longest run of equal samples at the value farthest from zero, when it is 50 or more.

    An amplifier that has come to its end gives the same largest number again and again. A channel that never
    leaves one value is not counted here.
    """
    finite = samples
    if len(finite) and not np.isfinite(finite.max() - finite.min()):  # copy a long channel only when it must be
        finite = samples[np.isfinite(samples)]
    if len(finite) < _SATURATED:
        return 0
    high, low = float(finite.max()), float(finite.min())
    if high == low:
        return 0
    extreme = high if abs(high) >= abs(low) else low
    if extreme == 0:
        return 0
    at = finite == extreme
    if np.count_nonzero(at) < _SATURATED:
        return 0
    edges = np.flatnonzero(np.diff(np.r_[False, at, False]))
    longest = int((edges[1::2] - edges[::2]).max())
    return longest if longest >= _SATURATED else 0


def cut_off(samples: np.ndarray) -> np.ndarray:
    """Samples that stand, three and more in a row, at the largest or the smallest value of a channel that elsewhere
    moves: a signal that goes beyond its range again and again.

    A converter's coarse steps make flat tops as well, but from those the signal falls by one step; from a range that
    is exceeded it falls at the slope it came with.

    Parameters
    ----------
    samples : (n,) float

    Returns
    -------
    (n,) bool
    """
    cut = np.zeros(len(samples), dtype=bool)
    if len(samples) < _SATURATED:
        return cut
    given, high, low = samples, float(samples.max()), float(samples.min())
    if not np.isfinite(high - low):  # copy a long channel only when it must be
        given = np.where(np.isfinite(samples), samples, np.nan)
        finite = given[np.isfinite(given)]
        high, low = float(finite.max(initial=-np.inf)), float(finite.min(initial=np.inf))
    if np.count_nonzero(given == high) < _RUN * _PLACES and np.count_nonzero(given == low) < _RUN * _PLACES:
        return cut
    falls: list[float] = []
    places, inside = 0, np.isfinite(given)
    for extreme in (high, low):
        at = given == extreme
        edges = np.flatnonzero(np.diff(np.r_[False, at, False]))
        begins, ends = edges[::2], edges[1::2]
        long = ends - begins >= _RUN
        places += int(long.sum())
        for begin, end in zip(begins[long], ends[long], strict=True):
            cut[begin:end] = True
            falls += [
                abs(extreme - given[k]) for k in (begin - 1, end) if 0 <= k < len(given) and np.isfinite(given[k])
            ]
        inside &= ~at
    resting = np.mean(np.diff(given[inside]) == 0) if inside.sum() > 1 else 1.0
    step = float(np.diff(np.unique(given[np.isfinite(given)])).min(initial=np.inf))
    if places < _PLACES or not falls or resting > _RESTS or high == low or np.median(falls) <= _RUN * step:
        return np.zeros(len(samples), dtype=bool)
    return cut


def warnings_of(channels: tuple[Channel, ...]) -> list[Note]:
    """Warnings about channels that are clipped, saturated, or stand still.

    Parameters
    ----------
    channels : tuple of Channel
    """
    notes = []
    for channel in channels:
        name = channel.label if channel.label and channel.label != channel.name else channel.name
        rails = at_rails(channel)
        # a carriage may well stand still and a speed be held; an amplifier's signal does not
        flat = 0 if rails or channel.unit not in _AMPLIFIED else saturated(channel.samples)
        if rails:
            notes.append(
                Note("warning", f"{name} clipped: {rails} sample(s) at the rails, ±1.7 g exceeded", channel.name)
            )
        elif not flat and channel.unit in _AMPLIFIED and (cut := int(cut_off(channel.samples).sum())):
            low, high = float(np.nanmin(channel.samples)), float(np.nanmax(channel.samples))
            text = (
                f"{name} is cut off: {cut} samples stand at its ends ({low:.4g}, {high:.4g} {channel.unit}); clipped?"
            )
            notes.append(Note("warning", text, channel.name))
        elif flat:
            notes.append(
                Note("warning", f"{name} stands at its largest value for {flat} samples: saturated?", channel.name)
            )
        if not channel.unit:
            continue  # a flag or a code may well stand still
        first = channel.samples[0] if len(channel.samples) >= _SATURATED else np.nan
        if first == channel.samples[-1] and bool((channel.samples == first).all()):
            text = "zero throughout" if first == 0 else "one value throughout"
            notes.append(Note("warning", f"{name} is {text}: not connected?", channel.name))
    return notes
