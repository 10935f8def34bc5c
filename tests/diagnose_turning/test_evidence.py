"""The statistics under a diagnosis of swivels: what chance does to spectra, and what a model's own error costs."""

from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.diagnose.diagnosis import MISSING, UNDETERMINED
from ssmr_ident.diagnose.turning import kept_back, rivals
from ssmr_ident.diagnose.turning.anchor import between
from ssmr_ident.diagnose.turning.candidates import pitches_heard
from ssmr_ident.diagnose.turning.counter import Counter
from ssmr_ident.diagnose.turning.engine import CLOSE, _ahead
from ssmr_ident.diagnose.turning.grip import REACH, _doubtful, profile
from ssmr_ident.diagnose.turning.likelihood import NEPER_DB, Block, log_variance, score
from ssmr_ident.diagnose.turning.maps import follows
from ssmr_ident.diagnose.turning.rivals import _clear
from ssmr_ident.diagnose.turning.spectra import average, look, mixes
from ssmr_ident.diagnose.turning.verdict import Decision, Finding, Findings, decide
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
    clean = score([Block(chance, variance, np.zeros(0), np.ones(0))])
    assert clean.left < 1.0
    off = score([Block(chance + 4.0 / NEPER_DB * random.standard_normal(900), variance, np.zeros(0), np.ones(0))])
    assert off.tau_db == pytest.approx(4.0, rel=0.25)
    assert off.left > 100.0
    assert off.log_likelihood < clean.log_likelihood - 50.0


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


def test_lambda_max_is_refitted_only_where_it_decides():
    flat = np.array([0.0, -1.0, -2.0, -20.0, -300.0, -500.0, -900.0])
    assert _doubtful(flat, {0}) == 3  # the first beyond the interval, and within what its own slopes may gain
    assert _doubtful(flat, {0, 3}) is None
    assert _doubtful(np.array([0.0, -90.0, -200.0, -300.0, -400.0, -500.0, -900.0]), {0}) is None
    assert _doubtful(np.array([-50.0, -9.0, 0.0, -9.0, -99.0, -200.0, -300.0]), {0}) == 2


def test_the_best_has_to_lie_nearer_over_recordings():
    assert _clear(np.array([0.5, 0.4, 0.6, 0.5]))
    assert not _clear(np.array([0.5, -0.4, 0.6, 0.0]))
    assert not _clear(np.array([-0.5, -0.4, -0.6, -0.5]))


@pytest.mark.parametrize(
    ("off", "verdict", "named"),
    [
        ({"stribeck": 2.0, "ground_roughness": 3.0}, MISSING, ("stribeck",)),  # the best repeats the recordings
        ({"stribeck": 3.0, "ground_roughness": 3.5}, MISSING, ("stribeck", "ground_roughness")),
        ({"stribeck": 3.0, "ground_roughness": 4.5}, MISSING, ("stribeck",)),
        (dict.fromkeys(("stribeck", "ground_roughness", "com_offset", "coriolis"), 3.0), UNDETERMINED, ()),
    ],
)
def test_rivals_no_further_off_than_the_best_itself_are_named_with_it(
    monkeypatch: pytest.MonkeyPatch, off: dict[str, float], verdict: str, named: tuple[str, ...]
) -> None:
    monkeypatch.setattr(rivals, "repeatability_db", lambda conditions: 2.0 / rivals.ONE_SIDED)
    monkeypatch.setattr(rivals, "_distances", lambda outcome, one: {"a.csv": off[one.id], "b.csv": off[one.id]})
    tried = tuple(SimpleNamespace(id=name, evidence=100.0) for name in off)
    outcome = SimpleNamespace(
        calibrated=False, explanations=tried, baseline=SimpleNamespace(evidence=0.0), targets=(), heldout=()
    )
    found = rivals.with_rivals(outcome, Decision(MISSING, ("stribeck",), 0.9, ""))
    assert (found.verdict, found.named) == (verdict, named)


@pytest.mark.parametrize(
    ("best", "other", "named"),
    [(2.0, 1.0, ()), (4.0, 3.9, ()), (4.0, 3.0, ("ground_roughness",))],  # reached; no nearer; nearer
)
def test_what_predicts_better_is_named_whatever_its_evidence(monkeypatch, best, other, named):
    off = {"stribeck": best, "ground_roughness": other, "unlisted": 0.1}
    monkeypatch.setattr(rivals, "repeatability_db", lambda conditions: 2.0 / rivals.ONE_SIDED)
    monkeypatch.setattr(rivals, "against_simulation", lambda bench, heldout, values, effects, seeds: {"a": effects})
    tried = {name: SimpleNamespace(id=name, anchor=SimpleNamespace(values={}), effects=off[name]) for name in off}
    outcome = SimpleNamespace(
        bench=None, targets=(), heldout=("a",), explanations=(tried["stribeck"],),
        screened=(tried["ground_roughness"], tried["unlisted"]),
    )  # fmt: skip
    assert tuple(rivals._better_predictions(outcome, tried["stribeck"])) == named


@pytest.mark.parametrize(("baseline", "expected"), [(-50.0, [0, 1]), (0.5 * CLOSE, [0]), (2.0 * CLOSE, [])])
def test_what_lies_behind_is_fitted_to_the_end_too(baseline, expected):
    """An effect that slopes left behind a baseline fitted to the end may be the one that acted."""
    ranked = [SimpleNamespace(evidence=value) for value in (0.0, -0.75 * CLOSE)]
    assert _ahead(ranked, SimpleNamespace(evidence=baseline)) == expected


@pytest.mark.parametrize(
    ("before", "after", "left", "expected"),
    [
        (5.0, 2.0, 2.0 * CLOSE, True),
        (5.0, 4.9, 2.0 * CLOSE, False),
        (1.0, 1.0, 2.0 * CLOSE, True),  # kept back where the effect does nothing
        (1.0, 3.0, 2.0 * CLOSE, False),
        (1.0, 1.0, 0.3 * CLOSE, False),  # and the targets are off by what one null session in a hundred is
    ],
)
def test_kept_back_recordings_that_show_nothing_speak_against_nothing(monkeypatch, before, after, left, expected):
    assert _predicted(monkeypatch, before, after, left, 2.0, True) is expected


@pytest.mark.parametrize(
    ("before", "after", "calibrated", "expected"),
    [
        (1.0, 1.0, False, True),  # no calibration, and the effect leaves nothing in the targets
        (5.0, 5.0, True, True),  # a speed that nothing calibrates, where the baseline errs
        (5.0, 5.0, False, False),
        (5.0, 6.0, True, False),
    ],
)
def test_what_leaves_nothing_in_the_targets_needs_no_more_than_not_to_harm(
    monkeypatch, before, after, calibrated, expected
):
    assert _predicted(monkeypatch, before, after, 100.0, 0.1, calibrated) is expected


@pytest.mark.parametrize(
    ("gained", "expected"), [(-5.0, False), (9.0, False), (0.9 * REACH, False), (1.5 * REACH, True)]
)
def test_lambda_max_is_held_elsewhere_only_beyond_what_a_search_adds(gained: float, expected: bool) -> None:
    baseline = SimpleNamespace(fit=SimpleNamespace(log_likelihood=100.0))
    found = profile(np.array([0.1, 0.5, 0.8]), np.array([99.0, 100.0 + gained, -300.0]), scatter=2.0)
    assert found.moves(baseline) is expected  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("with_it", "leaves", "expected"),
    [
        ((7.5, 8.0, 4.6, 2.5), 0.1, True),  # a robot that shakes in two ways: one run in four as it was recorded
        ((7.0, 8.0, 7.0, 7.5), 0.1, False),  # none
        ((7.5, 8.0, 4.6, 2.5), 2.0, False),  # the targets are not explained, so a near run may be chance
    ],
)
def test_one_of_several_runs_predicts_a_robot_that_shakes_in_two_ways(monkeypatch, with_it, leaves, expected) -> None:
    def distances(bench, kept, values, active, seeds):
        runs = with_it if active else (5.8, 6.0, 5.7, 6.1)
        return {"a": float(np.mean([runs[seed - 1] for seed in seeds]))}

    monkeypatch.setattr(kept_back, "against_simulation", distances)
    anchor = SimpleNamespace(values={})
    baseline = SimpleNamespace(target=SimpleNamespace(left=100.0), evidence=0.0)
    best = SimpleNamespace(anchor=anchor, effects={"a": 1}, target=SimpleNamespace(tau_db=leaves), evidence=2.0 * CLOSE)
    outcome = SimpleNamespace(
        bench=None, heldout=("a",), targets=(), anchor=anchor, calibrated=False, baseline=baseline
    )
    assert kept_back.predicts(outcome, best, 2.5) is expected


def _predicted(monkeypatch, before: float, after: float, left: float, tau: float, calibrated: bool) -> bool:
    monkeypatch.setattr(
        kept_back, "against_simulation", lambda bench, kept, values, active, seeds: {"a": active or before}
    )
    anchor = SimpleNamespace(values={})
    baseline = SimpleNamespace(target=SimpleNamespace(left=left), evidence=0.0)
    best = SimpleNamespace(anchor=anchor, effects=after, target=SimpleNamespace(tau_db=tau), evidence=2.0 * CLOSE)
    outcome = SimpleNamespace(
        bench=None, heldout=("a",), targets=(), anchor=anchor, calibrated=calibrated, baseline=baseline
    )
    return kept_back.predicts(outcome, best, 1.5)


def test_what_a_search_did_not_need_counts_as_done() -> None:
    seen: list[tuple[str, int, int]] = []
    count = Counter(lambda *told: seen.append(told), "stage", 10)
    count.advance()
    count.reach(6)
    count.reach(4)
    for _ in range(7):
        count.advance()
    assert [done for _, done, _ in seen] == [0, 1, 6, 6, 7, 8, 9, 10, 10, 10, 10]
    assert {told[0::2] for told in seen} == {("stage", 10)}
