"""Free decays: natural frequency and damping by least squares on the samples (5.9), noise and mains included.

``fit_decay`` takes one record, ``fit_decays`` several that share their modes (trials of one motion); each may
have several channels. What is linear (amplitudes, phases, offset, mains line) is eliminated, coloured noise is
whitened, the number of modes is chosen by evidence, and beside each standard deviation stands the Cramér–Rao
bound of the record: more than the bound says that the model does not hold, or that the noise is more than the
quiet end of the record shows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.identify.decays.record import noise_models, prepare
from ssmr_ident.identify.decays.result import DecayFit
from ssmr_ident.identify.decays.search import evidence, ladder
from ssmr_ident.identify.decays.summary import summarise
from ssmr_ident.signals.noise import white_noise

Array = np.ndarray


def fit_decay(
    time: Array,
    samples: Array,
    *,
    start_s: float | None = None,
    modes: int | None = None,
    max_modes: int = 3,
    mains_hz: float | None = 60.0,
    unit: str = "",
) -> DecayFit:
    """Fit one decay.

    Parameters
    ----------
    time : (n,) float [s]
        Uniform grid.
    samples : (n,) or (n, c) float
        Channels share the modes.
    start_s : float, optional
        Time from which the record is a free decay; found automatically when left out.
    modes : int, optional
        Number of modes; chosen by evidence up to ``max_modes`` when left out.
    mains_hz : float or None [Hz]
        Line to eliminate where it stands above the noise; its frequency is refined.
    unit : str
        Of the signal, for the report.

    Returns
    -------
    DecayFit

    Raises
    ------
    InputError
        For a record without a decay, an uneven time grid, or too few samples.

    Examples
    --------
    >>> time = np.arange(2048) * 1e-3
    >>> wave = np.exp(-1.2 * time) * np.sin(60 * time) + 1e-3 * np.random.default_rng(0).normal(size=2048)
    >>> fit = fit_decay(time, wave)
    >>> round(fit.modes[0].omega_n, 2), round(fit.modes[0].xi, 4)
    (60.01, 0.02)
    """
    starts = None if start_s is None else [start_s]
    return fit_decays(
        [(time, samples)], starts_s=starts, modes=modes, max_modes=max_modes, mains_hz=mains_hz, unit=unit
    )


def fit_decays(
    records: Sequence[tuple[Array, Array]],
    *,
    starts_s: Sequence[float | None] | None = None,
    modes: int | None = None,
    max_modes: int = 3,
    mains_hz: float | None = 60.0,
    unit: str = "",
) -> DecayFit:
    """Fit several records with shared modes and their own amplitudes, phases, offsets, noise.

    Parameters
    ----------
    records : sequence of ((n,) float [s], (n,) or (n, c) float)
        Time and samples of each; the number of channels must agree.

    Other parameters and errors as for :func:`fit_decay`.
    """
    prepared = [
        prepare(time, samples, None if starts_s is None else starts_s[number], mains_hz, number)
        for number, (time, samples) in enumerate(records)
    ]
    silent = [[white_noise(r.samples[:, c]) for c in range(r.samples.shape[1])] for r in prepared]
    top = modes or max_modes
    first = ladder(prepared, silent, top, wanted=modes)
    richest = first[max(first)]
    noises = noise_models(prepared, silent, richest)
    fits = ladder(prepared, noises, max(first), wanted=modes, warm=first)
    scores = evidence(prepared, noises, fits)
    chosen = modes if modes in fits else min(scores, key=lambda count: scores[count])
    return summarise(prepared, noises, fits[chosen], scores, unit)
