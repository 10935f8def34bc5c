"""From a log's own time stamps to evenly spaced samples, which filters and transforms take for granted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Note
from ssmr_ident.core.shown import Shown


@dataclass(frozen=True)
class EvenSamples(Shown):
    """Samples on an even grid.

    Parameters
    ----------
    start : float [s]
        Time of the first sample.
    sample_rate : float [Hz]
    samples : (n, k) float [as given]
    notes : tuple of Note
        What was filled in or moved; empty when the stamps were even.
    """

    start: float
    sample_rate: float
    samples: np.ndarray
    notes: tuple[Note, ...] = ()

    @property
    def time(self) -> np.ndarray:
        """(n,) float [s]."""
        return self.start + np.arange(len(self.samples)) / self.sample_rate

    def __str__(self) -> str:
        head = f"{len(self.samples)} samples at {self.sample_rate:g} Hz from {self.start:g} s"
        return "\n".join([head, *(f"  {note}" for note in self.notes)])


def even_samples(time: np.ndarray, samples: np.ndarray) -> EvenSamples:
    """Samples as they are when every stamp lies within half a step of an even grid, else interpolated onto one.

    The grid's step is the mean one; where stamps miss it by half a step or more (lost rows, a drifting clock)
    lost rows are counted in, and straight lines are drawn between the stamps that exist. Samples that are not
    finite count as not taken.

    Parameters
    ----------
    time : (n,) float [s], increasing
    samples : (n, k) float

    Raises
    ------
    InputError
        Fewer than two finite samples, or stamps that do not increase.
    """
    time, samples = np.asarray(time, dtype=float), np.asarray(samples, dtype=float)
    good = np.isfinite(samples).all(axis=1) & np.isfinite(time)
    notes: list[Note] = []
    if not good.all():
        notes.append(Note("warning", f"{np.count_nonzero(~good)} of {len(good)} samples are not finite; bridged"))
    kept_time, kept = time[good], samples[good]
    if len(kept_time) < 2:
        raise InputError("samples", f"{len(kept_time)} finite samples; at least 2 are needed", "Check the log.")
    steps = np.diff(kept_time)
    if steps.min() <= 0:
        raise InputError("time", f"does not increase at {kept_time[int(np.argmin(steps))]:g} s", "Sort the log.")
    mean_step = (kept_time[-1] - kept_time[0]) / (len(kept_time) - 1)
    index = (kept_time - kept_time[0]) / mean_step
    if np.abs(index - np.arange(len(index))).max() < 0.5:
        return EvenSamples(float(kept_time[0]), float(1 / mean_step), kept, tuple(notes))
    # Stamps may be rounded to a coarse tick, so the median alone may be a whole tick off.
    single = float(np.mean(steps[np.rint(steps / np.median(steps)) == 1]))
    step = float((kept_time[-1] - kept_time[0]) / np.rint(steps / single).sum())
    grid = kept_time[0] + step * np.arange(int((kept_time[-1] - kept_time[0]) / step + 1e-9) + 1)
    longest = int(np.argmax(steps))
    notes.append(
        Note(
            "warning",
            f"uneven time stamps, interpolated to {1 / step:.4g} Hz; "
            f"the longest step is {steps[longest]:.3g} s at {kept_time[longest]:.4g} s",
        )
    )
    columns = [np.interp(grid, kept_time, column) for column in kept.T]
    return EvenSamples(float(kept_time[0]), 1 / step, np.stack(columns, axis=1), tuple(notes))


def band_limited(signal: np.ndarray, factor: int) -> np.ndarray:
    """Finer samples of a band-limited signal, (n,) to ((n - 1)·factor + 1,).

    By Fourier series over the signal and its mirror image, so that the ends meet without a jump.
    """
    n = len(signal)
    if n < 4:
        return np.asarray(np.interp(np.arange((n - 1) * factor + 1) / factor, np.arange(n), signal))
    from scipy.signal import resample  # half a second that a swivel from the command line need not wait for

    mirrored = np.concatenate([signal, signal[-2:0:-1]])
    return np.asarray(resample(mirrored, len(mirrored) * factor)[: (n - 1) * factor + 1])


def line_corners(signal: np.ndarray) -> np.ndarray:
    """Corners of straight lines that do to a linear system what a smooth signal through these samples does, (n,) to
    (n,): lines through them take (angle a step)^2 / 12 of a sine away, and here its fourth power is left.

    >>> line_corners(np.array([0.0, 0.0, 12.0, 0.0, 0.0]))
    array([-1., -1., 14., -1., -1.])
    """
    found = np.array(signal, dtype=float)
    if len(found) > 2:
        bend = (found[:-2] - 2.0 * found[1:-1] + found[2:]) / 12.0
        found -= np.concatenate([bend[:1], bend, bend[-1:]])  # ends bend as their neighbours do
    return found
