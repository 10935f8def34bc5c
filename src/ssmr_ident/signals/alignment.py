"""Two logs of one event, each on a clock of its own: by how much the clocks differ, from what both feel.

A correlation of a force with an acceleration has no peak at the shift: what lies between them, a mass on a spring,
delays every frequency by another time. So candidates come from correlations, raw and of whitened records, and each is
judged by how much of the second record a linear response to the first explains; the best is refined together with that
response, shift and drift at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_ident.signals.common_response import (
    ONE_MODE,
    STRUCTURES,
    TWO_MODES,
    Array,
    Pair,
    Response,
    Structure,
    alone_of,
    error_level,
    fitted_response,
    with_clock,
)
from ssmr_ident.signals.grid import even_samples

BAND = 0.4
"""Share of the slower rate up to which records are compared: what lies above may be folded."""

LOW_PASSED = 2.5
"""Ratio of the rates from which the faster record is low-passed at the slower one's half rate; below, none is."""

LEAST_SHARED = 0.3
"""Choice: share of the shorter record that both must cover for a shift to be tried."""

DRIFT_STD = 2e-4
"""What clocks of loggers differ by: crystals by 20 to 100 parts in a million (their data sheets), timed loops by more.
Records of half a minute tell it better than this."""

CANDIDATES = 6
"""Peaks of each correlation that are looked at."""

AROUND, FINENESS = 2.0, 10.0
"""Choice: periods of the middle frequency that a correlation's peak may be off, and steps of the search in a period."""

SEARCHED = 2.5
"""Times the middle frequency up to which a search compares: a quarter of a period there is a step of the search."""

MOST_BINS = 4000
"""Choice: enough for a shift to a hundredth of a period, and a bound to the time that long and fast records take."""

MOST_UNKNOWNS = 40
"""Bins that even a search needs to fit a response by."""

CERTAIN = 12.0
"""Gain of the log-likelihood over what it has without the other record, beyond the look at other shifts: 1 in 10^5."""

NEARLY_ALL = 0.9
"""Choice: share that one mode explains from which a search with two is spared."""

HARDLY_MORE = 4.0
"""Choice: misfit over that of the richest structure up to which a simpler one is kept: twice the amplitude. A mode that
takes off less hardly moves the shift, and one that is fitted to noise moves it by milliseconds."""

LEVEL_ROUNDS = 3
"""Fits by the errors that the last one left: the first one's are those of a response that the loudest bins ruled."""

SPARE = 16
"""Samples at both ends of the faster record that its low-pass has not settled in."""

FEWEST = 64
"""Samples that both must have in common."""


@dataclass(frozen=True)
class Clocked:
    """One channel on its own clock.

    Parameters
    ----------
    name : str
        For messages.
    time : (n,) float [s]
    samples : (n,) float
    """

    name: str
    time: Array
    samples: Array


@dataclass(frozen=True)
class Alignment(Shown):
    """The second clock reads t + shift + drift·(t − start) when the first reads t.

    Parameters
    ----------
    shift_s, shift_std_s : float [s]
        At ``start_s``.
    drift_ppm, drift_std_ppm : float [1e-6]
        By how much the second clock runs faster.
    start_s, end_s : float [s]
        What both records cover, on the first clock.
    explained : float
        Share of the second record that a linear response to the first explains beyond its own transients.
    band_hz : (float, float)
        Compared.
    """

    shift_s: float
    shift_std_s: float
    drift_ppm: float
    drift_std_ppm: float
    start_s: float
    end_s: float
    explained: float
    band_hz: tuple[float, float]

    def to_first(self, time: Array) -> Array:
        """Stamps of the second clock as the first would have read them, (n,) float [s]."""
        drift = 1e-6 * self.drift_ppm
        return self.start_s + (np.asarray(time, float) - self.start_s - self.shift_s) / (1.0 + drift)

    def __str__(self) -> str:
        return (
            f"shift {self.shift_s:.4f} ± {self.shift_std_s:.2g} s, drift {self.drift_ppm:.0f} ± "
            f"{self.drift_std_ppm:.2g} ppm; both cover {self.start_s:.4g} to {self.end_s:.4g} s, "
            f"{100 * self.explained:.3g} % explained between {self.band_hz[0]:.2g} and {self.band_hz[1]:.3g} Hz"
        )


def align(first: Clocked, second: Clocked) -> Alignment:
    """Shift and drift of the second clock against the first.

    Parameters
    ----------
    first : Clocked
        What drives, where that is known: a force, a base.
    second : Clocked
        What answers.

    Raises
    ------
    InputError
        Too few samples, or nothing that both feel; the message says what was looked for.
    """
    pair = _Pair.of(first, second)
    if pair.shifts[0] > pair.shifts[1]:
        raise _too_short(first, second)
    candidates = _candidates(pair)
    best = max((_scanned(pair, shift, ONE_MODE) for shift in candidates), key=lambda found: found.gain)
    if best.explained < NEARLY_ALL:
        two = max((_scanned(pair, shift, TWO_MODES) for shift in candidates), key=lambda found: found.gain)
        best = max(best, two, key=lambda found: found.gain)
    looked = math.log(max(2.0, (pair.shifts[1] - pair.shifts[0]) * pair.rate))
    if best.gain < CERTAIN + looked:
        low, high = pair.as_shift(pair.shifts[0]), pair.as_shift(pair.shifts[1])
        low, high = min(low, high), max(low, high)
        raise InputError(
            f"{first.name}, {second.name}",
            f"have nothing in common: of shifts from {low:.4g} to {high:.4g} s, below {BAND * pair.rate:.3g} Hz, none "
            f"lets a response of one or two modes to {first.name} explain {second.name} (the best, "
            f"{pair.as_shift(best.shift):.4g} s, explains {100 * best.explained:.2g} %, as chance does)",
            "Are they logs of one event? A shift that is known is given by delay_s",
        )
    return _refined(pair, best)


def _too_short(first: Clocked, second: Clocked) -> InputError:
    return InputError(
        f"{first.name}, {second.name}", "are too short to be compared", f"Log at least {FEWEST} samples in common"
    )


@dataclass(frozen=True)
class _Found:
    """How well a shift does."""

    shift: float
    gain: float
    explained: float


@dataclass(frozen=True, eq=False)
class _Pair:
    """Both records prepared: the slower one on its own grid, the other made of its band and ready to be read between.

    ``shift`` here is what is added to the grid's clock to have the other's.
    """

    grid: Array
    rate: float
    slow: Array
    fast_time: tuple[float, float]
    spline: Callable[[Array], Array]
    slope: Callable[[Array], Array]
    slow_drives: bool
    shifts: tuple[float, float]
    middle: float

    @staticmethod
    def of(first: Clocked, second: Clocked) -> _Pair:
        from scipy.interpolate import CubicSpline
        from scipy.signal import butter, sosfiltfilt

        even = [even_samples(one.time, np.asarray(one.samples, float)[:, None]) for one in (first, second)]
        if min(len(one.samples) for one in even) < FEWEST:
            raise _too_short(first, second)
        slow_drives = even[0].sample_rate <= even[1].sample_rate
        slow, fast = even if slow_drives else even[::-1]
        samples = fast.samples[:, 0] - fast.samples[:, 0].mean()
        if fast.sample_rate > LOW_PASSED * slow.sample_rate:
            low_pass = butter(8, 0.5 * slow.sample_rate, fs=fast.sample_rate, output="sos")
            samples = sosfiltfilt(low_pass, samples)
        spline = CubicSpline(fast.time, samples)
        least = LEAST_SHARED * min(slow.time[-1] - slow.time[0], fast.time[-1] - fast.time[0])
        least = max(least, FEWEST / slow.sample_rate)
        shifts = (float(fast.time[0] - slow.time[-1] + least), float(fast.time[-1] - slow.time[0] - least))
        return _Pair(
            slow.time,
            slow.sample_rate,
            slow.samples[:, 0] - slow.samples[:, 0].mean(),
            (float(fast.time[0]), float(fast.time[-1])),
            spline,
            spline.derivative(),
            slow_drives,
            shifts,
            _middle(samples, fast.sample_rate) if slow_drives else _middle(slow.samples[:, 0], slow.sample_rate),
        )

    def as_shift(self, shift: float) -> float:
        """Of the second clock against the first."""
        return shift if self.slow_drives else -shift

    def shared(self, shift: float, spare: float = 0.0) -> slice:
        """Grid points that both cover."""
        first = int(np.searchsorted(self.grid, self.fast_time[0] - shift + spare))
        last = int(np.searchsorted(self.grid, self.fast_time[1] - shift - spare, side="right"))
        return slice(first, last)

    def highest(self, part: slice) -> int:
        """Last bin up to which a search compares: a few times the middle frequency of what answers, where a shift by a
        fraction of its period leaves the records alike."""
        reached = SEARCHED * self.middle * (part.stop - part.start) / self.rate
        return int(min(self.most(part), max(reached, MOST_UNKNOWNS)))

    def most(self, part: slice) -> int:
        """Last bin that is compared at all."""
        return min(int(BAND * (part.stop - part.start)), MOST_BINS)

    def bins(self, part: slice, clock: Array, last: int, slopes: bool = False) -> tuple[Pair, Pair]:
        """Bins (input, output) up to ``last``, and their slopes over shift and drift."""
        grid = self.grid[part]
        since = grid - grid[0]
        at = grid + clock[0] + clock[1] * since
        kept = slice(LOWEST, last + 1)
        table = [self.slow[part], self.spline(at)]
        if slopes:
            slope = self.slope(at)
            table += [slope, slope * since]
        transformed = np.fft.rfft(table, axis=1)[:, kept]
        slow, fast, moving = transformed[0], transformed[1], transformed[2:]
        still = np.zeros_like(moving)
        return ((slow, fast), (still, moving)) if self.slow_drives else ((fast, slow), (moving, still))


LOWEST = 2
"""First bin that is compared: the mean is the sensors' zeros, and so is most of a single wave."""


def _s(last: int) -> Array:
    kept = np.arange(LOWEST, last + 1)
    result: Array = 1j * kept / kept[-1]
    return result


def _candidates(pair: _Pair) -> list[float]:
    """Shifts at which the records look alike, by correlation as they are and whitened."""
    from scipy.signal import correlate, hilbert

    step = 1.0 / pair.rate
    fast_grid = np.arange(pair.fast_time[0], pair.fast_time[1], step)
    slow, fast = pair.slow, pair.spline(fast_grid)
    found: list[float] = []
    for one, other in ((slow, fast), (_whitened(slow), _whitened(fast))):
        strength = np.abs(hilbert(correlate(other, one, mode="full")))
        lags = np.arange(-len(one) + 1, len(other))
        shifts = lags * step + fast_grid[0] - pair.grid[0]
        shared = np.minimum(lags + len(one), len(other)) - np.maximum(lags, 0)
        strength /= np.sqrt(np.maximum(shared, 1))
        strength[(shifts < pair.shifts[0]) | (shifts > pair.shifts[1])] = 0.0
        apart = max(1, round(AROUND * pair.rate / pair.middle))
        for _ in range(CANDIDATES):
            at = int(np.argmax(strength))
            if strength[at] <= 0.0:
                break
            found.append(float(shifts[at]))
            strength[max(0, at - apart) : at + apart + 1] = 0.0
    return found


def _middle(samples: Array, rate: float) -> float:
    """Frequency [Hz] about which the power lies, its trend aside."""
    power = np.abs(np.fft.rfft((samples - samples.mean()) * np.hanning(len(samples)))) ** 2
    power[:LOWEST] = 0.0
    bins = float(np.sum(power * np.arange(len(power)))) / max(float(np.sum(power)), 1e-300)
    return max(bins, 1.0) * rate / len(samples)


def _whitened(samples: Array) -> Array:
    """What a linear prediction from the last samples leaves, (n,) float."""
    from scipy.linalg import solve_toeplitz
    from scipy.signal import lfilter

    order = min(16, len(samples) // 8)
    spectrum = np.abs(np.fft.rfft(samples, 2 * len(samples))) ** 2
    covariance = np.fft.irfft(spectrum)[: order + 1]
    covariance[0] *= 1.0 + 1e-6
    result: Array = lfilter(np.concatenate([[1.0], -solve_toeplitz(covariance[:-1], covariance[1:])]), [1.0], samples)
    return result


def _scanned(pair: _Pair, centre: float, structure: Structure) -> _Found:
    """The best shift around a candidate."""
    shifts = np.unique(np.clip(centre + _steps(pair), *pair.shifts)).tolist()
    residuals = [_residual(pair, shift, structure) for shift in shifts]
    shift, (y, with_it) = min(
        zip(shifts, residuals, strict=True),
        key=lambda one: np.mean(np.abs(one[1][1]) ** 2) / np.mean(np.abs(one[1][0]) ** 2),
    )
    s = _s(LOWEST + len(y) - 1)
    # of the very same samples: what is read between samples, or from another stretch, has another power
    alone = fitted_response(s, np.zeros_like(y), y, np.ones(len(y)), alone_of(structure)).residual
    without = alone if np.mean(np.abs(alone) ** 2) < np.mean(np.abs(y) ** 2) else y
    return _Found(shift, *_gain(without, with_it, len(structure.above)))


def _residual(pair: _Pair, shift: float, structure: Structure) -> tuple[Array, Array]:
    """Bins of the answer at a shift, and what a response to the other record leaves of them."""
    part = pair.shared(shift)
    last = pair.highest(part)
    (u, y), _ = pair.bins(part, np.array([shift, 0.0]), last)
    return y, fitted_response(_s(last), u, y, np.ones(len(y)), structure, rounds=2).residual


def _steps(pair: _Pair) -> Array:
    """Of a search around a shift [s]."""
    return np.arange(-math.ceil(AROUND * FINENESS), math.ceil(AROUND * FINENESS) + 1) / (FINENESS * pair.middle)


def _gain(without: Array, with_it: Array, more: int) -> tuple[float, float]:
    """Log-likelihood gained by the other record, for its coefficients; and the share explained.

    Bins count by the power that they have without it: a record whose motion sits in few bins has few to show.
    """
    power = np.abs(without) ** 2
    count = float(np.sum(power)) ** 2 / max(float(np.sum(power**2)), 1e-300)
    left = float(np.mean(np.abs(with_it) ** 2)) / max(float(np.mean(power)), 1e-300)
    return count * -math.log(max(left, 1e-12)) - more, 1.0 - left


def _refined(pair: _Pair, found: _Found) -> Alignment:
    """Shift, drift and response together, by the simplest structure that leaves hardly more than any other."""
    part = pair.shared(found.shift, SPARE / pair.rate)
    last = pair.most(part)
    richest = _widened(pair, part, STRUCTURES[-1], found.shift)
    enough = HARDLY_MORE * float(np.mean(np.abs(richest.residual) ** 2))
    simpler = (_widened(pair, part, structure, found.shift) for structure in STRUCTURES[:-1])
    best = next((one for one in simpler if np.mean(np.abs(one.residual) ** 2) < enough), richest)
    level = np.ones(last - LOWEST + 1)
    for _ in range(LEVEL_ROUNDS):
        level = error_level(best, _s(last))
        best = _with(pair, part, last, best.structure, best.clock, 1.0 / level)
    (u, y), _ = pair.bins(part, best.clock, last)
    alone = fitted_response(_s(last), np.zeros_like(u), y, 1.0 / level, alone_of(best.structure))
    explained = 1.0 - float(np.sum(np.abs(best.residual) ** 2) / np.sum(np.abs(alone.residual) ** 2))
    return _alignment(pair, part, best, explained)


def _widened(pair: _Pair, part: slice, structure: Structure, shift: float) -> Response:
    """A structure's own best shift near one, first in the band of the search, then up to all that both show."""
    last = pair.highest(part)
    shifts = shift + _steps(pair)

    def misfit(at: float) -> float:
        (u, y), _ = pair.bins(part, np.array([at, 0.0]), last)
        rest = fitted_response(_s(last), u, y, np.ones(len(y)), structure, rounds=2).residual
        return float(np.mean(np.abs(rest) ** 2))

    clock = np.array([min((float(at) for at in shifts), key=misfit), 0.0])
    while True:
        (_, y), _ = pair.bins(part, clock, last)
        response = _with(pair, part, last, structure, clock, np.full(len(y), 1.0 / np.sqrt(np.mean(np.abs(y) ** 2))))
        if last == pair.most(part):
            return response
        clock, last = response.clock, min(2 * last, pair.most(part))


def _with(pair: _Pair, part: slice, last: int, structure: Structure, clock: Array, weight: Array) -> Response:
    (u, y), _ = pair.bins(part, clock, last)
    start = fitted_response(_s(last), u, y, weight, structure)

    def moved(clock: Array) -> tuple[Pair, Pair]:
        return pair.bins(part, clock, last, slopes=True)

    return with_clock(_s(last), moved, start, clock, weight, DRIFT_STD)


def _alignment(pair: _Pair, part: slice, response: Response, explained: float) -> Alignment:
    """In the order in which the records were given."""
    grid = pair.grid[part]
    (shift, drift), covariance = response.clock, response.covariance
    start, end = float(grid[0]), float(grid[-1])
    if not pair.slow_drives:  # the grid is the second clock's: t1 = t2 + shift + drift·(t2 − start)
        start, end = start + shift, end + shift + drift * (end - start)
        shift, drift = -shift, 1.0 / (1.0 + drift) - 1.0
    span = len(grid) / pair.rate
    return Alignment(
        float(shift),
        float(math.sqrt(covariance[0, 0])),
        float(1e6 * drift),
        float(1e6 * math.sqrt(covariance[1, 1])),
        start,
        end,
        explained,
        (LOWEST / span, BAND * pair.rate),
    )
