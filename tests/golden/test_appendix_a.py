"""Thesis appendix A, transcribed from its formulas with loops and nothing of scipy, against the library."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from ssmr_ident.signals import filters, peaks, spectra

RATE = 1000.0


def butterworth_biquads(order: int, cutoff: float) -> list[tuple[float, ...]]:
    """b0 b1 b2 a1 a2 per pair of poles: analogue prototype, prewarping, bilinear transform."""
    warped = 2 * RATE * math.tan(math.pi * cutoff / RATE)
    biquads = []
    for k in range(order // 2):
        pole = warped * cmath.exp(1j * math.pi * (2 * k + order + 1) / (2 * order))
        z = (2 * RATE + pole) / (2 * RATE - pole)
        a1, a2 = -2 * z.real, abs(z) ** 2
        gain = (1 + a1 + a2) / 4  # unit gain at 0 Hz with the double zero at -1
        biquads.append((gain, 2 * gain, gain, a1, a2))
    return biquads


def run_once(biquads: list[tuple[float, ...]], x: list[float]) -> list[float]:
    """Direct form II transposed, each section at rest on the first sample."""
    for b0, b1, b2, a1, a2 in biquads:
        s1, s2 = x[0] - b0 * x[0], b2 * x[0] - a2 * x[0]
        y = []
        for value in x:
            out = b0 * value + s1
            s1 = b1 * value - a1 * out + s2
            s2 = b2 * value - a2 * out
            y.append(out)
        x = y
    return x


def forward_backward(biquads: list[tuple[float, ...]], samples: np.ndarray, padding: int) -> np.ndarray:
    x = [float(v) for v in samples]
    before = [2 * x[0] - x[k] for k in range(padding, 0, -1)]
    after = [2 * x[-1] - x[-1 - k] for k in range(1, padding + 1)]
    y = run_once(biquads, before + x + after)
    y = run_once(biquads, y[::-1])[::-1]
    return np.array(y[padding : padding + len(x)])


def one_sided_amplitude(samples: np.ndarray, bins: int) -> np.ndarray:
    """The DFT by its definition, for the first bins; 0 Hz kept, the others doubled."""
    n = len(samples)
    index = np.arange(n)
    amplitude = []
    for k in range(bins):
        total = np.sum(samples * np.exp(-2j * np.pi * ((k * index) % n) / n))
        amplitude.append(abs(total) / n * (1 if k == 0 else 2))
    return np.array(amplitude)


def three_peaks(frequency: list[float], amplitude: list[float]) -> list[tuple[float, float]]:
    """The highest local maxima in [1, 50] Hz; one nearer than 1 Hz to a higher one is passed over."""
    candidates = []
    for k in range(1, len(amplitude) - 1):
        if 1 <= frequency[k] <= 50 and amplitude[k - 1] < amplitude[k] > amplitude[k + 1]:
            candidates.append((amplitude[k], frequency[k]))
    chosen: list[tuple[float, float]] = []
    for height, place in sorted(candidates, reverse=True):
        if len(chosen) < 3 and all(abs(place - other) >= 1 for other, _ in chosen):
            chosen.append((place, height))
    return chosen


def swivel_like(n: int, seed: int) -> np.ndarray:
    """Volts with two broad lines, mains hum, an offset and noise."""
    rng = np.random.default_rng(seed)
    t = np.arange(n) / RATE
    wander = np.cumsum(rng.standard_normal(n)) * 0.02
    return (
        2.61
        + 0.08 * np.sin(2 * np.pi * 7.3 * t + wander)
        + 0.05 * np.sin(2 * np.pi * 23.9 * t + 1)
        + 0.02 * np.sin(2 * np.pi * 60 * t)
        + 0.01 * rng.standard_normal(n)
    )


@pytest.mark.parametrize("cutoff", [filters.SWIVEL_LOW_PASS_HZ, filters.FREE_RESPONSE_LOW_PASS_HZ])
def test_low_pass_equals_the_recursion(cutoff: float) -> None:
    samples = swivel_like(4096, seed=1)
    chain = filters.design(RATE, upper_hz=cutoff)
    assert chain is not None
    expected = forward_backward(butterworth_biquads(10, cutoff), samples, chain.padding)
    np.testing.assert_allclose(filters.low_pass(samples, RATE, cutoff), expected, rtol=0, atol=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 3, 4])
def test_spectrum_and_peaks_of_a_swivel_equal_the_transcription(seed: int) -> None:
    samples = swivel_like(20000, seed)
    part = spectra.select_range(len(samples), RATE, "middle")
    assert (part.first, part.count) == (1808, 16384)
    analysed = samples[1808 : 1808 + 16384]
    spectrum = spectra.amplitude_spectrum(samples[part.indices], RATE)
    bins = int(51 * 16384 / RATE)
    amplitude = one_sided_amplitude(analysed, bins)
    np.testing.assert_allclose(spectrum.amplitude[:bins], amplitude, rtol=1e-9, atol=1e-13)

    expected = three_peaks([k * RATE / 16384 for k in range(bins)], list(amplitude))
    found = peaks.find_peaks(spectrum)
    np.testing.assert_allclose(found.frequency, [f for f, _ in expected], rtol=1e-12)
    np.testing.assert_allclose(found.amplitude, [a for _, a in expected], rtol=1e-9)
    assert len(expected) == 3


def test_free_response_has_the_grid_of_table_5_2() -> None:
    """Table 5.2 prints 5.8594, 2.9297, 7.8125 …: multiples of 1000/2048 Hz."""
    part = spectra.select_range(4096, RATE, "beginning", length=spectra.FREE_RESPONSE_LENGTH)
    assert (part.first, part.count) == (0, 2048)
    t = np.arange(4096) / RATE
    for frequency, printed in [(6.04, 5.8594), (3.05, 2.9297), (7.51, 7.3242), (6.3, 6.3477), (3.4, 3.4180)]:
        decay = np.exp(-0.5 * t) * np.sin(2 * np.pi * frequency * t)
        found = peaks.find_peaks(spectra.amplitude_spectrum(decay[part.indices], RATE))
        assert found.frequency[0] == pytest.approx(printed, abs=5e-5)


def test_amplitude_of_a_log_equals_the_transcription() -> None:
    samples = swivel_like(4000, seed=5)
    chain = filters.design(RATE, upper_hz=50.0)
    assert chain is not None
    kept = forward_backward(butterworth_biquads(10, 50.0), samples, chain.padding)
    assert peaks.log_amplitude(samples, RATE) == pytest.approx((max(kept) - min(kept)) / 2, rel=1e-9)
