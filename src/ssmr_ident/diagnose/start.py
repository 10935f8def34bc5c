"""Where a baseline's fit begins: near enough that no oscillation is taken for its neighbour."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.decays.fit import fit_decay
from ssmr_ident.identify.decays.result import Mode
from ssmr_ident.identify.fitting.coordinates import scaled_at
from ssmr_ident.identify.fitting.curvature import Curvature
from ssmr_ident.identify.fitting.descent import search_again
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.posterior.most_probable import most_probable
from ssmr_ident.identify.robot.unknowns import match_further, modal_observations, pick_mode, predicted_modes
from ssmr_ident.identify.trials import Trial

SEEN_BY = {"roll": "ay", "pitch": "ax", "yaw": "ay"}
"""Channels that show a motion best (5.8)."""

MOST_MODES = 3

POOLED_STEPS = 10
"""Gauss-Newton steps of least squares that all recordings share, at the most."""


def begin(trials: Sequence[Trial], setup: Setup, parameters: ParameterSet) -> JointFit:
    """The better of two places: what is known beforehand, and what modes of the recordings say."""
    points = [np.zeros(len(setup.model.physics))]
    guess = _guess(trials, setup, parameters)
    if guess:
        points.append(scaled_at(setup.model.physics, guess))
    fits = []
    for point in points:
        values, effects = setup.model.split(point)
        nuisances = [trial.begin(values, effects) for trial in trials]
        fits.append(evaluate(trials, setup.model, point, nuisances))
    best = min(fits, key=lambda fit: fit.rss if np.isfinite(fit.rss) else np.inf)
    return pooled(best) if all(trial.channels == ("force",) for trial in trials) else best


def pooled(fit: JointFit) -> JointFit:
    """Least squares over all recordings with one size of misfit for all of them.

    Where a recording's own misfit is its measure, one that happens to be explained first outweighs the others ever
    after. Pulls begin far enough away for that: where a wheel lets go is a corner in the force.
    """
    for _ in range(POOLED_STEPS):
        fit = differentiate(search_again(fit))
        count = fit.independent

        def cost(at: JointFit, count: float = count) -> float:
            return count * float(np.log(at.rss)) + at.penalty if np.isfinite(at.rss) else np.inf

        best, curvature = fit, Curvature.of(fit, np.full(len(fit.trials), count / fit.rss))
        for damping in (0.0, 0.1, 1.0, 10.0, 100.0):
            move, own = curvature.step(damping)
            nuisances = [n + o for n, o in zip(fit.nuisances, own, strict=True)]
            best = min(best, evaluate(fit.trials, fit.model, fit.point + move, nuisances, fit.slopes), key=cost)
        gain, fit = cost(fit) - cost(best), best
        if gain < 1.0:
            break
    return fit


def _guess(trials: Sequence[Trial], setup: Setup, parameters: ParameterSet) -> dict[str, float]:
    names = {trial.name for trial in trials}
    used = [m for m in setup.campaign.measurements if m.name in names]
    return _by_modes(setup, used, parameters) if setup.campaign.session.baseline in ("rigid6", "decoupled") else {}


def _by_modes(setup: Setup, used: list[Measurement], parameters: ParameterSet) -> dict[str, float]:
    builder = RobotBuilder.of(parameters)
    expected = predicted_modes(builder({}), decoupled=False)
    modes: dict[str, list[Mode]] = {}
    for m in used:
        motion = m.entry.motion
        if motion is None or SEEN_BY[motion] not in m.recording:
            continue
        channel = SEEN_BY[motion]
        try:
            fit = fit_decay(m.recording.time, m.recording[channel], max_modes=MOST_MODES, unit="m/s^2")
        except InputError:
            continue  # no decaying mode in it: the fit of samples begins at the prior
        mode = pick_mode(fit, expected.get(motion))
        modes.setdefault(motion, []).append(mode)
        for name, other in match_further(fit.modes, mode, expected).items():
            modes.setdefault(name, []).append(other)
    if not modes:
        return {}
    posterior = most_probable(setup.model.physics, modal_observations(modes, builder, setup.decoupled))
    return {u.name: float(v) for u, v in zip(posterior.unknowns, posterior.values, strict=True)}
