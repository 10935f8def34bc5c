"""How a probe is begun: from the starts that it finds, or from those that it needs itself."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.diagnose import explore, race
from ssmr_ident.diagnose.explain import as_large_as_it_takes, beside
from ssmr_ident.diagnose.scan import Suspect, scan, variants
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.physics.effect import Sized
from ssmr_ident.physics.effects import CATALOGUE

PLAY = {"gap_m": 2e-3, "rounding": 0.2}


def _suspect(effect: str, at: dict[str, float]) -> Suspect:
    return Suspect(effect, at, {}, {}, 0.0)


def fitted_at(fit: JointFit, name: str, value: float) -> JointFit:
    """A fit with one parameter elsewhere, with slopes."""
    point = np.where([unknown.name == name for unknown in fit.model.physics], value, fit.point)
    return differentiate(evaluate(fit.trials, fit.model, point, fit.nuisances))


@pytest.fixture(scope="module")
def first() -> JointFit:
    """Releases with play, fitted without it."""
    return fitted(prepared(campaign({"free_play": PLAY}, [Run(release=4e-3), Run(release=3e-3)], seed=4, duration=1.0)))


def test_a_probe_that_is_worse_than_nothing_gets_starts_of_its_own(first: JointFit, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    loose, near = _suspect("free_play", {**PLAY, "gap_m": 0.02}), descend(beside(first, _suspect("free_play", PLAY)), 4)
    assert descend(beside(first, loose), 1).cost(first.counted) > first.cost(first.counted) > near.cost(first.counted)
    monkeypatch.setattr(race, "nearest", lambda trials, model, point, nuisances: near)
    assert race._begun(first, loose).cost(first.counted) <= near.cost(first.counted)


def test_a_probe_that_helps_at_once_is_followed_no_further(first: JointFit, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(race, "nearest", lambda *_: pytest.fail("costs twenty simulations for nothing"))
    assert race._begun(first, _suspect("free_play", {**PLAY, "gap_m": 2e-4})).cost(first.counted) < first.cost(
        first.counted
    )
    # what holds a body as before has the starts of before
    stiff = _suspect("nonlinear_stiffness", {"k3_N_m3": 1e12})
    found = race._begun(first, stiff)
    assert found.model.ids == ("nonlinear_stiffness",)
    assert found.cost(first.counted) > first.cost(first.counted)


def test_a_baseline_that_has_left_what_is_known_is_begun_from_there_as_well() -> None:
    """A rig without anything missing: from the file its fit comes back, wherever it stood."""
    fit = fitted(prepared(campaign({}, [Run(release=4e-3), Run(release=3e-3)], seed=4, duration=1.0)))
    assert race._from_what_is_known(fit) is None
    bent = evaluate(fit.trials, fit.model, np.full(len(fit.point), 1.5 * race.FAR), fit.nuisances)
    found = race._from_what_is_known(bent)
    assert found is not None
    assert np.max(np.abs(found.point)) < 1.0
    assert found.rss < 1.5 * fit.rss < 0.1 * bent.rss


def test_an_effect_is_begun_in_the_place_of_what_the_baseline_has_left_the_file_for() -> None:
    """A rig that had stiffened by five deviations round a spring that hardens leaves that no room."""
    true = {"k3_N_m3": 3e9}
    runs = [Run(release=4e-3), Run(release=3e-3)]
    fit = fitted(prepared(campaign({"nonlinear_stiffness": true}, runs, seed=4, duration=0.5)))
    bent = fitted_at(fit, "stiffness_N_m", 1.7 * race.FAR)
    hardening = scan(bent, [CATALOGUE["nonlinear_stiffness"]])[0][0]
    beside_it, in_its_place = race._begun(bent, hardening), race.begun_in_its_place(bent, hardening, race.HEATS[0][1])
    assert in_its_place.cost(bent.counted) < beside_it.cost(bent.counted) - 30.0
    assert np.max(np.abs(in_its_place.point[: len(bent.point)])) < race.FAR


@pytest.mark.slow
def test_of_a_race_over_whole_recordings_each_effects_best_goes_on() -> None:
    """However many starts of the leader are ahead of it: two steps say little of where an effect ends."""
    law = {"alpha": 0.85, "yield_m": 1e-3}
    fit = fitted(prepared(campaign({"hysteresis": law}, [Run(force=60.0), Run(force=30.0)], seed=6, duration=3.0)))
    effects = [CATALOGUE[name] for name in ("nonlinear_stiffness", "hysteresis", "quadratic_damping", "free_play")]
    groups = scan(fit, effects)
    found = race.raced(fit, groups, None)
    assert {f.model.ids[-1] for f in found} == {group[0].effect for group in groups}
    assert len(groups) > 2
    kept = race.HEATS[-1][0]
    assert len(found) <= 2 * kept


@pytest.mark.slow
def test_what_grows_while_a_recording_lasts_is_asked_for_on_whole_recordings(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stiffness that drifts hardly shows on a first horizon, and a few steps there may lose it."""
    runs = [Run(force=20.0), Run(force=40.0), Run(force=10.0)]
    fit = fitted(prepared(campaign({"unlisted": {"c_ts_N_m_s": 300.0}}, runs, seed=3, duration=6.0)))
    lost = [CATALOGUE["nonlinear_stiffness"], CATALOGUE["unlisted"]]

    def misled(base, groups, lengths, progress):  # type: ignore[no-untyped-def]
        return [race.started(base, group[0]) for group in groups if group[0].effect == "nonlinear_stiffness"]

    monkeypatch.setattr(explore, "screened", misled)
    monkeypatch.setattr(explore, "candidates", lambda base, baseline: lost)
    best = race.ranked(explore.search(fit, "rigid6", (1.0, np.inf)).tried)[0]
    assert best.model.split(best.point)[1]["unlisted"]["c_ts_N_m_s"] == pytest.approx(300.0, rel=0.05)


def test_probes_that_lie_apart_all_go_on(first: JointFit, monkeypatch: pytest.MonkeyPatch) -> None:
    """Masts at five frequencies, each behind twenty stiffnesses after a third of a second."""
    sizes = {"mass": 30.0, "height": 0.23, "swing": 0.02}
    masts = [
        _suspect("flexible_mast", {n: p.value(sizes) if isinstance(p, Sized) else p for n, p in probe.items()})
        for probe in CATALOGUE["flexible_mast"].probes
    ]
    stiff = [_suspect("nonlinear_stiffness", {"k3_N_m3": 1e9 * (k + 1)}) for k in range(20)]
    seconds: list[JointFit] = []

    def begun(base: JointFit, suspect: Suspect) -> JointFit:
        model, point = base.model.with_effect(suspect.effect, suspect.at, {})
        worse = 3.0 if suspect.effect == "flexible_mast" else 1.0 + 1e-10 * suspect.at["k3_N_m3"]
        left = tuple(worse * r for r in base.residuals)
        return JointFit(
            base.trials, model, np.concatenate([base.point, point]), base.nuisances, base.simulated, left, exact=True
        )

    def goes_on(trials, lengths, steps, fit):  # type: ignore[no-untyped-def]
        if steps == race.HEATS[1][1]:
            seconds.append(fit)
        return fit

    monkeypatch.setattr(race, "_begun", begun)
    monkeypatch.setattr(race, "REPLACED", 0)
    monkeypatch.setattr(race, "_led_on", goes_on)
    race.screened(first, [masts, stiff], (0.3, 0.6, np.inf), None)
    names = [fit.model.ids[-1] for fit in seconds]
    assert names.count("flexible_mast") == len(masts)
    assert names.count("nonlinear_stiffness") == race.HEATS[1][0]
    assert len(set(map(id, seconds))) == len(seconds)


def test_an_effect_is_begun_as_large_as_it_takes_and_in_units_of_that() -> None:
    """A slope had promised a hundredth of the hardening that the rig has."""
    runs = [Run(force=30.0), Run(force=20.0)]
    setup = prepared(campaign({"nonlinear_stiffness": {"k3_N_m3": 1e9}}, runs, seed=4, duration=1.0))
    linear = fitted(setup, iterations=0)
    hint = {"k3_N_m3": 1e7}
    grown = as_large_as_it_takes(linear, Suspect("nonlinear_stiffness", hint, {}, hint, 0.0, ("k3_N_m3",)))
    found = grown.model.split(grown.point)[1]["nonlinear_stiffness"]["k3_N_m3"]
    assert found == pytest.approx(1e9, rel=0.25)
    assert grown.rss < 0.5 * linear.rss
    assert grown.point[-1] == pytest.approx(1.0 / 3.0)
    ended = race._enlarged(linear, Suspect("nonlinear_stiffness", hint, {}, hint, 0.0))
    assert ended is not None
    assert ended.model.split(ended.point)[1]["nonlinear_stiffness"]["k3_N_m3"] == pytest.approx(1e9, rel=0.005)
    assert race._enlarged(linear, Suspect("quadratic_damping", {"d2_N_s2_m2": 1e-3}, {}, {}, 0.0)) is None
    # a slope may promise too much as well
    much = {"k3_N_m3": 4e9}
    suspect = Suspect("nonlinear_stiffness", much, {}, much, 0.0, ("k3_N_m3",))
    fits = race.begun_in_its_place(linear, suspect)
    assert fits.model.split(fits.point)[1]["nonlinear_stiffness"]["k3_N_m3"] == pytest.approx(1e9, rel=0.005)
    assert fits.cost(linear.counted) < race.started(linear, suspect).cost(linear.counted) - 100.0


def test_of_what_acts_beyond_a_threshold_all_sizes_are_begun() -> None:
    belts = [Suspect("motor_belt", {"K_b_N_m": size}, {}, {}, gain) for size, gain in ((1e4, 40.0), (4e4, 9.0))]
    assert variants(belts) == belts
    springs = [Suspect("nonlinear_stiffness", {"k3_N_m3": k}, {}, {}, gain) for k, gain in ((1e9, 40.0), (-1e9, 9.0))]
    assert variants(springs) == springs[:1]
    # a formula that promises nearly as much is begun as well, of one that promises less nothing
    bends = [
        Suspect("unlisted", {name: 1e3}, {}, {}, gain)
        for name, gain in (("c_s2_N_m2", 167.0), ("c_abs_s_N_m", 159.0), ("c_v2_N_s2_m2", 85.0))
    ]
    assert variants(bends) == bends[:2]
    faint = [Suspect("unlisted", bend.at, {}, {}, 0.05 * bend.gain) for bend in bends]
    assert variants(faint) == faint[:2]
    noise = [Suspect("unlisted", bend.at, {}, {}, 0.03 * bend.gain) for bend in bends]
    assert variants(noise) == noise[:1]
    # what is tried and not fitted is tried all the same
    along = [Suspect("free_play", {"gap_m": 1e-4}, {"share_x": share}, {}, 1.0) for share in (0.0, 1.0)]
    assert variants(along) == along


@pytest.mark.parametrize(("close", "led_on"), [(race.CLOSE, True), (-race.CLOSE, False)])
def test_a_probe_that_stays_far_behind_is_led_no_further(
    first: JointFit, close: float, led_on: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = _suspect("sensor_bandwidth", {"bandwidth_hz": 20.0})
    assert CATALOGUE["sensor_bandwidth"].sudden
    held = beside(first, slow)
    monkeypatch.setattr(race, "CLOSE", close)
    assert race.within_reach([first], held) == led_on
    assert (race.started(first, slow).cost(first.counted) < held.cost(first.counted)) == led_on
