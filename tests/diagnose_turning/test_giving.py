"""Beside an explanation the baseline goes back where it was before it bent itself round what is missing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.diagnose.turning import alone, firm, giving
from ssmr_ident.diagnose.turning.candidates import candidates
from ssmr_ident.diagnose.turning.conditions import BRIEFEST, brief
from ssmr_ident.diagnose.turning.ensemble import ALIKE, ROUNDS
from ssmr_ident.diagnose.turning.giving import DIFFERENCE, given_way, ranked_on, screened_giving, slopes_alone
from ssmr_ident.diagnose.turning.likelihood import Block, Score, score
from ssmr_ident.diagnose.turning.search import Explained
from ssmr_ident.diagnose.turning.wider import FAR_DB, REACH

FLOOR = next(c for c in candidates((0.03,), (10.0,), 3e-5) if c.id == "load_sensitive_friction")
BINS = 600


class Bench:
    """Simulates nothing."""

    def prefetch(self, jobs, step=0.0) -> None:
        for _ in jobs:
            pass


class World:
    """Residuals that are straight lines of two parameters of a baseline and the exponent of one effect."""

    bench, calibration, step, fit = Bench(), (), 1.0, Score(0.0, 0.0, 0.0)

    def __init__(self, z=(0.0, 0.0), seeds=(1, 2), step=0.0) -> None:
        random = np.random.default_rng(5)
        self.z, self.seeds = np.asarray(z, dtype=float), seeds
        self.slopes = 0.4 * random.standard_normal((BINS, 2))
        self.effect = random.standard_normal(BINS)
        self.chance = 0.1 * random.standard_normal(BINS)
        self.true = np.array([1.0, -0.6])

    def __replace__(self, **changes):
        return World(**{"z": self.z, "seeds": self.seeds, **changes})

    def at(self, z):
        return {"a": float(z[0]), "b": float(z[1])}

    values = property(lambda self: self.at(self.z))

    def blocks(self, conditions, effects, share, values=None):
        values = self.values if values is None else values
        z = np.array([values["a"], values["b"]])
        exponent = effects.get(FLOOR.id, {"exponent": 0.0})["exponent"]
        residual = self.chance + self.slopes @ (self.true - z) + self.effect * (0.35 - exponent)
        return [Block(residual, 0.02, np.zeros(1), np.ones(1))]

    def score(self, conditions, effects, values=None):
        return score(self.blocks(conditions, effects, 0.0, values)), 0.0


@pytest.fixture
def world(monkeypatch):
    """``dataclasses.replace`` for something that is no dataclass, as later Pythons know it."""

    def changed(one, **changes):
        return one.__replace__(**changes) if isinstance(one, World) else replace(one, **changes)

    monkeypatch.setattr(giving, "replace", changed)
    return World()


TARGET = SimpleNamespace(turning=0.5, mean=SimpleNamespace(cross=np.zeros((50, 3, 3))), names=("ax", "ay", "az"))


def test_slopes_are_those_of_the_baseline_alone(world) -> None:
    found = slopes_alone(world, (TARGET,))
    np.testing.assert_allclose(found, -world.slopes, atol=1e-9)
    assert DIFFERENCE > 0.0


def test_the_baseline_gives_back_what_it_took_up(world) -> None:
    # fitted without the effect it lies where chance of the draw put it; beside the effect it goes to its own values
    bent = World(z=(0.2, 0.5))
    found = screened_giving(bent, FLOOR, (TARGET,), slopes_alone(world, (TARGET,)), lambda: None)
    assert found[0].values == {"exponent": 0.35}
    np.testing.assert_allclose(found[0].anchor.z, world.true, atol=0.15)
    assert found[0].evidence > found[1].evidence


def test_starts_are_ranked_on_speeds_as_far_apart_as_there_are() -> None:
    targets = tuple(SimpleNamespace(turning=turning) for turning in (0.9, -0.3, 0.5, -0.7, 0.4, 1.2, 0.6))
    assert [c.turning for c in ranked_on(targets)] == [-0.3, 0.5, -0.7, 1.2]
    assert len(ranked_on(targets[:2])) == 2


def test_a_search_simulates_less_of_each_of_many_steady_courses() -> None:
    @dataclass(frozen=True)
    class Course:
        settling: float
        duration: float

    steady, changing = Course(2.0, 12.0), Course(0.0, 30.0)
    assert brief((steady, changing), 4) == (steady, changing)  # type: ignore[arg-type, comparison-overlap]
    assert [c.duration for c in brief((steady, changing), 8)] == [7.5, 30.0]  # type: ignore[arg-type]
    assert brief((steady,), 30)[0].duration == BRIEFEST  # type: ignore[arg-type]


def test_what_slopes_cannot_take_up_moves_nothing() -> None:
    slopes = np.array([[1.0], [1.0], [-1.0], [-1.0]])
    np.testing.assert_allclose(given_way(np.zeros(1), np.array([0.5, -0.5, 0.5, -0.5]), slopes), 0.0, atol=1e-12)


def _baseline(evidence: float, tau: float = 2.0) -> Explained:
    anchor = SimpleNamespace(z=np.zeros(2))
    return Explained(None, {}, anchor, Score(0.0, tau, tau), 0.0, evidence)  # type: ignore[arg-type]


@pytest.mark.parametrize(("ahead", "searched"), [(5.0, 0), (45.0, 2), (60.0, 3), (REACH + 1.0, 0)])
def test_the_baseline_is_searched_again_where_that_decides(monkeypatch, ahead: float, searched: int) -> None:
    asked = []

    def settled(one, targets, seed, final, advance, everywhere=False):
        asked.append(everywhere)
        for _ in range(ROUNDS):
            advance()
        return replace(one, evidence=one.evidence + (1.5 if everywhere else 0.5) * ALIKE)

    shown = []
    monkeypatch.setattr(alone, "settled", settled)
    show = lambda _, done, total: shown.append((done, total))  # noqa: E731
    found = alone.searched_again(_baseline(0.0), ahead, 12.0, (), 0, (1,), show)
    assert asked == [True, False, False][:searched]
    assert found.evidence == sum((1.5, 0.5, 0.5)[:searched]) * ALIKE
    assert not shown or shown[-1][0] == shown[-1][1]


@pytest.mark.parametrize(("tau", "asked"), [(0.5, []), (0.9 * FAR_DB, [False]), (3.0 * FAR_DB, [True, False])])
def test_a_calibrated_baseline_is_led_on_where_slopes_left_it_off(monkeypatch, tau: float, asked: list[bool]) -> None:
    seen = []

    def settled(one, targets, seed, final, advance, everywhere=False):
        seen.append(everywhere)
        return replace(one, evidence=one.evidence + 2.0 * ALIKE)

    monkeypatch.setattr(firm, "explained", lambda *_: _baseline(0.0, tau))
    monkeypatch.setattr(firm, "settled", settled)
    monkeypatch.setattr(firm, "replace", lambda one, **_: one)
    monkeypatch.setattr(firm, "anchored", lambda *_: "anew")
    given = SimpleNamespace(bench=None, calibration=("c",), scale=None, seeds=(1,), fixed={}, z=np.zeros(2))
    found = firm.firm(given, (), 0, (1,), lambda: None)
    assert seen == asked
    assert found == ("anew" if asked else given)
