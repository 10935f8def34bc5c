"""Where the best explanation stays far off, those in front are searched from all of their starts."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.diagnose.turning import wider as stage
from ssmr_ident.diagnose.turning.candidates import candidates
from ssmr_ident.diagnose.turning.counter import Counter
from ssmr_ident.diagnose.turning.ensemble import ALIKE, ROUGH, ROUNDS, _everywhere
from ssmr_ident.diagnose.turning.likelihood import Score
from ssmr_ident.diagnose.turning.search import Explained
from ssmr_ident.diagnose.turning.wider import FAR_DB, LED, TIMES, TRIED, WORK, wider

EVERY = {c.id: c for c in candidates((0.03, 0.1), (10.0,), 3e-5)}


def _one(name: str, evidence: float, tau: float) -> Explained:
    anchor = SimpleNamespace(calibration=(), bench=SimpleNamespace(work=0.0))
    return Explained(EVERY[name], {}, anchor, Score(0.0, tau, tau), 0.0, evidence)  # type: ignore[arg-type]


class Runner:
    """An ensemble from all starts: the third explanation was begun on the wrong side, and gains by it."""

    def __init__(self, one: Explained, asked: list[tuple[str, bool]]) -> None:
        asked.append((one.id, True))
        self.one, self.start, self.level, self.rounds = one, one, one.evidence, 0

    def advance(self) -> None:
        self.rounds += 1

    def best(self) -> Explained:
        return replace(self.one, evidence=self.one.evidence + {"com_offset": 90.0}.get(self.one.id, 1.0))


def test_what_falls_out_of_reach_is_not_run_to_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    runners = [Runner(_one(name, evidence, 3.0), []) for name, evidence in (("stribeck", 0.0), ("com_offset", -160.0))]
    shown: list[int] = []
    count = Counter(lambda _, done, total: shown.append(done), "race", 2 * ROUNDS)
    found = stage._raced(runners, 2, count)  # type: ignore[arg-type]
    assert [one.id for one in found] == ["stribeck"]
    assert [runner.rounds for runner in runners] == [ROUNDS, ROUGH + 1]
    assert shown[-1] == 2 * ROUNDS


def test_nothing_is_led_on_beyond_what_anyone_waits_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stage, "settled", lambda *_, **__: pytest.fail("led on"))
    monkeypatch.setattr(stage, "Ensemble", lambda one, *_, everywhere: Runner(one, []))
    tired = _one("stribeck", 50.0, 2.0 * FAR_DB)
    tired.anchor.bench.work = 1.01 * WORK
    assert wider([tired], (), 0, (1,), lambda *_: None)[0].evidence == 51.0


def test_nothing_more_is_simulated_where_the_best_comes_near(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stage, "settled", lambda *_, **__: pytest.fail("searched"))
    assert wider([_one("stribeck", 50.0, 0.9 * FAR_DB)], (), 0, (1,), lambda *_: None) == []
    assert wider([], (), 0, (1,), lambda *_: None) == []


def test_those_in_front_and_what_is_unlisted_are_searched_and_the_first_led_on(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[str, bool]] = []
    shown: list[tuple[int, int]] = []

    def settled(one, targets, seed, final, advance):
        asked.append((one.id, False))
        for _ in range(ROUNDS):
            advance()
        return replace(one, evidence=one.evidence + 2.0 * ALIKE * (one.evidence < 100.0))

    monkeypatch.setattr(stage, "settled", settled)
    runners: dict[str, Runner] = {}

    def ensemble(one, *_, everywhere):
        runners[one.id] = Runner(one, asked)
        return runners[one.id]

    monkeypatch.setattr(stage, "Ensemble", ensemble)
    names = ["wheel_lift", "flexible_mast", "stribeck", "com_offset", "motor_belt", "unlisted"]
    best = [_one(name, 50.0 - 10.0 * place, 2.0 * FAR_DB) for place, name in enumerate(names)]
    found = wider(best, (), 0, (1,), lambda _, done, total: shown.append((done, total)))
    first = [name for name, everywhere in asked if everywhere]
    # a wheel that lifts has nothing to search
    assert first == ["flexible_mast", "stribeck", "com_offset", "motor_belt", "unlisted"]
    to_the_end = [name for name, runner in runners.items() if runner.rounds == ROUNDS]
    assert to_the_end == [*first[:TRIED], "unlisted"]
    assert runners["motor_belt"].rounds == ROUGH
    assert found[0].id == "com_offset"
    assert found[0].evidence == 20.0 + 90.0
    led = [name for name, everywhere in asked if not everywhere]
    assert (led[0], set(led)) == ("com_offset", {"com_offset", "flexible_mast"})
    assert len(led) <= LED * TIMES
    assert shown[-1][0] == shown[-1][1]
    assert [done for done, _ in shown] == sorted(done for done, _ in shown)


@pytest.mark.parametrize("name", ["com_offset", "sensor_misalignment", "stribeck", "load_sensitive_friction"])
def test_members_begin_about_every_start_and_between(name: str) -> None:
    candidate = EVERY[name]
    starts = np.array([candidate.position(values) for values in candidate.starts])
    places = _everywhere(candidate, 4000, np.random.default_rng(3))
    assert places.mean(axis=0) == pytest.approx(starts.mean(axis=0), abs=0.1 * np.ptp(starts, axis=0).max())
    apart = np.maximum(0.5 * starts.std(axis=0), [free.spread for free in candidate.free])
    assert places.std(axis=0) == pytest.approx(np.hypot(starts.std(axis=0), apart), rel=0.05)
