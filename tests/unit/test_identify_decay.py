"""Decays: exact where there is no noise, and right about start, mains, order, colour of noise and errors."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.identify.decays.backbone import along, backbone
from ssmr_ident.identify.decays.classical import fft_grid, half_power, logarithmic_decrement, pencil
from ssmr_ident.identify.decays.fit import fit_decay, fit_decays

STEP = 1e-3
TIMES = STEP * np.arange(2048)


def decay(times: np.ndarray, frequency: float, xi: float, amplitude: float = 1.0, phase: float = 0.7) -> np.ndarray:
    omega = 2 * np.pi * frequency
    return amplitude * np.exp(-xi * omega * times) * np.sin(omega * np.sqrt(1 - xi**2) * times + phase)


@pytest.mark.parametrize(("frequency", "xi"), [(10.0, 0.02), (4.0, 0.10), (2.0, 0.3), (40.0, 0.003)])
def test_noise_free_decay_comes_back(frequency: float, xi: float) -> None:
    noise = 1e-9 * np.random.default_rng(0).normal(size=len(TIMES))
    fit = fit_decay(TIMES, 0.4 + decay(TIMES, frequency, xi, 2.0, -0.6) + noise, start_s=0.0, modes=1)
    (mode,) = fit.modes
    assert mode.omega_n == pytest.approx(2 * np.pi * frequency, rel=1e-7)
    assert mode.xi == pytest.approx(xi, rel=1e-6)
    assert mode.amplitudes[0, 0] == pytest.approx(2.0, rel=1e-6)
    assert mode.phases[0, 0] == pytest.approx(-0.6, abs=1e-6)
    assert fit.offsets[0, 0] == pytest.approx(0.4, rel=1e-6)


def test_equation_5_9_holds_of_a_mode() -> None:
    noise = 1e-3 * np.random.default_rng(1).normal(size=len(TIMES))
    mode = fit_decay(TIMES, decay(TIMES, 6.0, 0.1) + noise, start_s=0.0).modes[0]
    assert mode.omega_n == pytest.approx(np.hypot(2 * np.pi * mode.frequency_hz, mode.decay_rate), rel=1e-12)


@pytest.mark.parametrize("wait", [0.0, 0.1, 0.283])
def test_release_is_found(wait: float) -> None:
    rng = np.random.default_rng(2)
    times = STEP * np.arange(4096)
    signal = np.where(times >= wait, decay(times - wait, 6.5, 0.03, 2.0, 1.1), 0.3)
    signal = signal + 0.3 * np.sin(2 * np.pi * 60.02 * times + 1) + 0.01 * rng.normal(size=len(times))
    fit = fit_decay(times, signal)
    assert fit.starts_s[0] == pytest.approx(wait, abs=0.03)
    assert fit.starts_s[0] >= wait - 1.5 * STEP
    assert fit.mains_hz[0] == pytest.approx(60.02, abs=0.002)
    assert abs(fit.dominant.omega_n - 2 * np.pi * 6.5) < 4 * fit.dominant.omega_n_std
    assert abs(fit.dominant.xi - 0.03) < 4 * fit.dominant.xi_std


def test_mains_far_above_the_noise_does_no_harm() -> None:
    rng = np.random.default_rng(3)
    clean = decay(TIMES, 6.5, 0.04, 1.0) + 0.01 * rng.normal(size=len(TIMES))
    loud = clean + 1.5 * np.sin(2 * np.pi * 59.97 * TIMES)
    quiet, hummed = fit_decay(TIMES, clean, start_s=0.0).modes[0], fit_decay(TIMES, loud, start_s=0.0).modes[0]
    assert hummed.omega_n == pytest.approx(quiet.omega_n, abs=0.5 * quiet.omega_n_std)
    assert hummed.omega_n_std == pytest.approx(quiet.omega_n_std, rel=0.1)


def test_order_follows_evidence() -> None:
    rng = np.random.default_rng(4)
    noise = 0.02 * rng.normal(size=len(TIMES))
    assert len(fit_decay(TIMES, decay(TIMES, 10, 0.02) + noise, start_s=0.0).modes) == 1
    both = decay(TIMES, 10, 0.02) + decay(TIMES, 10.5, 0.02, 0.5, 2.0) + noise
    fit = fit_decay(TIMES, both, start_s=0.0)
    assert [round(mode.omega_n / 2 / np.pi, 1) for mode in fit.modes] == [10.0, 10.5]
    assert fit.evidence[2] < fit.evidence[1]


@pytest.mark.slow
def test_coloured_noise_is_whitened() -> None:
    """Noise of low frequency: the std must follow the density at the mode, not the variance of a sample."""
    rng = np.random.default_rng(5)
    times = STEP * np.arange(4096)
    misses = []
    for _ in range(40):
        noise = np.empty(len(times))
        value = 0.0
        for index, kick in enumerate(0.02 * rng.normal(size=len(times))):
            value = 0.9 * value + kick
            noise[index] = value
        fit = fit_decay(times, decay(times, 10, 0.05) + noise, start_s=0.0, modes=1)
        mode = fit.modes[0]
        misses.append([(mode.omega_n - 20 * np.pi) / mode.omega_n_std, (mode.xi - 0.05) / mode.xi_std])
        assert fit.noise_orders[0] >= 1
    # 40 runs: the spread of a unit normal is 1 within ±0.23 at 95 %; a white-noise fit gives about 5
    assert np.all(np.std(misses, axis=0) < 1.4)
    assert np.all(np.std(misses, axis=0) > 0.6)


def test_trials_and_channels_share_their_modes() -> None:
    rng = np.random.default_rng(6)

    def record(phase: float) -> np.ndarray:
        both = np.column_stack([decay(TIMES, 5, 0.05, 1.0, phase), decay(TIMES, 5, 0.05, 0.4, phase + 1)])
        return both + 0.02 * rng.normal(size=both.shape)

    records = [(TIMES, record(phase)) for phase in (0.1, 1.0, 2.0)]
    joint = fit_decays(records, starts_s=[0.0] * 3, unit="m/s^2")
    alone = fit_decay(*records[0], start_s=0.0)
    assert joint.modes[0].amplitudes.shape == (3, 2)
    assert joint.modes[0].omega_n_std == pytest.approx(alone.modes[0].omega_n_std / np.sqrt(3), rel=0.15)
    assert abs(joint.modes[0].omega_n - 10 * np.pi) < 4 * joint.modes[0].omega_n_std
    text = str(joint)
    for section in ("[[Fit Statistics]]", "[[Variables]]", "[[Correlations]]", "rad/s", "m/s^2"):
        assert section in text


def test_backbone_sees_softening_and_only_that() -> None:
    rng = np.random.default_rng(7)
    times = 0.01 * np.arange(3000)
    amplitude = 1.4 * np.exp(-0.05 * times)
    phase = np.cumsum(2.11 * (1 - amplitude**2 / 16)) * 0.01
    signal = amplitude * np.cos(phase) + 0.003 * rng.normal(size=len(times))
    trend = backbone(times, signal, fit_decay(times, signal, start_s=0.0, modes=1))
    assert trend is not None
    assert trend.small_omega_n == pytest.approx(2.11, abs=0.02)
    assert trend.omega_trend_p < 1e-3
    plain = decay(times, 0.336, 0.025, 1.4) + 0.003 * rng.normal(size=len(times))
    flat = backbone(times, plain, fit_decay(times, plain, start_s=0.0, modes=1))
    assert flat is not None
    assert flat.omega_trend_p > 1e-3


def test_windows_are_long_enough_for_hardly_any_damping() -> None:
    rng = np.random.default_rng(8)
    times = 1e-3 * np.arange(60000)
    turn, xi = 2.0 * np.pi * 20.0, 5e-4
    signal = np.exp(-xi * turn * times) * np.cos(turn * times) + 0.01 * rng.normal(size=len(times))
    trend = along(signal, 1e-3, turn, xi, 0.01)
    assert trend is not None
    assert np.all(trend.xi_std[trend.amplitude > 0.1] < 0.05 * xi)
    assert f"{trend.xi[0]:.4g}" in str(trend)
    assert np.all(np.abs(trend.xi - xi) < 4.0 * trend.xi_std)


def test_unusable_records_say_what_to_mend() -> None:
    with pytest.raises(InputError, match="at least 64"):
        fit_decay(TIMES[:30], np.zeros(30))
    with pytest.raises(InputError, match="NaN"):
        fit_decay(TIMES, np.full(len(TIMES), np.nan))
    uneven = TIMES.copy()
    uneven[1000:] += 0.5
    with pytest.raises(InputError, match="uneven"):
        fit_decay(uneven, decay(TIMES, 5, 0.05))
    with pytest.raises(InputError, match="constant"):
        fit_decay(TIMES, np.zeros(len(TIMES)))


def test_classical_methods_agree_on_a_clean_decay() -> None:
    clean = decay(TIMES, 10, 0.02)
    for omega, xi in (logarithmic_decrement(clean, STEP), pencil(clean, STEP)[0]):
        assert omega == pytest.approx(20 * np.pi, rel=5e-3)
        assert xi == pytest.approx(0.02, rel=0.1)
    assert fft_grid(clean, STEP)[0] == pytest.approx(20 * np.pi, rel=0.03)
    assert half_power(clean, STEP)[0] == pytest.approx(20 * np.pi, rel=0.01)
