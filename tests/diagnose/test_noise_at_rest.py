"""The colour of noise is taken from where nothing moves any more, and stands in every recording of that sensor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy.signal import lfilter

from ssmr_ident.diagnose.noise_at_rest import coloured, colours_at_rest, colours_left
from ssmr_ident.identify.trials import Trial
from ssmr_ident.signals.noise import AutoregressiveNoise, white_noise


@dataclass(frozen=True)
class Logged:
    """What of a trial is asked."""

    channels: tuple[str, ...]
    noises: tuple[AutoregressiveNoise, ...]
    at_rest: np.ndarray | None
    step: float = 0.005
    colour: Callable[[np.ndarray], np.ndarray] | None = None

    def with_noises(self, noises: tuple[AutoregressiveNoise, ...]) -> Logged:
        return replace(self, noises=noises)


def logged(length: int, seed: int, size: float = 0.01) -> Trial:
    random = np.random.default_rng(seed)
    slow = lfilter([1.0], [1.0, -0.8], random.standard_normal(length + 200))[200:]
    rest = size * np.column_stack([slow, random.standard_normal(length)])
    return cast("Trial", Logged(("ax", "ay"), tuple(white_noise(c) for c in rest.T), rest))


def test_one_sensor_has_one_colour_and_every_recording_its_size() -> None:
    trials = [logged(250, seed) for seed in range(5)]
    colours = colours_at_rest(trials)
    assert colours["ax", 0.005].filter[1] == pytest.approx(-0.8, abs=0.1)
    assert colours["ay", 0.005].order == 0
    louder = logged(250, 7, size=0.03)
    for trial, size in ((trials[0], 0.01), (louder, 0.03)):
        ax, ay = coloured(trial, colours).noises
        assert ax.std == pytest.approx(size, rel=0.2)
        assert ay.std == pytest.approx(size, rel=0.2)
        assert trial.at_rest is not None
        assert ax.whiten(trial.at_rest[:, 0]).std() == pytest.approx(1.0, abs=0.2)


def test_means_over_other_steps_have_a_colour_of_their_own() -> None:
    trials = [logged(250, seed) for seed in range(5)]
    slower = replace(logged(250, 8), step=0.01)  # type: ignore[call-arg]
    assert coloured(slower, colours_at_rest([*trials, slower])).noises == slower.noises


def test_what_a_fit_leaves_has_the_colour_of_its_noise() -> None:
    trials = [logged(250, seed) for seed in range(5)]
    left = [replace(t, colour=lambda modelled, t=t: t.at_rest - modelled) for t in trials]  # type: ignore[call-arg]
    fit = SimpleNamespace(trials=left, simulated=[np.zeros((250, 2))] * len(left))
    assert colours_left(fit)["ax", 0.005].filter[1] == pytest.approx(-0.8, abs=0.1)  # type: ignore[arg-type]
    assert colours_left(fit)["ay", 0.005].order == 0  # type: ignore[arg-type]


def test_too_little_at_rest_leaves_noise_as_it_was() -> None:
    trials = [logged(250, seed) for seed in range(3)]
    never = [replace(t, at_rest=None) for t in trials]
    for few in (trials, never):
        assert colours_at_rest(few) == {}
        assert coloured(trials[0], {}).noises == trials[0].noises
