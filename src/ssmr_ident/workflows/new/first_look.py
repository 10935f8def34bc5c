"""A rig's mass, damper and spring at first sight, by linear least squares on responses and by the first decays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import csd

from ssmr_ident.core.errors import InputError
from ssmr_ident.estimate.pieces import order_of
from ssmr_ident.experiments.releases import cut, parts_of
from ssmr_ident.identify.decays.backbone import backbone
from ssmr_ident.identify.decays.fit import fit_decay
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.workflows.new.log import ALL_MOTIONS, LogGuess

LEAST_DAMPING = 0.02
"""Of 2·√(mass·stiffness): what a driven response gives where noise or a nonlinear spring hides it."""

NO_SPRING = 1.05
"""Misfit without a spring over that with one up to which there is none."""


@dataclass(frozen=True)
class FirstLook:
    """What the logs tell of a rig.

    Parameters
    ----------
    damping, stiffness : float
        Over the mass: [1/s] and [1/s^2].
    mass : float or None [kg or kg m^2]
        None where nothing tells it.
    said : str
        From what.
    """

    damping: float
    stiffness: float
    mass: float | None
    said: str

    @property
    def springless(self) -> bool:
        return self.stiffness == 0.0


def first_look(guesses: Sequence[LogGuess]) -> FirstLook | None:
    """What the logs of a rig tell; None where they tell nothing.

    A measured force tells the mass as well; what was let go, or stands on a foot that moves, only ratios to it.
    """
    kinds = [(guess, guess.experiment) for guess in guesses]
    forced = [guess for guess, kind in kinds if kind and kind.driven and not kind.on_a_base]
    based = [guess for guess, kind in kinds if kind and kind.on_a_base]
    free = [guess for guess, kind in kinds if kind and kind.free]
    return _driven(forced) or _on_a_foot(based) or _let_go(free)


def _driven(guesses: Sequence[LogGuess]) -> FirstLook | None:
    parts = []
    for guess in guesses:
        recording = guess.recording
        force = next(
            (name for name in ("torque" if guess.rotary else "force", "force", "torque") if name in recording), ""
        )
        motion = _motion(guess)
        if force and motion:
            parts.append(_response(recording.time, recording[force], recording[motion], order_of(motion)))
    found = _fitted([part for part in parts if part is not None])
    if found is None:
        return None
    mass, damping, stiffness = found
    return FirstLook(damping / mass, stiffness / mass, mass, "the response to the measured force")


def _on_a_foot(guesses: Sequence[LogGuess]) -> FirstLook | None:
    parts = []
    for guess in guesses:
        recording = guess.recording
        if "base_acceleration" in recording and "acceleration" in recording:
            foot = recording["base_acceleration"]
            parts.append(_response(recording.time, -foot, recording["acceleration"] - foot, 2))
    found = _fitted([part for part in parts if part is not None])
    if found is None:
        return None
    mass, damping, stiffness = found
    return FirstLook(damping / mass, stiffness / mass, None, "how the mass answers to its foot")


def _let_go(guesses: Sequence[LogGuess]) -> FirstLook | None:
    """Median over the decays of frequency and damping; at small amplitude where they depend on it."""
    seen = []
    for guess in guesses:
        name = _motion(guess)
        if not name:
            continue
        recording = guess.recording
        for part in parts_of(recording) or ():
            seen.append(_decay(part.recording.time, part.recording[name]))
        if not parts_of(recording):
            whole = cut(recording, np.isfinite(recording[name]))
            seen.append(_decay(whole.time, whole[name]))
    found = [one for one in seen if one is not None]
    if not found:
        return None
    omega, xi = (float(np.median(column)) for column in zip(*found, strict=True))
    text = f"{len(found)} decay{'s' if len(found) > 1 else ''}: {omega / (2 * math.pi):.4g} Hz, xi {xi:.3g}"
    return FirstLook(2.0 * xi * omega, omega**2, None, text)


def _decay(time: np.ndarray, samples: np.ndarray) -> tuple[float, float] | None:
    even = even_samples(time, samples[:, None])
    try:
        fit = fit_decay(even.time, even.samples[:, 0], modes=1)
    except InputError:  # a log that holds no decay tells nothing here, and the fit will say so
        return None
    mode = fit.dominant
    trend = None if fit.adequate else backbone(even.time, even.samples[:, 0], fit)
    if trend is None:
        return mode.omega_n, mode.xi
    return trend.small_omega_n, float(np.median(trend.xi))


def _motion(guess: LogGuess) -> str:
    return next((name for name in ALL_MOTIONS if name in guess.recording and name != "position_reference"), "")


def _response(
    time: np.ndarray, force: np.ndarray, motion: np.ndarray, order: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """ω, position over force (Welch, eight segments), and a weight by the coherence, where the force has power."""
    even = even_samples(time, np.column_stack([force, motion]))
    (force, motion), rate = even.samples.T, even.sample_rate
    length = max(64, len(force) // 4) if len(force) > 64 else len(force)
    frequency, cross = csd(force, motion, rate, nperseg=length)
    power, own = (csd(x, x, rate, nperseg=length)[1].real for x in (force, motion))
    use = (frequency > 2.0 * rate / length) & (frequency < rate / 4) & (power > 1e-3 * np.max(power[1:])) & (own > 0)
    if np.count_nonzero(use) < 3:
        return None
    coherence = np.clip(np.abs(cross[use]) ** 2 / (power[use] * own[use]), 0.0, 0.999)
    omega = 2 * np.pi * frequency[use]
    response = cross[use] / power[use] / (1j * omega) ** order
    return omega, response, np.sqrt(coherence / (1.0 - coherence)) / np.abs(response)


def _fitted(parts: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> tuple[float, float, float] | None:
    """Mass, damping, stiffness of 1/(K − M·ω² + i·D·ω), fitted to the measured response by linear least squares.

    The equation's error is divided by the last round's denominator (Sanathanan and Koerner 1963), which makes it the
    output's, and weighted by the coherence. A spring that hardly lessens the misfit is none. None without a positive
    mass.
    """
    if not parts:
        return None
    omega, response, weight = (np.concatenate(column) for column in zip(*parts, strict=True))
    with_spring, misfit = _least_squares(omega, response, weight, 3)
    without, alone = _least_squares(omega, response, weight, 2)
    mass, damping, stiffness = with_spring
    if not (mass > 0 and stiffness > 0) or alone < NO_SPRING * misfit:
        mass, damping = without
        return None if not mass > 0 else (_digits(mass), _digits(max(damping, 1e-6 * mass)), 0.0)
    damping = max(damping, LEAST_DAMPING * math.sqrt(mass * stiffness))
    return _digits(mass), _digits(damping), _digits(stiffness)


def _least_squares(
    omega: np.ndarray, response: np.ndarray, weight: np.ndarray, unknowns: int
) -> tuple[np.ndarray, float]:
    scale = np.array([1.0 / omega.mean() ** 2, 1.0 / omega.mean(), 1.0])[:unknowns]
    columns = np.stack([-(omega**2), 1j * omega, np.ones_like(omega)], axis=1)[:, :unknowns] * scale
    last = np.ones_like(response) / np.median(np.abs(response))
    found = np.zeros(unknowns)
    for _ in range(20):
        matrix, right = columns * (response * weight / last)[:, None], weight / last
        stacked, sides = np.concatenate([matrix.real, matrix.imag]), np.concatenate([right.real, right.imag])
        found = np.linalg.lstsq(stacked, sides, rcond=None)[0]
        last = columns @ found
    misfit = float(np.sum((weight * np.abs(response - 1.0 / last)) ** 2))
    return found * scale, misfit


def _digits(value: float) -> float:
    return float(f"{value:.4g}")
