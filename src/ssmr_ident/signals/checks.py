"""What every function of this room asks of its samples, said in one line when it is not so."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.errors import InputError


def checked_samples(samples: np.ndarray, sample_rate: float, *, least: int = 2) -> np.ndarray:
    """Samples as a float array, refused when they cannot be analysed.

    Parameters
    ----------
    samples : (n,) or (n, k) float
        Time runs along the first axis.
    sample_rate : float [Hz]
    least : int
        Smallest n that makes sense to the caller.

    Raises
    ------
    InputError
        Not one- or two-dimensional, too short, not finite, or a rate that is not a positive number.
    """
    array = np.asarray(samples, dtype=float)
    if array.ndim not in (1, 2):
        raise InputError("samples", f"shape {array.shape}; expected (n,) or (n, channels)")
    if not (np.isfinite(sample_rate) and sample_rate > 0):
        raise InputError("sample rate", f"{sample_rate} Hz; expected a positive number", "Check the time column.")
    if len(array) < least:
        raise InputError(
            "samples", f"{len(array)} samples; at least {least} are needed", "Take a longer part of the log."
        )
    finite = np.isfinite(array).reshape(len(array), -1).all(axis=1)
    if not finite.all():
        first = int(np.argmin(finite))
        raise InputError(
            "samples",
            f"{np.count_nonzero(~finite)} of {len(array)} are not finite, first at {first / sample_rate:.4g} s",
            "Bridge short gaps or choose a range without them.",
        )
    return array
