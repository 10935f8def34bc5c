"""Colour of noise: from where recordings go on after the motion is over, before anything is fitted; else from what a
model leaves that follows them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.trials import Trial
from ssmr_ident.signals.noise import AutoregressiveNoise, background_noise

Grid = tuple[str, float]
"""Channel and step [s]: means over other steps have another colour."""

LARGEST_ORDER = 8
"""Of the autoregressive noise of block averages."""

ENOUGH = 1000
"""Samples at rest, of all recordings together, that tell the noise's colour: seven windows, thirteen that overlap."""


def colours_at_rest(trials: Sequence[Trial]) -> dict[Grid, AutoregressiveNoise]:
    """Noise by channel and step in sizes of what its differences show, for one sensor logged all recordings; none where
    they are too short to tell its colour."""
    found: dict[Grid, list[np.ndarray]] = {}
    for trial in trials:
        if trial.at_rest is not None and len(trial.at_rest):
            for name, noise, rest in zip(trial.channels, trial.noises, trial.at_rest.T, strict=True):
                found.setdefault(_grid(trial, name), []).append(rest / noise.std)
    enough = {name: rests for name, rests in found.items() if sum(map(len, rests)) >= ENOUGH}
    return {name: background_noise(rests, LARGEST_ORDER) for name, rests in enough.items()}


def colours_left(fit: JointFit) -> dict[Grid, AutoregressiveNoise]:
    """The same of what a fit leaves."""
    found: dict[Grid, list[np.ndarray]] = {}
    for trial, modelled in zip(fit.trials, fit.simulated, strict=True):
        for name, noise, rest in zip(trial.channels, trial.noises, trial.colour(modelled).T, strict=True):
            found.setdefault(_grid(trial, name), []).append(rest / noise.std)
    return {name: background_noise(rests, LARGEST_ORDER) for name, rests in found.items()}


def coloured(white: Trial, colours: Mapping[Grid, AutoregressiveNoise]) -> Trial:
    """A recording whose noise has the colours that are known, as large as its own differences show."""
    own = [(colours.get(_grid(white, c)), noise) for c, noise in zip(white.channels, white.noises, strict=True)]
    return white.with_noises(tuple(noise if colour is None else colour.louder(noise.std) for colour, noise in own))


def _grid(trial: Trial, channel: str) -> Grid:
    return channel, round(trial.step, 6)
