"""The noise of a load cell in averages over blocks, told from second differences of what pulls leave."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from ssmr_ident.signals.noise.load_cell import SCATTER, Blocks, block_noises
from ssmr_ident.signals.noise.white import white_std

RATE = 100.0
LENGTHS = (0.05, 0.1, 0.1, 0.2, 0.25, 0.04)


def logged(random: np.random.Generator, count: int, share: float, corner_hz: float) -> np.ndarray:
    """Noise of unit variance sample by sample, a share of it first-order coloured."""
    white = random.standard_normal(count)
    keep = np.exp(-2.0 * np.pi * corner_hz / RATE)
    drive = np.sqrt(1.0 - keep**2) * random.standard_normal(count)
    coloured = lfilter([1.0], [1.0, -keep], drive, zi=[keep * random.standard_normal()])[0]
    return np.sqrt(1.0 - share) * white + np.sqrt(share) * coloured


def averages(samples: np.ndarray, length: float) -> np.ndarray:
    block = round(length * RATE)
    return samples[: len(samples) // block * block].reshape(-1, block).mean(axis=1)


def pulls(random: np.random.Generator, share: float = 0.0, corner_hz: float = 1.0) -> list[Blocks]:
    return [
        Blocks(averages(logged(random, round(160 * length * RATE), share, corner_hz), length), length)
        for length in LENGTHS
    ]


def truly(share: float, corner_hz: float) -> np.ndarray:
    """Standard deviations of averages, counted in a long series."""
    samples = logged(np.random.default_rng(9), 2_000_000, share, corner_hz)
    return np.array([averages(samples, length).std() for length in LENGTHS])


@pytest.mark.slow
@pytest.mark.parametrize(("share", "corner_hz"), [(0.0, 1.0), (0.3, 1.0), (0.5, 3.0), (0.3, 8.0)])
def test_noise_of_any_colour_is_as_large_as_it_is(share: float, corner_hz: float) -> None:
    random = np.random.default_rng(1)
    ratios = np.array([block_noises(pulls(random, share, corner_hz)) for _ in range(20)]) / truly(share, corner_hz)
    assert np.exp(np.log(ratios).mean()) == pytest.approx(1.0, abs=0.06)
    assert np.log(ratios).std() < 0.16


def test_second_differences_of_blocks_alone_miss_most_of_slow_noise() -> None:
    random = np.random.default_rng(2)
    seen = np.mean([[white_std(b.left) for b in pulls(random, 0.4, 1.0)] for _ in range(20)], axis=0)
    assert np.all(seen / truly(0.4, 1.0) < 0.75)


@pytest.mark.slow
def test_logarithm_of_a_variance_from_a_median_scatters_as_stated() -> None:
    random = np.random.default_rng(3)
    for count in (36, 150):
        logs = np.log([white_std(random.standard_normal(count)) ** 2 for _ in range(10_000)])
        assert np.std(logs) * np.sqrt(count) == pytest.approx(SCATTER, rel=0.06)


def test_one_recording_that_is_left_with_a_misfit_makes_the_others_no_louder() -> None:
    random = np.random.default_rng(4)
    clean = pulls(random)
    wavy = Blocks(clean[2].left + 3.0 * np.sin(1.7 * np.arange(len(clean[2].left))), clean[2].length)
    found, alone = block_noises([*clean[:2], wavy, *clean[3:]]), block_noises(clean)
    others = [0, 1, 3, 4, 5]
    assert found[others] == pytest.approx(alone[others], rel=0.12)
    assert found[2] > 4.0 * alone[2]


def test_a_force_that_bends_slowly_is_no_noise() -> None:
    random = np.random.default_rng(5)
    clean = pulls(random)
    bent = [Blocks(b.left + 4.0 * b.left.std() * np.linspace(-1.0, 1.0, len(b.left)) ** 3, b.length) for b in clean]
    assert block_noises(bent) == pytest.approx(block_noises(clean), rel=0.15)


def test_a_louder_recording_keeps_its_own_noise_and_one_that_leaves_nothing_is_no_trouble() -> None:
    random = np.random.default_rng(6)
    clean = pulls(random)
    loud = Blocks(3.0 * clean[1].left, clean[1].length)
    silent = Blocks(np.zeros(160), 0.1)
    found, alone = block_noises([clean[0], loud, *clean[2:], silent]), block_noises(clean)
    assert found[1] == pytest.approx(3.0 * alone[1], rel=0.25)
    assert np.delete(found[:-1], 1) == pytest.approx(np.delete(alone, 1), rel=0.12)
    assert 0.0 < found[-1] < 1e-100
