"""The statistics under a diagnosis of swivels: what chance does to spectra, and what a model's own error costs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.doctor.swivels.anchor import between
from ssmr_ident.doctor.swivels.candidates import pitches_heard
from ssmr_ident.doctor.swivels.engine import interleaved
from ssmr_ident.doctor.swivels.grip import REACH, profile
from ssmr_ident.doctor.swivels.likelihood import NEPER_DB, Block, log_variance, score
from ssmr_ident.doctor.swivels.maps import follows
from ssmr_ident.doctor.swivels.spectra import average, look, mixes
from ssmr_ident.doctor.swivels.verdict import CLOSE, Finding, Findings, decide
from ssmr_ident.signals.metrics import log_psd_db


@pytest.mark.slow
def test_white_noise_scatters_as_its_degrees_of_freedom_say():
    random = np.random.default_rng(3)
    logs = []
    for _ in range(60):
        one = look(random.standard_normal((20_000, 3)), 1000.0)
        logs.append(one.log_density(np.ones(3)))
    scatter = np.var(np.array(logs), axis=0).mean()
    assert scatter == pytest.approx(log_variance(one.dof), rel=0.06)


def test_density_is_that_of_the_metric():
    random = np.random.default_rng(4)
    a, b = random.standard_normal((2, 20_000, 2))
    ours = np.array([np.log(np.einsum("kii->ki", look(x, 1000.0).cross)) for x in (a, b)])
    distance = np.sqrt(np.mean((ours[0] - ours[1]) ** 2, axis=0)) * NEPER_DB
    np.testing.assert_allclose(distance, log_psd_db(a, b, 1000.0), rtol=1e-6)


def test_sums_hold_the_sign_of_coherence():
    random = np.random.default_rng(5)
    common = random.standard_normal(20_000)
    samples = np.column_stack([common, -0.5 * common + 0.1 * random.standard_normal(20_000)])
    mix = mixes(2)
    density = np.exp(look(samples, 1000.0).log_density(np.ones(2))).mean(axis=0)
    plus, minus = (density[int(np.flatnonzero((mix[:, 0] > 0) & (np.sign(mix[:, 1]) == s))[0])] for s in (1, -1))
    assert minus / plus == pytest.approx((1.5**2 + 0.01) / (0.5**2 + 0.01), rel=0.05)


def test_averaging_adds_degrees_of_freedom():
    random = np.random.default_rng(6)
    looks = [look(random.standard_normal((8000, 2)), 1000.0) for _ in range(3)]
    mean = average(looks)
    assert mean.dof == pytest.approx(3 * looks[0].dof)
    np.testing.assert_allclose(mean.cross, np.mean([one.cross for one in looks], axis=0))


def test_a_model_without_error_needs_no_tau_and_one_with_error_needs_its_size():
    random = np.random.default_rng(7)
    variance = log_variance(38.0)
    chance = np.sqrt(variance) * random.standard_normal(900)
    clean = score([[Block(chance, variance, np.zeros(0), np.ones(0))]])
    assert clean.left < 1.0
    noisy = chance + 4.0 / NEPER_DB * random.standard_normal(900)
    off = score([[Block(noisy, variance, np.zeros(0), np.ones(0))]])
    assert off.tau_db == pytest.approx(4.0, rel=0.25)
    assert off.left > 100.0
    assert off.log_likelihood < clean.log_likelihood - 50.0


def test_a_robot_that_shakes_in_two_ways_is_told_by_the_one_that_was_recorded():
    """One of four floors shakes as recorded, three 12 dB off: it costs the logarithm of four, and no error."""
    random = np.random.default_rng(5)
    variance = log_variance(40.0)
    right = Block(np.sqrt(variance) * random.standard_normal(900), variance, np.zeros(0), np.ones(0))
    wrong = Block(right.residual + 12.0 / NEPER_DB, variance, np.zeros(0), np.ones(0))
    alone, among = score([[right]]), score([[wrong, wrong, right, wrong]])
    assert alone.log_likelihood - among.log_likelihood == pytest.approx(np.log(4.0), abs=1e-6)
    assert among.tau_db == alone.tau_db
    assert score([[wrong]]).tau_db > 10.0


def test_joint_distance_comes_from_lines_at_two_speeds():
    frequency = np.arange(1.0, 51.0)
    courses, speeds = [], [0.06, 0.11]
    for speed in speeds:
        line = speed / 0.012
        courses.append(sum(2.0 * np.exp(-(((frequency - n * line) / 0.8) ** 2)) for n in (1, 2, 3)))
    heard = pitches_heard(frequency, courses, speeds)
    assert min(abs(pitch / 0.012 - 1.0) for pitch in heard) < 0.05


def test_weights_between_speeds():
    np.testing.assert_allclose(between(np.array([24.0, 48.0]), 36.0), [0.5, 0.5])
    np.testing.assert_allclose(between(np.array([48.0, 24.0]), 24.0), [0.0, 1.0])
    np.testing.assert_allclose(between(np.array([24.0, 48.0]), 90.0), [0.0, 1.0])
    np.testing.assert_allclose(between(np.array([24.0, 24.0]), 24.0), [0.5, 0.5])


def test_grip_interval_is_open_where_the_data_cannot_tell():
    tried = np.array([0.02, 0.1, 0.3, 0.5, 0.7, 1.0])
    flat = profile(tried, np.array([-0.1, 0.0, -0.2, -8.0, -30.0, -60.0]))
    assert flat.lower is None
    assert 0.3 < flat.upper < 0.5
    assert "cannot tell smaller" in str(flat)
    assert "cannot tell it" in str(profile(tried, np.zeros(6)))
    noisy = np.array([-6.0, -3.0, -5.0, 0.0, -60.0, -90.0])
    assert profile(tried, noisy, scatter=2.0).lower is None
    inside = profile(tried, -(((tried - 0.5) / 0.05) ** 2) / 2)
    assert inside.lower < 0.5 < inside.upper


@pytest.mark.parametrize(
    ("line", "word"), [([5.0, 7.5, 10.0], "in proportion"), ([8.0, 8.1, 8.0], "fixed"), ([9.0, 7.5, 6.0], "falling")]
)
def test_lines_over_speed(line, word):
    assert word in follows(np.array([0.4, 0.6, 0.8]), np.array(line))


def _found(calibrated=True, left=300.0, tau=6.0, rms=6.5, tried=()):
    return Findings(calibrated, left, tau, rms, 1.4, tuple(Finding(*one) for one in tried))


def test_verdicts():
    clear = [("ground_joints", 150.0, 1.0, 2.0), ("ground_roughness", 80.0, 4.0, 4.5)]
    assert decide(_found(tried=clear)).named == ("ground_joints",)
    alike = [("com_offset", 50.0, 1.0, 2.0), ("stribeck", 49.0, 1.0, 2.0), ("unlisted", 51.0, 1.0, 2.0)]
    assert decide(_found(tried=alike)).named == ("com_offset", "stribeck", "unlisted")
    quiet = decide(_found(left=0.0, tau=0.0, rms=1.4, tried=[("ground_joints", -8.0, 0.0, 1.4)]))
    assert (quiet.verdict, quiet.named) == ("nothing_missing", ())
    poor = decide(_found(tried=[("coriolis", 4.0, 6.0, 6.4)]))
    assert poor.named == ("unlisted",)
    foreign = decide(_found(calibrated=False, left=900.0, tau=5.4, rms=5.5, tried=[("stribeck", 40.0, 4.4, 4.9)]))
    assert foreign.verdict == "undetermined"


@pytest.mark.parametrize(
    ("gain", "held", "own_error", "verdict"),
    [
        (60.0, 12.0, 5.0, "missing_physics"),
        (60.0, -1.0, 5.0, "undetermined"),
        (60.0, -1.0, 0.4, "nothing_missing"),
        (2.0 * CLOSE, -1.0, 0.4, "missing_physics"),  # kept back where the effect does nothing
        (2.0 * CLOSE, -30.0, 5.0, "undetermined"),
    ],
)
def test_recordings_kept_back_decide(gain: float, held: float, own_error: float, verdict: str) -> None:
    found = replace(_found(tried=[("ground_joints", gain, 1.0, 2.0, held)]), held_tau_db=own_error)
    assert decide(found).verdict == verdict


def test_what_was_kept_back_counts_as_what_was_fitted() -> None:
    tried = [("slip_coupling", 343.0, 1.3, 2.0, -37.0), ("stribeck", 228.0, 3.0, 3.0, 90.0)]
    assert decide(replace(_found(tried=tried), held_tau_db=5.0)).named == ("stribeck", "slip_coupling")


def test_starts_are_those_that_gain_and_those_that_are_ahead_in_turn() -> None:
    one, two, three = (SimpleNamespace(name=name) for name in ("one", "two", "three"))
    assert interleaved([one, two, three], [three, one, two]) == [one, three, two]  # type: ignore[list-item]


@pytest.mark.parametrize(
    ("gained", "expected"), [(-5.0, False), (9.0, False), (0.9 * REACH, False), (1.5 * REACH, True)]
)
def test_lambda_max_is_held_elsewhere_only_beyond_what_a_search_adds(gained: float, expected: bool) -> None:
    baseline = SimpleNamespace(evidence=100.0)
    found = profile(np.array([0.1, 0.5, 0.8]), np.array([99.0, 100.0 + gained, -300.0]), scatter=2.0)
    assert found.moves(baseline) is expected  # type: ignore[arg-type]
