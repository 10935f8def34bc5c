"""From fitted poles to a result: standard deviations that hold for coloured residuals, amplitudes, offsets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.identify.decays.poles import Block, PoleFit, exponentials, modelled, solve_symmetric
from ssmr_ident.identify.decays.record import Noises, Record, quiet_from, whitened_blocks
from ssmr_ident.identify.decays.result import DecayFit, Mode
from ssmr_ident.signals.noise import long_run_variance, whiteness

Array = np.ndarray


def summarise(
    records: Sequence[Record],
    noises: Noises,
    fit: PoleFit,
    scores: dict[int, float],
    unit: str,
) -> DecayFit:
    blocks = whitened_blocks(records, noises)
    modes = len(fit.rates)
    active, all_residuals, p_values = [], [], []
    for index, (record, block) in enumerate(zip(records, blocks, strict=True)):
        residual = block.samples - modelled(block, fit, index)
        all_residuals.append(residual)
        ends = quiet_from(record, block, fit, index, below=1.0)
        for channel in range(residual.shape[1]):
            loud = residual[: max(int(ends[channel]), 64), channel]
            active.append(loud)
            p_values.append(whiteness(loud))
    linear = sum(part.size for part in fit.coefficients)
    freedom = max(fit.samples - linear - 2 * modes, 1)
    pooled = sum(float(np.sum(part**2)) for part in all_residuals) / freedom
    counted = sum(len(part) for part in active)
    misfit = sum(float(np.sum(part**2)) for part in active) / max(counted - linear - 2 * modes, 1)
    p_value = min(1.0, min(p_values) * len(p_values))

    bound = np.linalg.pinv(fit.information, hermitian=True)
    covariance = bound * max(pooled, 1e-300)
    if p_value <= 1e-3:
        sandwich = bound @ _score_variance(blocks, fit, all_residuals) @ bound
        scale = np.sqrt(np.maximum(np.diag(sandwich) / np.maximum(np.diag(covariance), 1e-300), 1.0))
        covariance = covariance * np.outer(scale, scale)
    natural = np.hypot(fit.rates, fit.frequencies)
    turn = np.zeros((2 * modes, 2 * modes))
    for k in range(modes):
        rate, frequency, total = fit.rates[k], fit.frequencies[k], natural[k]
        turn[2 * k, 2 * k : 2 * k + 2] = rate / total, frequency / total
        turn[2 * k + 1, 2 * k : 2 * k + 2] = frequency**2 / total**3, -rate * frequency / total**3
    covariance = turn @ covariance @ turn.T
    bounds = np.sqrt(np.maximum(np.diag(turn @ bound @ turn.T), 0.0))
    stds = np.sqrt(np.maximum(np.diag(covariance), 0.0))

    amplitudes, amplitude_stds, phases, offsets, lines = _linear_parts(
        records, noises, blocks, fit, max(pooled, 1e-300)
    )
    return DecayFit(
        modes=tuple(
            Mode(
                omega_n=float(natural[k]),
                omega_n_std=float(stds[2 * k]),
                omega_n_bound=float(bounds[2 * k]),
                xi=float(fit.rates[k] / natural[k]),
                xi_std=float(stds[2 * k + 1]),
                xi_bound=float(bounds[2 * k + 1]),
                correlation=float(covariance[2 * k, 2 * k + 1] / max(stds[2 * k] * stds[2 * k + 1], 1e-300)),
                amplitudes=amplitudes[:, :, k],
                amplitude_stds=amplitude_stds[:, :, k],
                phases=phases[:, :, k],
            )
            for k in range(modes)
        ),
        covariance=covariance,
        offsets=offsets,
        starts_s=tuple(record.start_s for record in records),
        noise_stds=np.array([[noise.std for noise in channels] for channels in noises]),
        noise_orders=tuple(noise.order for channels in noises for noise in channels),
        mains_hz=tuple(record.lines[0] if record.lines else None for record in records),
        mains_amplitudes=lines,
        evidence=scores,
        misfit=float(misfit),
        whiteness_p=float(p_value),
        samples=fit.samples,
        iterations=fit.iterations,
        unit=unit,
        blocks=tuple(blocks),
    )


def _tangents(block: Block, fit: PoleFit, index: int, channel: int) -> tuple[Array, Array]:
    """Linear columns (n, 2k + p), and derivatives by (λ_1, ω_1, …) (n, 2k) of one channel."""
    modes = len(fit.rates)
    waves = exponentials(block, fit.rates, fit.frequencies)
    moved = waves * block.times[:, None]
    coefficients = fit.coefficients[index][:, channel]
    slopes = np.empty((len(waves), 2 * modes))
    for k in range(modes):
        cosine, sine = coefficients[k], coefficients[modes + k]
        slopes[:, 2 * k] = -(cosine * moved[:, k].real + sine * moved[:, k].imag)
        slopes[:, 2 * k + 1] = sine * moved[:, k].real - cosine * moved[:, k].imag
    return np.hstack([waves.real, waves.imag, block.nuisances]), slopes


def _score_variance(blocks: Sequence[Block], fit: PoleFit, residuals: Sequence[Array]) -> Array:
    """Middle of the sandwich: variance of the gradient with residuals correlated over one and a half periods."""
    slowest = float(np.min(fit.frequencies))
    total = np.zeros((2 * len(fit.rates),) * 2)
    for index, block in enumerate(blocks):
        bandwidth = min(round(1.5 * 2 * np.pi / slowest / block.step), len(block.samples) // 4)
        for channel in range(block.samples.shape[1]):
            linear, slopes = _tangents(block, fit, index, channel)
            clean = slopes - linear @ solve_symmetric(linear.T @ linear, linear.T @ slopes)
            total += long_run_variance(clean * residuals[index][:, channel : channel + 1], bandwidth)
    return total


def _linear_parts(
    records: Sequence[Record],
    noises: Noises,
    blocks: Sequence[Block],
    fit: PoleFit,
    variance: float,
) -> tuple[Array, Array, Array, Array, Array]:
    """Amplitudes, their stds, phases (r, c, k), offsets and mains amplitudes (r, c), the whitening undone."""
    modes = len(fit.rates)
    shape = (len(blocks), blocks[0].samples.shape[1])
    amplitudes, stds, phases = np.empty((*shape, modes)), np.empty((*shape, modes)), np.empty((*shape, modes))
    offsets, lines = np.empty(shape), np.zeros(shape)
    poles = -fit.rates + 1j * fit.frequencies
    for index, (record, block) in enumerate(zip(records, blocks, strict=True)):
        for channel in range(shape[1]):
            noise = noises[index][channel]
            coefficients = fit.coefficients[index][:, channel]
            gain = noise.gain(poles, record.step) / noise.std
            # p Re z + q Im z = Re((p - iq) z); with A sin(wt + B): A sin B = p, A cos B = q.
            complex_size = (coefficients[:modes] - 1j * coefficients[modes : 2 * modes]) / gain
            amplitudes[index, channel] = np.abs(complex_size)
            phases[index, channel] = np.arctan2(complex_size.real, -complex_size.imag)
            linear, slopes = _tangents(block, fit, index, channel)
            columns = np.hstack([linear, slopes])
            spread = np.linalg.pinv(columns.T @ columns, hermitian=True) * variance
            for k in range(modes):
                part = spread[np.ix_([k, modes + k], [k, modes + k])]
                along = np.array([coefficients[k], coefficients[modes + k]])
                size = max(float(np.linalg.norm(along)), 1e-300)
                stds[index, channel, k] = np.sqrt(max(along @ part @ along, 0.0)) / size / abs(gain[k])
            offsets[index, channel] = coefficients[2 * modes] * noise.std / float(np.sum(noise.filter))
            if record.lines:
                size = float(np.hypot(*coefficients[2 * modes + 1 : 2 * modes + 3]))
                lines[index, channel] = size / abs(noise.gain(np.array([2j * np.pi * record.lines[0]]), record.step)[0])
                lines[index, channel] *= noise.std
    return amplitudes, stds, phases, offsets, lines
