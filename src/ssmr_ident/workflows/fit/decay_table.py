"""Table 5.2 of the thesis for a session's own decays: the highest line of each trial, mean and standard deviation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.identify.decays.result import DecayFit, Mode
from ssmr_ident.report.figures_fit import NamedDecay
from ssmr_ident.signals.filters import FREE_RESPONSE_LOW_PASS_HZ, low_pass
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.signals.peaks import find_peaks
from ssmr_ident.signals.spectra import FREE_RESPONSE_LENGTH, amplitude_spectrum, select_range


def named_decay(
    name: str, motion: str, time: np.ndarray, samples: np.ndarray, unit: str, fit: DecayFit, mode: Mode
) -> NamedDecay | None:
    """A decay as the thesis reads it, beside what was fitted; None where its rate or length does not allow that.

    Low-passed at 20 Hz, the first 2048 samples transformed, the highest local maximum taken.

    Parameters
    ----------
    name, motion : str
    time : (n,) float [s]
    samples : (n,) float [unit]
    unit : str
    fit : DecayFit
    mode : Mode
        The motion's own.
    """
    even = even_samples(time, samples[:, None])
    if even.sample_rate <= 2.0 * FREE_RESPONSE_LOW_PASS_HZ or len(even.samples) < 64:
        return None
    course = low_pass(even.samples[:, 0], even.sample_rate, FREE_RESPONSE_LOW_PASS_HZ)
    part = select_range(len(course), even.sample_rate, "beginning", length=FREE_RESPONSE_LENGTH)
    spectrum = amplitude_spectrum(course[part.indices], even.sample_rate)
    peaks = find_peaks(spectrum, count=1)
    return NamedDecay(
        name, motion, unit, even.time - even.time[0], course - fit.offsets[0, 0], fit.starts_s[0],
        float(mode.amplitudes[0, 0]), mode.decay_rate, float(peaks.frequency[0]) if len(peaks) else float("nan"),
        spectrum.resolution,
    )  # fmt: skip


def decay_table(decays: Sequence[NamedDecay]) -> str:
    """Peaks of all trials, mean and sample standard deviation per motion."""
    motions = list(dict.fromkeys(decay.motion for decay in decays))
    most = max(sum(decay.motion == motion for decay in decays) for motion in motions)
    lines = [
        f"Table 5.2 of the thesis for these logs: highest line of {FREE_RESPONSE_LENGTH} samples below "
        f"{FREE_RESPONSE_LOW_PASS_HZ:g} Hz, on bins of {max(d.resolution_hz for d in decays):.3g} Hz",
        f"{'':<16}" + "".join(f"{trial:>9}" for trial in range(1, most + 1)) + f"{'mean':>9}{'std':>9}",
    ]
    for motion in motions:
        own = [decay for decay in decays if decay.motion == motion]
        values = [decay.peak_hz for decay in own]
        spread = f"{np.std(values, ddof=1):9.4f}" if len(values) > 1 else f"{'–':>9}"
        cells = "".join(f"{value:9.4f}" for value in values) + " " * 9 * (most - len(values))
        lines.append(f"{f'{motion} [Hz]':<16}{cells}{np.mean(values):9.4f}{spread}")
    return "\n".join(lines)
