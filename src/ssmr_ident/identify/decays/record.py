"""Records prepared for a decay fit: start, mains line, noise model, whitened blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.identify.decays.poles import Block, PoleFit, modelled
from ssmr_ident.identify.decays.release import find_release
from ssmr_ident.signals.noise import AutoregressiveNoise, mains_lines, nuisance_columns, quiet_noise

Array = np.ndarray
Noises = Sequence[Sequence[AutoregressiveNoise]]


@dataclass(frozen=True)
class Record:
    """One prepared record: samples from its start on, times counted from there."""

    samples: Array
    step: float
    start: int
    start_s: float
    lines: tuple[float, ...]

    @property
    def times(self) -> Array:
        return self.step * np.arange(len(self.samples))


def prepare(time: Array, samples: Array, start_s: float | None, mains_hz: float | None, number: int) -> Record:
    where = f"decay record {number + 1}"
    time, samples = np.asarray(time, float), np.asarray(samples, float)
    if samples.ndim == 1:
        samples = samples[:, None]
    if len(time) != len(samples) or len(time) < 64:
        raise InputError(where, f"{len(time)} times and {len(samples)} samples; at least 64 of each are needed")
    if not np.all(np.isfinite(samples)):
        raise InputError(where, "samples hold NaN or infinity", "Cut the record, or read it without the gap.")
    if np.any(np.ptp(samples, axis=0) == 0):
        raise InputError(where, "a channel is constant", "Take it out, or look whether the sensor was connected.")
    step = float(time[-1] - time[0]) / (len(time) - 1)
    uneven = float(np.max(np.abs(time - time[0] - step * np.arange(len(time))))) / step
    if uneven > 1.0:
        raise InputError(where, f"the time grid is uneven by {uneven:.1f} samples", "Resample it, or cut out the gap.")
    lines = () if mains_hz is None else mains_lines(samples[len(samples) // 3 :], step, mains_hz)
    start = find_release(samples, step, lines) if start_s is None else int(np.searchsorted(time, start_s - step / 2))
    if len(time) - start < 64:
        raise InputError(where, f"only {len(time) - start} samples follow the start of the decay", "Log for longer.")
    return Record(samples[start:], step, start, float(time[start]), lines)


def whitened_blocks(records: Sequence[Record], noises: Noises) -> list[Block]:
    blocks = []
    for record, channel_noises in zip(records, noises, strict=True):
        lost = max(noise.order for noise in channel_noises)
        white = np.column_stack(
            [
                noise.whiten(record.samples[:, channel])[lost - noise.order :]
                for channel, noise in enumerate(channel_noises)
            ]
        )
        times = record.times[lost:]
        blocks.append(Block(float(times[0]), record.step, white, nuisance_columns(times, record.lines)))
    return blocks


def quiet_from(record: Record, block: Block, fit: PoleFit, index: int, below: float) -> Array:
    """Per channel, the first sample at which the fitted envelope is below ``below`` noise stds."""
    modes = len(fit.rates)
    sizes = np.hypot(fit.coefficients[index][:modes], fit.coefficients[index][modes : 2 * modes])
    times = block.times
    envelope = np.exp(-np.outer(times, fit.rates)) @ sizes
    loud = envelope > below
    return np.where(loud.any(axis=0), len(times) - np.argmax(loud[::-1], axis=0), 0)


def noise_models(records: Sequence[Record], silent: Noises, fit: PoleFit) -> list[list[AutoregressiveNoise]]:
    """Noise of each channel from its quiet tail, or from the residual where no tail is quiet."""
    blocks = whitened_blocks(records, silent)
    models = []
    for index, (record, block) in enumerate(zip(records, blocks, strict=True)):
        residual = block.samples - modelled(block, fit, index)
        quiet = quiet_from(record, block, fit, index, below=0.3)
        channels = []
        for channel in range(residual.shape[1]):
            spent = 4 * len(fit.rates) + block.nuisances.shape[1]
            std = silent[index][channel].std
            channels.append(quiet_noise(residual[:, channel], quiet[channel], spent, std))
        models.append(channels)
    return models
