"""A robot's parameters from the samples of its free responses: noise, starts, simulator, in that order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.identify.body.defects import defect
from ssmr_ident.identify.body.free_decays import BodyDecay
from ssmr_ident.identify.body.output_error import DecaySamples
from ssmr_ident.identify.posterior.most_probable import Observation, Posterior, Unknown, most_probable
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.slots import Effects
from ssmr_ident.signals.noise import samples_together, whiteness

Array = np.ndarray

SETTLED = 0.05
"""Largest move of any parameter, in its standard deviations, at which the defect correction has settled."""

CORRECTIONS = 5
"""Defect corrections tried; decays of a few degrees settle in two, sliding contacts hardly ever."""

WORSE = 10.0
"""Rise of chi-square (odds of 150 to 1) at which the simulator is said to show what the recordings do not."""

HOPELESS = 1.2
"""Rise of the samples' chi-square, before any parameter moves, from which no refit is tried."""

ROUNDS = 4
"""Times that the trust in each channel is worked out anew."""

SAME_TRUST = 0.3
"""Change of a channel's noise, in the logarithm, at which its trust counts as settled."""

NOTICED = 1.2
"""Variance over the noise's from which a residual is looked at for structure."""

SPREAD = 0.7
"""Standard deviation of random starts about the prior, in prior standard deviations."""


@dataclass(frozen=True, eq=False)
class BodyFit:
    """Output error of a robot's decays.

    Parameters
    ----------
    posterior : Posterior
    decays : tuple of BodyDecay
        With the noise that was found.
    distrust : tuple of (c,) float
        Factor on each channel's noise with which it counted: 1 where the model leaves nothing behind.
    agreeing, tried : int
        Starts that led to the best optimum, and all.
    settled : bool
        False where the simulator's own motion fits worse, or its correction did not come to rest; the fit is then that
        of small motions.
    largest_defect : float
        Largest difference between the two over all samples, in noise standard deviations.
    """

    posterior: Posterior
    decays: tuple[BodyDecay, ...]
    distrust: tuple[Array, ...]
    agreeing: int
    tried: int
    settled: bool
    largest_defect: float


def fit_body(
    decays: Sequence[BodyDecay],
    builder: Callable[[Mapping[str, float]], Robot],
    unknowns: Sequence[Unknown],
    observations: Sequence[Observation] = (),
    start: Mapping[str, float] | None = None,
    random_starts: int = 1,
    seed: int = 0,
    effects: Effects | None = None,
) -> BodyFit:
    """Maximum a posteriori over the samples of all decays and other observations together.

    Parameters
    ----------
    decays : sequence of BodyDecay
    builder : callable
        From parameter values to a Robot.
    unknowns : sequence of Unknown
    observations : sequence of Observation
        Of other experiments.
    start : mapping of str to float, optional
        A first start, such as the fit of the modes; the prior is always one.
    random_starts : int
        Drawn about the prior.
    seed : int
    effects : mapping, optional
        Physics beyond the baseline that the simulator runs with.

    Returns
    -------
    BodyFit

    Notes
    -----
    Noise is first guessed from second differences; where the fitted model leaves the second half of a record quiet,
    its level and colour are taken from the residual there, and the fit is repeated. Channels in which the best fit
    leaves structure then count less (``distrust_of``), so that a model that misses something does not leave the
    priors for it.
    """
    rng = np.random.default_rng(seed)
    decays = tuple(decays)
    samples = DecaySamples(decays, builder)
    starts: list[Mapping[str, float]] = [start] if start else []
    starts.append({u.name: u.prior for u in unknowns})
    starts += [_drawn(unknowns, rng) for _ in range(random_starts)]
    fits = [most_probable(unknowns, observations, [samples], begin, max_iterations=60) for begin in starts]
    costs = np.array([_cost(fit) for fit in fits])
    best = fits[int(np.argmin(costs))]
    agreeing = int(np.sum(costs < costs.min() + 1.0))

    noise = [np.array([n.std for n in decay.noises]) for decay in decays]
    residuals = best.systems[0].residuals
    decays = tuple(
        decay.with_noise_of(residual * std, spent=6)
        for decay, residual, std in zip(decays, residuals, noise, strict=True)
    )
    begins: list[Mapping[str, float]] = [_values(best)]
    best, settled, largest = _with_simulator(decays, builder, unknowns, observations, begins, effects)
    distrust = [np.ones(len(decay.axes)) for decay in decays]
    begins = starts[:1]
    for _ in range(ROUNDS):
        left = [residual * size for residual, size in zip(best.systems[0].residuals, distrust, strict=True)]
        wanted = [distrust_of(residual) for residual in left]
        change = max(float(np.max(np.abs(np.log(new / old)))) for new, old in zip(wanted, distrust, strict=True))
        if change < SAME_TRUST:
            break
        distrust = wanted
        less = tuple(decay.trusted_less(size) for decay, size in zip(decays, distrust, strict=True))
        best, settled, largest = _with_simulator(
            less, builder, unknowns, observations, [_values(best), *begins], effects
        )
        begins = []
    return BodyFit(best, decays, tuple(distrust), agreeing, len(starts), settled, largest)


def distrust_of(residual: Array) -> Array:
    """Factor on each channel's noise, (c,) float, so that a model's own error counts as the noise that it is.

    Parameters
    ----------
    residual : (n, c) float
        In standard deviations of the measured noise.

    Notes
    -----
    A residual with structure is no white noise of the sensor's level: taken for it, a thousand samples of one and
    the same error would outvote everything known beforehand. Its variance in the first quarter v and the number of
    samples that go together, τ = 1 + 2Σρ², say for how many it counts: n/(vτ) instead of n. Channels that pass for
    white keep 1.
    """
    early = residual[: max(len(residual) // 4, 16)]
    sizes = np.ones(residual.shape[1])
    for c in range(residual.shape[1]):
        part = early[:, c]
        variance = float(np.mean(part**2))
        if variance < NOTICED or whiteness(residual[:, c]) > 1e-4:
            continue
        sizes[c] = np.sqrt(max(variance * samples_together(part), 1.0))
    return sizes


def _with_simulator(
    decays: Sequence[BodyDecay],
    builder: Callable[[Mapping[str, float]], Robot],
    unknowns: Sequence[Unknown],
    observations: Sequence[Observation],
    begins: Sequence[Mapping[str, float]],
    effects: Effects | None,
) -> tuple[Posterior, bool, float]:
    """Fit small motions from several starts, then take the simulator's own motion out until the fit is at rest.

    Returns
    -------
    (Posterior, bool, float)
        The last two: whether the correction settled, and the largest defect in noise standard deviations.
    """
    plain = DecaySamples(decays, builder)
    small = min((most_probable(unknowns, observations, [plain], b, max_iterations=60) for b in begins), key=_cost)
    best, largest = small, 0.0
    for _ in range(CORRECTIONS):
        values, states = _values(best), best.systems[0].starts
        try:
            defects = [defect(d, builder(values), x, effects) for d, x in zip(decays, states, strict=True)]
        except SimulationError:
            return small, False, largest
        largest = max(float(np.max(np.abs(d.whitened(part)))) for d, part in zip(decays, defects, strict=True))
        samples = DecaySamples(decays, builder, defects)
        if samples.cost(values) > HOPELESS * small.systems[0].cost + WORSE:
            return small, False, largest
        after = most_probable(unknowns, observations, [samples], values, max_iterations=30)
        if _cost(after) > _cost(small) + WORSE:
            return small, False, largest
        moved = float(np.max(np.abs(after.values - best.values) / after.stds))
        best = after
        if moved < SETTLED:
            return best, True, largest
    return best, False, largest


def _drawn(unknowns: Sequence[Unknown], rng: np.random.Generator) -> dict[str, float]:
    """A start about the prior; what is above 0 beforehand stays above 0, so that no motion grows."""
    start = {}
    for unknown in unknowns:
        value = unknown.value(SPREAD * rng.standard_normal()) if unknown.prior_std is not None else unknown.prior
        start[unknown.name] = max(value, 0.2 * unknown.prior) if unknown.prior > 0 else value
    return start


def _values(posterior: Posterior) -> dict[str, float]:
    return {u.name: float(v) for u, v in zip(posterior.unknowns, posterior.values, strict=True)}


def _cost(posterior: Posterior) -> float:
    scaled = [u.scaled(v) for u, v in zip(posterior.unknowns, posterior.values, strict=True)]
    return float(np.sum(np.square(scaled))) + posterior.chi_square + sum(s.cost for s in posterior.systems)
