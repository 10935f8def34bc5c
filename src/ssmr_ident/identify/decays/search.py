"""Search for the modes of a decay: starts, one mode more at a time, and how many the record supports."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from ssmr_ident.core.errors import InputError
from ssmr_ident.identify.decays.poles import Block, PoleFit, fit_poles, modelled
from ssmr_ident.identify.decays.record import Noises, Record, quiet_from, whitened_blocks
from ssmr_ident.identify.decays.start import spectral_poles

Array = np.ndarray


def ladder(
    records: Sequence[Record],
    noises: Noises,
    top: int,
    wanted: int | None,
    warm: dict[int, PoleFit] | None = None,
) -> dict[int, PoleFit]:
    """Fits with 1, 2, … modes, each from several starts; stops early where nothing is left to explain."""
    blocks = whitened_blocks(records, noises)
    index = int(np.argmax([float(np.sum(np.var(block.samples, axis=0))) for block in blocks]))
    loudest = blocks[index]
    fits: dict[int, PoleFit] = {}
    residual = loudest.samples
    for count in range(1, top + 1):
        starts: list[Array] = []
        if warm and count in warm:
            starts.append(-warm[count].rates + 1j * warm[count].frequencies)
        else:
            cleaned = loudest.samples - _lines_only(loudest)
            starts += [spectral_poles(cleaned, loudest.step, count, bins * count) for bins in (3, 6, 14)]
        if fits and not (warm and count in warm):
            known = -fits[count - 1].rates + 1j * fits[count - 1].frequencies
            more = [spectral_poles(residual, loudest.step, 1, bins) for bins in (3, 8)]
            starts += [np.concatenate([known, pole]) for pole in more if len(pole)]
        usable = [_inside(pole, loudest) for pole in starts if len(pole) == count]
        if not usable:
            break
        if count == 1 and len(usable) > 1:
            costs = [fit_poles(blocks, -p.real, p.imag, max_iterations=0).cost for p in usable]
            usable = [usable[int(np.argmin(costs))]]
        candidates = [fit_poles(blocks, -pole.real, pole.imag) for pole in usable]
        sensible = [fit for fit in candidates if _sensible(fit, blocks)]
        if not sensible and fits:
            break
        fits[count] = min(sensible or candidates, key=lambda fit: fit.cost)
        residual = loudest.samples - modelled(loudest, fits[count], index)
        if count < top and wanted is None and not (warm and count + 1 in warm) and not _something_left(residual):
            break
    if not fits:
        raise InputError("decay", "no oscillation stands out of the noise", "Look at the record with ident inspect.")
    return fits


def _sensible(fit: PoleFit, blocks: Sequence[Block]) -> bool:
    """Every mode oscillates within the record, decays, and is not a mere transient of the filter."""
    longest = max(len(block.samples) * block.step for block in blocks)
    damping = fit.rates / np.hypot(fit.rates, fit.frequencies)
    return bool(
        np.all(fit.frequencies > 2 * np.pi * 0.5 / longest)
        and np.all(damping < 0.7)
        and np.all(fit.rates * longest > -1.0)
        and np.all(fit.frequencies < 0.9 * np.pi / max(block.step for block in blocks))
    )


def _something_left(residual: Array) -> bool:
    """Does a white-noise residual have a peak, five bins wide, that chance gives once in 20 records?"""
    power = np.sum(np.abs(np.fft.rfft(residual - residual.mean(axis=0), axis=0)[1:-1]) ** 2, axis=1)
    scaled = power / (power.mean() + 1e-300) * residual.shape[1]
    if len(scaled) < 10:
        return False
    merged = np.convolve(scaled, np.ones(5), mode="valid")
    return bool(2 * merged.max() > chi2.isf(0.05 / len(merged), 10 * residual.shape[1]))


def _lines_only(block: Block) -> Array:
    """Lines and offset as the whole record shows them: good enough for starting values."""
    result: Array = block.nuisances @ np.linalg.lstsq(block.nuisances, block.samples, rcond=None)[0]
    return result


def _inside(poles: Array, block: Block) -> Array:
    """Start poles moved to where a mode can be: it decays, and it oscillates."""
    frequency = np.clip(np.abs(poles.imag), 2 * np.pi / (len(block.samples) * block.step), 0.9 * np.pi / block.step)
    rate = np.clip(-poles.real, 2e-3 * frequency, 0.5 * frequency)
    result: Array = -rate + 1j * frequency
    return result


def evidence(records: Sequence[Record], noises: Noises, fits: dict[int, PoleFit]) -> dict[int, float]:
    """Schwarz's criterion of each number of modes, on the whitened residual.

    The samples that count are those during which the motion stands above the whitened noise: the quiet tail
    says nothing about the modes, and coloured samples count for less than their number.
    """
    blocks = whitened_blocks(records, noises)
    richest = fits[max(fits)]
    variance = max(richest.cost / max(richest.samples - 4 * max(fits) * len(blocks), 1), 1e-300)
    telling = 0
    for index, (record, block) in enumerate(zip(records, blocks, strict=True)):
        telling += int(np.sum(quiet_from(record, block, richest, index, below=0.1)))
    series = sum(block.samples.shape[1] for block in blocks)
    penalty = np.log(max(telling, 16))
    return {count: fit.cost / variance + count * (2 + 2 * series) * penalty for count, fit in fits.items()}
