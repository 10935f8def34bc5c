"""Joint fits: what correlated samples are worth, and that eliminating nuisances leaves the full least squares."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.signal import lfilter

from ssmr_ident.experiments import FORCED
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.curvature import Curvature
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.fitting.scatter import covariance as scatter_of
from ssmr_ident.identify.posterior.objective import Unknown
from ssmr_ident.identify.trials import Trial, decay
from ssmr_ident.identify.trials.trial import Course
from ssmr_ident.signals.noise import AutoregressiveNoise, independent_samples

NAMES = ("a", "b", "c")
MODEL = Model(tuple(Unknown(name, "1", 0.0, 2.0, positive=False) for name in NAMES))


def test_white_samples_are_worth_themselves() -> None:
    shares = [independent_samples(np.random.default_rng(seed).standard_normal(4000)) / 4000 for seed in range(20)]
    assert min(shares) > 0.85
    assert np.mean(shares) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("phi", [0.5, 0.8, 0.95])
def test_correlated_samples_are_worth_what_bartlett_says(phi: float) -> None:
    """AR(1) has rho_k = phi^k, so 1 + 2 sum rho² = (1 + phi²)/(1 - phi²), whatever the sign of phi.

    What chance adds to a sum of squares is taken off as that of white noise; in correlated noise it is more, so the
    count may err, to the careful side, by a factor of up to 1/(1 + 2·0.22).
    """
    count, exact = 40_000, (1.0 - phi**2) / (1.0 + phi**2)
    whites = [np.random.default_rng(seed).standard_normal(count) for seed in range(10)]
    for sign in (1.0, -1.0):
        share = np.mean([independent_samples(lfilter([1.0], [1.0, -sign * phi], white)) / count for white in whites])
        assert 0.66 * exact < share < 1.06 * exact


def test_what_is_masked_or_short_or_silent_is_counted_as_it_is() -> None:
    white = np.random.default_rng(1).standard_normal(2000)
    masked = np.concatenate([white, np.zeros(3000)])
    assert independent_samples(masked) == independent_samples(white)
    assert independent_samples(white[:5]) == 5.0
    assert independent_samples(np.zeros(100)) <= 100.0
    assert independent_samples(3e-7 * white) == pytest.approx(independent_samples(white))


def _trial(shared: np.ndarray, own: np.ndarray, target: np.ndarray, scale: float, name: str) -> Trial:
    """A recording that is linear in everything: basis-free but for its zero."""

    def run(values: dict[str, float], effects: object, nuisance: np.ndarray) -> np.ndarray:
        return (shared @ [values[n] for n in NAMES] + own @ nuisance)[:, None]

    count = len(target)
    times = np.arange(count) / 100.0
    return Trial(
        name, FORCED, "", ("position",), times, target[:, None], (AutoregressiveNoise(np.ones(1), scale),),
        np.ones((count, 1)), run, lambda values, effects: np.zeros(own.shape[1]),
        tuple(f"n{i}" for i in range(own.shape[1])), np.ones(own.shape[1]),
        Course(times, target[:, None], run, ("m",), None),
    )  # fmt: skip


def _linear(seed: int = 4) -> tuple[JointFit, list[np.ndarray], list[np.ndarray], list[np.ndarray]]:
    """Three recordings with nuisances of their own, whitened blocks beside them, and a fit that stands at the prior."""
    random = np.random.default_rng(seed)
    truth = np.array([1.5, -0.7, 0.4])
    trials, shared, own, targets = [], [], [], []
    for index, (count, nuisances, noise) in enumerate(((300, 2, 0.1), (200, 1, 0.3), (400, 3, 0.05))):
        a, b = random.standard_normal((count, 3)), random.standard_normal((count, nuisances))
        b[:, 0] += a[:, 0]  # a nuisance that looks like the physics
        y = a @ truth + b @ random.standard_normal(nuisances) + noise * random.standard_normal(count) + 7.0
        trials.append(_trial(a, b, y, noise, f"{index}.csv"))
        centre = [block - block.mean(axis=0) for block in (2.0 * a, b, y)]  # coordinates are in units of the prior's 2
        for kept, block in zip((shared, own, targets), centre, strict=True):
            kept.append(block / noise)
    fit = evaluate(trials, MODEL, np.zeros(3), [np.zeros(len(t.nuisances)) for t in trials])
    return fit, shared, own, targets


def _full(
    fit: JointFit, shared: list[np.ndarray], own: list[np.ndarray], targets: list[np.ndarray], weights: np.ndarray
):  # type: ignore[no-untyped-def]
    """All coordinates at once, priors as rows: solution and covariance."""
    roots = np.sqrt(weights)
    rows = np.hstack(
        [np.vstack([w * a for w, a in zip(roots, shared, strict=True)]),
         block_diag(*(w * b for w, b in zip(roots, own, strict=True)))]
    )  # fmt: skip
    size = rows.shape[1]
    stacked = np.vstack([rows, np.eye(size)])
    right = np.concatenate([*(w * y for w, y in zip(roots, targets, strict=True)), np.zeros(size)])
    return np.linalg.lstsq(stacked, right)[0], np.linalg.inv(stacked.T @ stacked)


def test_one_step_with_nuisances_eliminated_is_the_full_least_squares_solution() -> None:
    fit, *blocks = _linear()
    expected, covariance = _full(fit, *blocks, fit.weights)
    # one iteration: Gauss-Newton is exact for what is linear; secants would go on to the weights of what is left
    found = descend(fit, 1, secants=0)
    solution = np.concatenate([found.point, *found.nuisances])
    assert solution == pytest.approx(expected, rel=1e-6, abs=1e-8)
    curvature, _ = Curvature.of(differentiate(fit), fit.weights).normal_equations()
    assert np.linalg.inv(curvature) == pytest.approx(covariance[:3, :3], rel=1e-6)


def test_a_descent_ends_where_each_recordings_own_misfit_is_its_measure() -> None:
    """The fixed point of reweighting: solving anew with the weights at the end changes nothing, and truth is near."""
    fit, *blocks = _linear(5)
    found = differentiate(descend(fit, 30, settled=1e-9))
    for _ in range(3):  # descents stop at a fall of the cost that says nothing; a few steps more are the limit
        found = differentiate(descend(found, 1, settled=0.0))
    expected, covariance = _full(found, *blocks, found.weights)
    spread = np.sqrt(np.diag(covariance)[:3])
    assert np.all(np.abs(found.point - expected[:3]) < 1e-3 * spread)
    assert np.all(np.abs(2.0 * found.point - [1.5, -0.7, 0.4]) < 4.0 * 2.0 * spread)
    assert found.parts / [t.size for t in found.trials] == pytest.approx(np.ones(3), abs=0.25)


def test_a_recording_that_the_model_does_not_explain_does_not_outvote_the_others() -> None:
    """A thousandfold misfit in one recording moves the answer by what that recording alone could have told."""
    fit, *_ = _linear(6)
    clean = descend(fit, 20)
    spread = np.sqrt(np.diag(scatter_of(differentiate(clean))))
    trials = list(fit.trials)
    noise = 50.0 * np.random.default_rng(3).standard_normal(trials[1].target.shape)
    trials[1] = replace(trials[1], target=trials[1].target + noise)
    spoilt = descend(evaluate(trials, MODEL, np.zeros(3), fit.nuisances), 20)
    assert np.all(np.abs(spoilt.point - clean.point) < 3.0 * spread)
    assert spoilt.weights[1] < 1e-3 * spoilt.weights[0]


def test_modes_that_run_away_tell_no_start_and_no_warning() -> None:
    columns = np.full((5, 3, 12), 1e200)
    assert not np.any(decay._linear_start(None, columns))  # type: ignore[arg-type]


@pytest.mark.parametrize("positive", [True, False])
def test_a_value_with_a_reach_never_leaves_it_and_is_the_plain_one_near_its_prior(positive: bool) -> None:
    held = Unknown("bandwidth", "Hz", 80.0, 10.0, positive, reach=3.0)
    plain = replace(held, reach=np.inf)
    for scaled in (-8.0, -2.0, -0.3, 0.0, 1.0, 2.5, 40.0):
        within = plain.scaled(held.value(scaled))
        assert abs(within) < 3.0
        assert held.scaled(held.value(scaled)) == pytest.approx(scaled, rel=1e-3)
        step = 1e-5 * max(1.0, abs(scaled))
        slope = (held.value(scaled + step) - held.value(scaled - step)) / (2.0 * step)
        assert held.slope(scaled) == pytest.approx(slope, rel=1e-4, abs=1e-7)
        if abs(scaled) <= 1.0:
            assert within == pytest.approx(scaled, rel=0.004)


def test_what_is_white_in_its_second_difference_is_infinitely_dense_at_rest() -> None:
    noise = AutoregressiveNoise(np.array([1.0, -2.0, 1.0]), 2.0)
    density = noise.density(np.array([0.0, 50.0]), 0.01)
    assert np.isinf(density[0])
    # at half the sampling rate the second difference is four times the sample
    assert density[1] == pytest.approx(2.0 * 0.01 * 4.0 / 16.0)


def test_coloured_noise_is_whitened_with_and_without_a_drift() -> None:
    count, std, pole = 300, 0.1, 0.6
    random = np.random.default_rng(8)
    target, shared, own = random.standard_normal(count), np.zeros((count, 3)), np.zeros((count, 1))
    noise = AutoregressiveNoise(np.array([1.0, -pole]), std)
    plain = replace(_trial(shared, own, target, std, "a.csv"), noises=(noise,))
    white = (target[1:] - pole * target[:-1]) / std
    np.testing.assert_allclose(plain.white_target, white - white.mean(), atol=1e-12)
    # a drift of unit size is size S in white noise of unit size: of it S/(1 + S^2)^(1/2) is left, and all beside it
    column = 0.2 * np.linspace(-1.0, 1.0, count)
    drifting = replace(plain, drift=column[:, None])
    size = np.linalg.norm(plain.whitened(column[:, None]))
    assert np.linalg.norm(drifting.whitened(column[:, None])) == pytest.approx(size / np.sqrt(1.0 + size**2))
    beside = target - column * (plain.whitened(column[:, None]) @ plain.white_target) / size**2
    np.testing.assert_allclose(drifting.whitened(beside[:, None]), plain.whitened(beside[:, None]), atol=1e-9)


def test_a_step_into_a_burst_is_no_slope() -> None:
    """A run that has grown to 1e200 beside one that has not says nothing, and its square would overflow."""
    fit, *_ = _linear()

    def bursting(trial: Trial) -> Trial:
        def run(values: dict[str, float], effects: object, nuisance: np.ndarray) -> np.ndarray:
            grown = 1e200 if values["b"] != 0.0 else 1.0
            return grown * trial.run(values, effects, nuisance)

        return replace(trial, run=run)

    trials = [bursting(trial) for trial in fit.trials]
    begun = differentiate(evaluate(trials, fit.model, np.zeros(3), fit.nuisances))
    for slopes in begun.slopes:
        assert np.all(slopes.shared[:, 1] == 0.0)
        assert np.all(np.any(slopes.shared[:, [0, 2]] != 0.0, axis=0))
    ended = descend(begun, 4)
    assert np.all(np.isfinite(ended.point))
    assert ended.rss < begun.rss
