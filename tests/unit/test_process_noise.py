"""Noise that comes through a system: its density against the sum of two, and a null's tests under it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are
from scipy.signal import cont2discrete, lfilter, ss2tf

from ssmr_ident.signals.noise import burg_noise, process_noise

RATE, HZ, RATIO = 400.0, 10.0, 0.02


def accelerance() -> tuple[np.ndarray, np.ndarray]:
    w = 2.0 * math.pi * HZ
    a, b = np.array([[0.0, 1.0], [-w * w, -2.0 * RATIO * w]]), np.array([[0.0], [1.0]])
    discrete = cont2discrete((a, b, a[1:], np.ones((1, 1))), 1.0 / RATE)
    numerators, denominator = ss2tf(*discrete[:4])
    return numerators[0], denominator


def noise(share: float, seed: int, count: int = 8000) -> np.ndarray:
    random = np.random.default_rng(seed)
    through = lfilter(*accelerance(), random.standard_normal(count + 2000))
    return (random.standard_normal(count + 2000) + share * through)[2000:]


def test_density_is_the_sum_of_both() -> None:
    share = 0.3
    found = process_noise([noise(share, 1, 40_000)], *accelerance(), 12)
    frequency = np.array([2.0, 9.5, 10.0, 10.5, 60.0, 150.0])
    z = np.exp(2j * math.pi * frequency / RATE)
    numerator, denominator = accelerance()
    true = 2.0 / RATE * (1.0 + share**2 * np.abs(np.polyval(numerator, z) / np.polyval(denominator, z)) ** 2)
    assert found.density(frequency, 1.0 / RATE) == pytest.approx(true, rel=0.15)


def test_a_line_at_resonance_is_counted_right() -> None:
    """What fits a motion at the resonance gains one unit of chi2 a parameter on noise alone; five and more without."""
    time = np.arange(8000) / RATE
    motion = np.column_stack([np.cos(2 * np.pi * HZ * time), np.sin(2 * np.pi * HZ * time)])
    gains: dict[str, list[float]] = {"with": [], "without": []}
    for seed in range(40):
        samples = noise(0.3, seed)
        for name, model in (
            ("with", process_noise([samples], *accelerance(), 12)),
            ("without", burg_noise(samples, 12)),
        ):
            white, columns = model.filtered(samples), model.filtered(motion)
            left = white - columns @ np.linalg.lstsq(columns, white, rcond=None)[0]
            gains[name].append(float(white @ white - left @ left))
    assert np.mean(gains["with"]) == pytest.approx(2.0, abs=1.2)
    assert np.mean(gains["without"]) > 5.0


def test_white_noise_stays_white() -> None:
    found = process_noise([noise(0.0, 3)], *accelerance(), 12)
    assert found.order == 0
    assert len(found.moving_average) == 1


def test_what_adds_up_is_told_from_its_start() -> None:
    """A white force on a free mass, beside a sensor's white noise: its innovations by an algebraic Riccati equation."""
    step, force, sensor = 0.01, 0.5, 2e-4
    a, b, c = np.array([[1.0, step], [0.0, 1.0]]), np.array([[step**2 / 2.0], [step]]), np.array([[1.0, 0.0]])
    p = solve_discrete_are(a.T, c.T, force**2 * b @ b.T, np.array([[sensor**2]]))
    innovation = math.sqrt((c @ p @ c.T).item() + sensor**2)
    numerators, denominator = ss2tf(a, b, c, np.zeros((1, 1)))
    random = np.random.default_rng(5)
    parts = [
        lfilter(numerators[0], denominator, force * random.standard_normal(n)) + sensor * random.standard_normal(n)
        for n in (4000, 1000)
    ]
    found = process_noise(parts, numerators[0], denominator, 0)
    assert found.std == pytest.approx(innovation, rel=0.05)
    assert np.std(found.filtered(parts[0])[20:]) == pytest.approx(1.0, abs=0.06)


def test_noise_of_many_decades_reads_as_large_as_it_is() -> None:
    """Two lines near zero frequency, four decades above the rest: Yule and Walker's equations read 0.2 here."""
    samples = lfilter([1.0], np.convolve([1.0, -1.995, 0.9955], [1.0, -1.98, 0.985]), random_white(6, 1500))
    assert np.std(burg_noise(samples, 12).whiten(samples)) == pytest.approx(1.0, abs=0.05)


def random_white(seed: int, count: int) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(count)
