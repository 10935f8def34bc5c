"""Which variable orders the unexplained force: time, displacement, velocity, travel or load.

Samples are parted into bins of equal number along each variable; the one whose bins' means hold most of the variance
orders best. First the force itself is looked at (over all but time), a law's own shape; then the logarithm of its
square, which shows where it acts when its sign does not follow. Samples are correlated in time, so chance is judged
by signals of the same spectrum with phases drawn anew. Source: Theiler et al., Physica D 58 (1992) 77.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ssmr_ident.diagnose.motion import motion_of
from ssmr_ident.diagnose.quantity import prefixed
from ssmr_ident.identify.trials.trial import Trial

Array = np.ndarray

CUTS = np.linspace(0.1, 0.9, 9)
"""Quantiles between bins."""

SURROGATES = 199
CLEAR = 0.01
"""p-value below which a region is told."""

HIGH = {
    "|displacement|": "where the displacement is large",
    "|velocity|": "where the motion is fast",
    "displacement": "on the positive side",
    "velocity": "while moving to the positive side",
    "time": "late in the recording",
    "travel": "late in the travel",
    "load": "where the force is large",
}
LOW = {
    "|displacement|": "near the middle position",
    "|velocity|": "where the motion is slow or turns round",
    "displacement": "on the negative side",
    "velocity": "while moving to the negative side",
    "time": "early in the recording",
    "travel": "early in the travel",
    "load": "where the force is small",
}


@dataclass(frozen=True)
class Ordering:
    """The variable that orders an unexplained force, and the half of its range in which the force is large.

    Parameters
    ----------
    variable, condition, words : str
        ``condition`` is like ``|velocity| < 3.1 mm/s``.
    follows : bool
        The force itself follows the variable; else only its size does.
    explained : float
        Share of the variance between bins.
    p_value : float
        Of the best of all variables, by signals with other phases.
    """

    variable: str
    condition: str
    words: str
    follows: bool
    explained: float
    p_value: float


def state_variables(trial: Trial, channel: int) -> dict[str, tuple[Array, str]]:
    """Variables that may order a residual, with their units; (n,) each.

    The measured motion is taken, for that is where the force acted.

    Parameters
    ----------
    trial : Trial
    channel : int
    """
    since = trial.times - trial.times[0]
    if trial.channels == ("force",):
        travel = float(trial.facts["travel_m"]) * since / since[-1]
        return {"travel": (travel, "m"), "load": (np.abs(trial.target[:, 0]), "N")}
    motion = motion_of(trial, trial.target[:, channel], channel)
    along, speed = motion.units[:2]
    return {
        "displacement": (motion.displacement, along),
        "velocity": (motion.velocity, speed),
        "time": (since, "s"),
    }


def ordering(force: Array, variables: Mapping[str, tuple[Array, str]], seed: int = 0) -> Ordering:
    """The variable that orders a force best.

    Parameters
    ----------
    force : (n,) float
    variables : mapping of name to ((n,) float, unit)
    seed : int
        Of the phases.
    """
    power = force**2
    level = np.log(power + 0.1 * power.mean() + 1e-300)
    laws = {name: pair for name, pair in variables.items() if name != "time"}
    name, explained, p_value = _best(force, laws, seed)
    follows = p_value < CLEAR
    if not follows:
        name, explained, p_value = _best(level, variables, seed)
    condition, words = _region(name, *variables[name], level - level.mean())
    return Ordering(name, condition, words, follows, explained, p_value)


def _best(signal: Array, variables: Mapping[str, tuple[Array, str]], seed: int) -> tuple[str, float, float]:
    """Variable, share of the variance that its bins hold, p-value."""
    signal = signal - signal.mean()
    total = float(signal @ signal) + 1e-300
    places = {
        name: np.searchsorted(np.quantile(values, CUTS), values, side="right")
        for name, (values, _) in variables.items()
    }
    found = {name: _between(signal, place) / total for name, place in places.items()}
    name = max(found, key=lambda key: found[key])
    rng = np.random.default_rng(seed)
    spectrum = np.fft.rfft(signal)
    beaten = 0
    for _ in range(SURROGATES):
        turned = spectrum * np.exp(2j * np.pi * rng.random(len(spectrum)))
        other = np.fft.irfft(turned, len(signal))
        scale = total / (float(other @ other) + 1e-300)
        beaten += max(_between(other, place) for place in places.values()) * scale >= found[name] * total
    return name, found[name], (beaten + 1) / (SURROGATES + 1)


def _between(signal: Array, place: Array) -> float:
    """Sum of squares between bins of a signal of mean 0."""
    sums = np.bincount(place, signal, len(CUTS) + 1)
    return float(np.sum(sums**2 / np.maximum(np.bincount(place, minlength=len(CUTS) + 1), 1)))


def _region(name: str, values: Array, unit: str, level: Array) -> tuple[str, str]:
    """The cut of a variable, or of its size, that parts large from small best."""
    choices = {name: values}
    if name in ("displacement", "velocity"):
        choices[f"|{name}|"] = np.abs(values)
    best = (-1.0, "", "")
    for label, along in choices.items():
        place = np.searchsorted(np.quantile(along, CUTS), along, side="right")
        sums = np.cumsum(np.bincount(place, level, len(CUTS) + 1))[:-1]
        counts = np.cumsum(np.bincount(place, minlength=len(CUTS) + 1))[:-1]
        between = sums**2 / np.maximum(counts, 1) + sums**2 / np.maximum(len(level) - counts, 1)
        cut = int(np.argmax(between))
        if between[cut] > best[0]:
            above = sums[cut] < 0.0
            at = prefixed(float(np.quantile(along, CUTS[cut])), unit)
            best = (float(between[cut]), f"{label} {'>' if above else '<'} {at}", (HIGH if above else LOW)[label])
    return best[1:]
