"""The contract's ``log_psd_db`` between recordings and simulated spectra, and how far a recording repeats itself."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.doctor.swivels.bench import Bench
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.likelihood import NEPER_DB
from ssmr_ident.doctor.swivels.spectra import Look
from ssmr_ident.physics.slots import Effects


def channel_logs(one: Look, noise: np.ndarray | None = None) -> np.ndarray:
    """(k, c) float: natural logarithms of the channels' densities."""
    density = np.einsum("kii->ki", one.cross)
    return np.log(np.maximum(density if noise is None else density + noise, 1e-30))


def distance_db(first: np.ndarray, second: np.ndarray) -> float:
    """Rms difference over frequency, mean over channels; (k, c) natural logarithms each."""
    bins = min(len(first), len(second))
    return float(np.mean(np.sqrt(np.mean((first[:bins] - second[:bins]) ** 2, axis=0)))) * NEPER_DB


def against_simulation(
    bench: Bench,
    conditions: tuple[Condition, ...],
    values: Mapping[str, float],
    effects: Effects,
    seeds: tuple[int, ...],
) -> dict[str, float]:
    """Distance of every recording from the nearest of several simulated runs of its length and their mean [dB].

    The alternatives are those of the likelihood: a robot that shakes in two ways is told by the one that was recorded.
    Empty for a run that fails.
    """
    bench.prefetch((c, values, effects, seed) for c in conditions for seed in seeds)
    found = {}
    for c in conditions:
        runs = [bench.run(c, values, effects, part) for part in (seeds, *((seed,) for seed in seeds))]
        logs = [channel_logs(run.look, c.noise) for run in runs if run is not None]
        if len(logs) < len(runs):
            continue
        for name, one in zip(c.recordings, c.looks, strict=True):
            found[name] = min(distance_db(channel_logs(one), simulated) for simulated in logs)
    return found


def repeatability_db(conditions: tuple[Condition, ...]) -> float:
    """What two runs of one condition differ by: measured where there are two, else from halves of one record.

    Halves of T/2 seconds scatter √2 times as much as runs of T seconds; a course that wanders slowly makes that
    a lower bound.
    """
    distances = []
    for c in conditions:
        logs = [channel_logs(one) for one in c.looks]
        pairs = [distance_db(logs[i], logs[j]) for i in range(len(logs)) for j in range(i)]
        distances.append(float(np.mean(pairs)) if pairs else c.halves_db / float(np.sqrt(2.0)))
    return float(np.mean(distances))
