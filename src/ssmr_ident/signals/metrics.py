"""Two distances of a simulation from a recording: ``nrmse_percent`` for courses, ``log_psd_db`` for spectra."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.signals.checks import checked_samples
from ssmr_ident.signals.filters import low_pass
from ssmr_ident.signals.spectra import power_density

LOW_PASS_HZ = 50.0
SILENCE = 1e-12
"""Density that counts as silence, over the recording's mean density: −120 dB; 16 bits reach down to −98 dB."""


def nrmse_percent(
    measured: np.ndarray,
    simulated: np.ndarray,
    sample_rate: float,
    *,
    low_pass_hz: float | None = LOW_PASS_HZ,
    remove_mean: bool = True,
) -> float:
    """100·‖y − ŷ‖/‖y − ȳ‖ on the low-passed signals with their means taken off.

    Parameters
    ----------
    measured, simulated : (n,) or (n, k) float [one unit]
        Over (n, k) the norms run over all channels together.
    sample_rate : float [Hz]
    low_pass_hz : float or None [Hz]
        None: as logged (pull tests).
    remove_mean : bool
        False: a constant difference counts (pull tests, where the level is what is predicted).

    Returns
    -------
    float [%]
        0 for equal signals, 100 for a simulation that is a constant.

    Raises
    ------
    InputError
        Different shapes, or a recording that is constant: nothing to explain.
    """
    y, y_hat = checked_samples(measured, sample_rate), checked_samples(simulated, sample_rate)
    _require_same_shape(y, y_hat)
    if low_pass_hz is not None:
        y, y_hat = (low_pass(signal, sample_rate, low_pass_hz) for signal in (y, y_hat))
    centred = y - y.mean(axis=0)
    difference = centred - (y_hat - y_hat.mean(axis=0)) if remove_mean else y - y_hat
    size = np.linalg.norm(centred)
    if size <= 1e-12 * np.linalg.norm(y) or size == 0:
        raise InputError("measured", "the recording is constant, so no share of it can be explained")
    return float(100 * np.linalg.norm(difference) / size)


def log_psd_db(
    measured: np.ndarray,
    simulated: np.ndarray,
    sample_rate: float,
    *,
    simulated_rate: float | None = None,
    band_hz: tuple[float, float] = (1.0, 50.0),
) -> float | np.ndarray:
    """RMS difference of the log power spectra over the band, 1 Hz wide bins (contract: swivels).

    Parameters
    ----------
    measured, simulated : (n,) or (n, k) float [one unit]
        Lengths may differ, and so may rates; phases do not count.
    sample_rate : float [Hz]
    simulated_rate : float [Hz]
        Of ``simulated``, where it differs.
    band_hz : (float, float) [Hz]
        Cut at half the lower of both rates.

    Returns
    -------
    float [dB], or (k,) float per channel
        Two records of the same white noise, T seconds each, differ by 10/ln 10·√(1.06/T) dB by chance alone
        (half-overlapping Hann segments of 1 s): 1.0 dB for 20 s. Nothing below that can be told apart.

    Raises
    ------
    InputError
        Records shorter than 2 s, different channels, or a silent recording.
    """
    y = checked_samples(measured, sample_rate)
    y_hat = checked_samples(simulated, simulated_rate or sample_rate)
    _require_same_shape(y[:1], y_hat[:1])
    truth = power_density(y, sample_rate, band_hz=band_hz)
    model = power_density(y_hat, simulated_rate or sample_rate, band_hz=band_hz)
    bins = min(len(truth.frequency), len(model.frequency))
    level = truth.density[:bins].mean(axis=0)
    if np.any(level <= 0):
        raise InputError("measured", "a channel is silent in the band, so no ratio to it exists")
    logs = [10 * np.log10(np.maximum(d[:bins], SILENCE * level)) for d in (truth.density, model.density)]
    distance = np.sqrt(np.mean((logs[0] - logs[1]) ** 2, axis=0))
    return float(distance) if np.ndim(distance) == 0 else distance


def _require_same_shape(measured: np.ndarray, simulated: np.ndarray) -> None:
    if measured.shape != simulated.shape:
        raise InputError(
            "simulated",
            f"shape {simulated.shape}; expected {measured.shape} as measured",
            "Simulate on the same times.",
        )
