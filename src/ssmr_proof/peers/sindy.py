"""PySINDy on the residual force: sparse regression at its defaults over a library of physical terms."""

from __future__ import annotations

import time
import warnings

import numpy as np
from scipy.integrate import cumulative_trapezoid

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.signals.filters import low_pass
from ssmr_proof.peers.answer import PeerAnswer, drive_and_motion

BAND_HZ = (4.0, 35.0)
"""Below, an integrated acceleration is drift."""
LIBRARY = {
    # of position and velocity over their own standard deviations
    "1": None, "x": None, "v": None,
    "x^2": "unlisted", "x v": "unlisted", "v^2": "unlisted", "x^3": "nonlinear_stiffness", "x^2 v": "unlisted",
    "v^3": "unlisted", "x|x|": "nonlinear_stiffness", "v|v|": "quadratic_damping", "sign v": "dry_friction",
    "|x|": "unlisted", "|v|": "unlisted",
}  # fmt: skip


def sindy(campaign: Campaign, threshold: float = 0.1) -> PeerAnswer:
    """Force over position, velocity and acceleration, in the units of their standard deviations.

    Motions that were not measured are integrated or differentiated within 4 to 35 Hz. Mass, damper and spring are
    taken out by least squares first; what is left is regressed on the library by PySINDy's default optimiser (STLSQ,
    threshold 0.1, ridge 0.05). A term of the library that is no damper and no spring counts as a claim.

    Parameters
    ----------
    campaign : Campaign
        Driven rig.
    threshold : float
        Of STLSQ, in standard deviations of the residual force.
    """
    try:
        import pysindy
    except ImportError:
        raise InputError("PySINDy", "is not installed", "pip install 'ssmr_ident[peers]'") from None
    begin = time.perf_counter()
    quantity, targets = drive_and_motion(campaign)
    motions, forces = [], []
    for measurement in targets:
        record = measurement.recording
        rate = record.sample_rate
        motions.append(motion_of(record[quantity], quantity, rate))
        forces.append(_band(record["force"], rate))
    motion, force = np.concatenate(motions), np.concatenate(forces)
    linear = np.linalg.lstsq(motion, force, rcond=None)[0]
    rest = force - motion @ linear
    x, v = (motion[:, index] / motion[:, index].std() for index in (0, 1))
    size = float(rest.std())
    features = np.column_stack([
        np.ones_like(x), x, v, x**2, x * v, v**2, x**3, x**2 * v, v**3, x * np.abs(x), v * np.abs(v), np.sign(v),
        np.abs(x), np.abs(v),
    ])  # fmt: skip
    optimiser = pysindy.STLSQ(threshold=threshold)
    with warnings.catch_warnings():
        # that nothing is left is an answer here
        warnings.filterwarnings("ignore", "Sparsity parameter is too big", UserWarning)
        optimiser.fit(features, (rest / size)[:, None])
    weights = np.ravel(optimiser.coef_)
    claims, effects = [], []
    for (term, effect), weight in zip(LIBRARY.items(), weights, strict=True):
        if effect is not None and weight != 0.0:
            claims.append(f"{weight * size:+.3g} N · {term}")
            effects.append(effect)
    names = ("stiffness_N_m", "damping_N_s_m", "mass_kg")
    parameters = {name: (float(value), float("nan")) for name, value in zip(names, linear, strict=True)}
    spent = time.perf_counter() - begin
    return PeerAnswer("PySINDy", tuple(claims), tuple(dict.fromkeys(effects)), bool(claims), spent, parameters)


def motion_of(signal: np.ndarray, quantity: str, rate: float) -> np.ndarray:
    """Position, velocity and acceleration within the band, (n, 3), ends cut off."""
    order = ("position", "velocity", "acceleration").index(quantity)
    known = {order: _filtered(signal, rate)}
    for index in range(order - 1, -1, -1):
        known[index] = _filtered(cumulative_trapezoid(known[index + 1], dx=1.0 / rate, initial=0.0), rate)
    for index in range(order + 1, 3):
        known[index] = np.gradient(known[index - 1], 1.0 / rate)
    return np.column_stack([_ends_off(known[index], rate) for index in range(3)])


def _band(signal: np.ndarray, rate: float) -> np.ndarray:
    return _ends_off(_filtered(signal, rate), rate)


def _filtered(signal: np.ndarray, rate: float) -> np.ndarray:
    low = low_pass(signal - signal.mean(), rate, min(BAND_HZ[1], 0.45 * rate))
    result: np.ndarray = low - low_pass(low, rate, BAND_HZ[0])
    return result


def _ends_off(signal: np.ndarray, rate: float) -> np.ndarray:
    cut = round(0.3 * rate)
    return signal[cut:-cut]
