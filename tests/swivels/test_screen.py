"""Beside an explanation the baseline goes back where it was before it bent itself round what is missing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.doctor.swivels import explained, screen
from ssmr_ident.doctor.swivels.candidates import candidates
from ssmr_ident.doctor.swivels.conditions import BRIEFEST, brief
from ssmr_ident.doctor.swivels.likelihood import Block, Score, score
from ssmr_ident.doctor.swivels.screen import given_way, screened

FLOOR = next(c for c in candidates((0.03,), (10.0,), 3e-5) if c.id == "load_sensitive_friction")
BINS = 600


class World:
    """Residuals that are straight lines of two parameters of a baseline and the exponent of one effect."""

    bench, calibration, fit = SimpleNamespace(prefetch=list), (), Score(0.0, 0.0, 0.0)
    scale = np.ones(3)

    def __init__(self, z=(0.0, 0.0), seeds=(1, 2)) -> None:
        random = np.random.default_rng(5)
        self.z, self.seeds = np.asarray(z, dtype=float), seeds
        self.slopes = -0.4 * random.standard_normal((BINS, 2))
        self.effect = random.standard_normal(BINS)
        self.chance = 0.1 * random.standard_normal(BINS)
        self.true = np.array([1.0, -0.6])

    def __replace__(self, **changes):
        return World(**{"z": self.z, "seeds": self.seeds, **changes})

    values = property(lambda self: {"a": float(self.z[0]), "b": float(self.z[1])})

    def log_prior(self) -> float:
        return -0.5 * float(self.z @ self.z)

    def blocks(self, conditions, effects, share):
        exponent = effects.get(FLOOR.id, {"exponent": 0.0})["exponent"]
        residual = self.chance - self.slopes @ (self.true - self.z) + self.effect * (0.35 - exponent)
        return [Block(residual, 0.02, np.zeros(1), np.ones(1))]

    def score(self, conditions, effects):
        return score([[block] for block in self.blocks(conditions, effects, 0.0)]), 0.0


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    """``dataclasses.replace`` for something that is no dataclass, as later Pythons know it."""

    def changed(one, **changes):
        return one.__replace__(**changes) if isinstance(one, World) else replace(one, **changes)

    monkeypatch.setattr(screen, "replace", changed)
    monkeypatch.setattr(explained, "replace", changed)
    return World()


def _condition(turning: float) -> SimpleNamespace:
    mean = SimpleNamespace(cross=np.zeros((BINS, 3, 3)), log_density=lambda scale: np.zeros(BINS))
    return SimpleNamespace(turning=turning, mean=mean, names=("ax", "ay", "az"))


def test_the_baseline_gives_back_what_it_took_up(world: World) -> None:
    # fitted without the effect it lies where chance of the draw put it; beside the effect it goes to its own values
    bent = World(z=(0.2, 0.5))
    found = screened([(bent, world.slopes)], FLOOR, (_condition(0.5),), lambda: None)  # type: ignore[arg-type]
    (gain, best), (less, _) = found
    assert best.values == {"exponent": 0.35}
    np.testing.assert_allclose(best.anchor.z, world.true, atol=0.15)
    assert gain > less
    assert gain > 100.0


def test_a_baseline_that_calibration_holds_stays_where_it_is(world: World) -> None:
    found = screened([(World(z=world.true), None)], FLOOR, (_condition(0.5),), lambda: None)  # type: ignore[arg-type]
    assert found[0][1].values == {"exponent": 0.35}
    np.testing.assert_array_equal(found[0][1].anchor.z, world.true)


def test_starts_are_ranked_on_the_slowest_and_the_fastest_speed(world: World) -> None:
    targets = tuple(_condition(turning) for turning in (0.9, -0.3, 0.5, 1.2))
    chosen, rows = screen._spread(targets, world)  # type: ignore[arg-type]
    assert [c.turning for c in chosen] == [-0.3, 1.2]
    np.testing.assert_array_equal(rows, np.concatenate([np.arange(BINS, 2 * BINS), np.arange(3 * BINS, 4 * BINS)]))


def test_what_slopes_cannot_take_up_moves_nothing(world: World) -> None:
    slopes = np.array([[1.0], [1.0], [-1.0], [-1.0]])
    still = World(z=(0.0,))
    moved = given_way(still, np.array([0.5, -0.5, 0.5, -0.5]), slopes)  # type: ignore[arg-type]
    np.testing.assert_allclose(moved, 0.0, atol=1e-12)


def test_a_search_simulates_less_of_each_of_many_steady_courses() -> None:
    @dataclass(frozen=True)
    class Course:
        settling: float
        duration: float

    steady, changing = Course(2.0, 12.0), Course(0.0, 30.0)
    assert brief((steady, changing), 4) == (steady, changing)  # type: ignore[arg-type, comparison-overlap]
    assert [c.duration for c in brief((steady, changing), 8)] == [7.5, 30.0]  # type: ignore[arg-type]
    assert brief((steady,), 30)[0].duration == BRIEFEST  # type: ignore[arg-type]
