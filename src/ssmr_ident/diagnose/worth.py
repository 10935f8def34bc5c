"""What an explanation is worth in the contract's metric, beside the noise floor; and the overlays that show it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import spearmanr

from ssmr_ident.compare.comparison import measure
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.compare.recorded import predicted
from ssmr_ident.diagnose.diagnosis import PredictionQuality
from ssmr_ident.diagnose.evidence import Overlay
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.trials.trial import Trial
from ssmr_ident.signals.band import series
from ssmr_ident.signals.noise import rounding, white_noise, without_mains

Array = np.ndarray

DRAWN = 3
"""Recordings of which an overlay is drawn, held-out ones first."""

WHITE = 0.25
"""Least share of a sensor's noise, by variance, that is white. What is more than such noise could leave is missing
wherever it sits: what is left of a sliding pull follows no motion."""

WINDOW_S, FEWEST = 0.5, 12
"""Length of the windows in which what is left is held against the motion, and how many are needed."""

BY_CHANCE = 1e-3
"""Probability by chance up to which what is left follows the motion."""

LONGEST = 3000
"""Points of an overlay."""

GRID = 500
"""Frequencies at which a spectrum is summed."""


def predictions(fit: JointFit) -> list[Prediction]:
    """Every recording of a fit, sample by sample; of a recording that is split in time, the part that counts."""
    values, effects = fit.model.split(fit.point)
    found = []
    for trial, nuisance in zip(fit.trials, fit.nuisances, strict=True):
        found.append(_with_noise(trial, _counted(trial, predicted(trial, values, effects, nuisance))))
    return found


def _with_noise(trial: Trial, prediction: Prediction) -> Prediction:
    if not any(noise.order for noise in trial.noises):
        return prediction
    return replace(prediction, noises=trial.noises, block=max(round(trial.step * prediction.sample_rate), 1))


def without_jolts(fit: JointFit, found: Sequence[Prediction]) -> list[Prediction]:
    """Predictions of a fit's recordings after the jolt of a cable that tightens, which no two pulls have alike.

    A recording of which that leaves less than half is kept whole.
    """
    cut = []
    for trial, prediction in zip(fit.trials, found, strict=True):
        after = prediction.time > (-np.inf if trial.jolt is None else trial.jolt[1])
        cut.append(_where(prediction, after) if after.mean() >= 0.5 else prediction)
    return cut


def _counted(trial: Trial, prediction: Prediction) -> Prediction:
    if trial.part is None:
        return prediction
    low, high = trial.part
    return _where(prediction, (prediction.time >= low) & (prediction.time <= high))


def _where(prediction: Prediction, inside: Array) -> Prediction:
    return replace(
        prediction,
        time=prediction.time[inside],
        measured=prediction.measured[inside],
        simulated=prediction.simulated[inside],
    )


def noise_floor(prediction: Prediction) -> float:
    """The metric that noise, rounding and hum alone would leave: noise of its known colour; else white noise, from what
    a prediction leaves at its fastest.

    Second differences see white noise and hardly any motion; the noise below the metric's low-pass is taken to be as
    dense as above it, and in a band as dense as its own. Mains lines pass the low-pass by its gain at theirs.
    """
    rate, rest = prediction.sample_rate, prediction.measured - prediction.simulated
    measured = prediction.judged(prediction.measured) if prediction.filtered else prediction.measured
    share = passed(prediction)
    clean, lines, waves = without_mains(rest, prediction.time)
    if prediction.high_pass_hz > 0.0 and prediction.low_pass_hz is not None:
        clean = series(clean, rate, (prediction.high_pass_hz, prediction.low_pass_hz))  # what lies beyond is filtered
    power = 0.5 * np.sum(np.repeat(prediction.gain(lines), 2)[:, None] ** 2 * waves**2, axis=0)
    scale = np.ones(measured.shape[1]) if len(set(prediction.units)) == 1 else measured.std(axis=0)
    noise = 0.0
    coloured = _coloured_variances(prediction)
    for c, (column, logged, own, size) in enumerate(zip(clean.T, prediction.measured.T, power, scale, strict=True)):
        # a tail that rests within one step of the converter has no differences
        random = coloured[c] if coloured else share * white_noise(column, rounding(logged)).std ** 2
        noise += (random + own) / size**2
    signal = float(np.sum(((measured - measured.mean(axis=0)) / scale).var(axis=0)))
    return 100.0 * float(np.sqrt(noise / signal))


def _coloured_variances(prediction: Prediction) -> list[float]:
    """What noise of known colour leaves of each channel, the metric's filter behind it."""
    step = prediction.block / prediction.sample_rate
    frequency = (np.arange(GRID) + 0.5) * (0.5 / step / GRID)
    turn = np.pi * frequency / prediction.sample_rate
    mean = np.sin(prediction.block * turn) / (prediction.block * np.sin(turn))  # a block's gain, taken back
    share = (prediction.gain(frequency) / mean) ** 2
    return [float(np.mean(share * noise.density(frequency, step)) * 0.5 / step) for noise in prediction.noises]


def passed(prediction: Prediction) -> float:
    """Share of white noise's variance that the metric's low-pass lets through."""
    return float(np.mean(prediction.gain(np.linspace(0.0, 0.5 * prediction.sample_rate, 4000)) ** 2))


def reddest(found: Sequence[Prediction]) -> float:
    """Error over the noise floor that noise reads at the most, of which a share of at least ``WHITE`` is white; 1 where
    its colour is known.

    The rest of it all lies below the low-pass, where the floor, taken at the fastest, sees nothing of it.
    """
    shares = np.array([passed(prediction) for prediction in found if not prediction.noises])
    return float(np.max(np.sqrt((1.0 - WHITE + WHITE * shares) / (WHITE * shares)), initial=1.0))


def over_any_noise(found: Sequence[Prediction]) -> Array:
    """Each recording's error over the most that noise of any colour reads in it, (r,) float."""
    return errors(found) / [noise_floor(prediction) * reddest([prediction]) for prediction in found]


def grows_with_motion(found: Sequence[Prediction]) -> float:
    """Probability by chance that what is left is as much larger where the simulated motion is larger.

    Spearman's rank correlation over half seconds of all recordings and channels. Noise of whatever colour does not
    know how large the motion is; missing physics does.
    """
    motion: list[float] = []
    left: list[float] = []
    for prediction in found:
        rate, rest = prediction.sample_rate, prediction.measured - prediction.simulated
        # a loud line rings where the low-pass sets in, and that is where decays are loud
        rest = without_mains(rest, prediction.time)[0]
        if prediction.filtered:
            rest = prediction.judged(rest)
        width = max(4, round(WINDOW_S * rate))
        count = len(rest) // width
        scale = prediction.measured.std(axis=0)
        for c in range(rest.shape[1]):
            parts = [a[: count * width, c].reshape(count, width).std(axis=1) for a in (prediction.simulated, rest)]
            # channels in different units, or with different noise, are told apart by their own size
            unit = 1.0 if len(set(prediction.units)) == 1 else scale[c]
            motion += list(parts[0] / unit)
            left += list(parts[1] / unit)
    # a block that slides shows one force, which nothing can grow with
    if len(motion) < FEWEST or np.ptp(motion) == 0.0:
        return 1.0
    return float(spearmanr(motion, left, alternative="greater").pvalue)


def errors(found: Sequence[Prediction]) -> Array:
    """The contract's metric of each recording, (r,) float."""
    return np.array([measure(prediction)[0] for prediction in found])


def worth(before: Sequence[Prediction], after: Sequence[Prediction], names: Sequence[str]) -> PredictionQuality:
    """Means over recordings, and the 95 % interval of the improvement by bootstrap over recordings."""
    first = errors(before)
    second = first if after is before else errors(after)
    floor = np.array([noise_floor(p) for p in after])
    gain = first - second
    interval = None
    if len(gain) > 1:
        rng = np.random.default_rng(20120510)
        means = gain[rng.integers(0, len(gain), (2000, len(gain)))].mean(axis=1)
        interval = (float(np.quantile(means, 0.025)), float(np.quantile(means, 0.975)))
    return PredictionQuality(float(first.mean()), float(second.mean()), float(floor.mean()), tuple(names), interval)


def overlays(
    names: Sequence[str], before: Sequence[Prediction], after: Sequence[Prediction], heldout: bool
) -> tuple[Overlay, ...]:
    """The channel that moves most, of the recordings that gained most."""
    first, second = errors(before), errors(after)
    chosen = np.argsort(second - first, kind="stable")[:DRAWN]
    return tuple(
        _overlay(names[k], before[k], after[k], heldout, (float(first[k]), float(second[k]))) for k in chosen.tolist()
    )


def _overlay(
    name: str, before: Prediction, after: Prediction, heldout: bool, measured_by: tuple[float, float]
) -> Overlay:
    courses = [before.measured, before.simulated, after.simulated]
    if before.filtered:
        courses = [before.judged(course) for course in courses]
    channel = int(np.argmax(courses[0].std(axis=0)))
    every = max(1, len(before.time) // LONGEST)
    measured, first, second = (course[::every, channel] for course in courses)
    return Overlay(
        name,
        before.names[channel],
        before.units[channel],
        heldout,
        before.time[::every],
        measured,
        first,
        second,
        (*measured_by, noise_floor(after)),
    )
