"""Ramps, teeth, springs and friction on forces that are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.identify.forces.curves import load_curve
from ssmr_ident.identify.forces.ramps import find_ramps
from ssmr_ident.identify.forces.sawtooth import take_apart
from ssmr_ident.identify.forces.speed_knee import speed_knee
from ssmr_ident.identify.forces.stiffness import behind_cable, belt_stiffness, compare_laws, in_series


def saw(position: np.ndarray, stiffness: float, peak: float, trough: float) -> np.ndarray:
    """Relay friction without inertia: rises with the spring to the peak, falls at once to the trough."""
    force, level = np.empty(len(position)), 0.0
    steps = np.diff(position, prepend=position[0])
    for index, step in enumerate(steps):
        level += stiffness * step
        if level > peak:
            level = trough
        force[index] = level
    return force


POSITION = np.linspace(0, 0.1, 6000)


def test_teeth_of_a_saw() -> None:
    rng = np.random.default_rng(0)
    pull = take_apart(POSITION, saw(POSITION, 6000.0, 190.0, 150.0) + rng.normal(size=len(POSITION)))
    assert pull.stick_slip
    expected = (600.0 - 190.0) // 40.0 + 1
    assert len(pull.teeth) == pytest.approx(expected, abs=1)
    assert abs(pull.first.slope - 6000.0) < 3.5 * pull.first.slope_std
    assert np.mean([tooth.peak for tooth in pull.teeth]) == pytest.approx(190.0, rel=0.01)
    assert np.mean([tooth.trough for tooth in pull.teeth]) == pytest.approx(150.0, rel=0.02)
    assert "teeth" in str(pull)


def _swung(force: np.ndarray, rebound: float) -> np.ndarray:
    """What a body adds that swings after every drop: up within 15 samples, back within 30 more [N]."""
    drops = np.flatnonzero(np.diff(force) < -10.0) + 1
    swing = np.interp(np.arange(45), [0, 15, 45], [0.0, rebound, 0.0])
    added = force.copy()
    for drop in drops:
        stretch = added[drop : drop + 45]
        stretch += swing[: len(stretch)]
    return added


@pytest.mark.parametrize("rebound", [5.0, 12.0, 25.0])
def test_a_body_that_swings_after_every_drop_hides_no_teeth(rebound: float) -> None:
    rng = np.random.default_rng(0)
    clean = saw(POSITION, 6000.0, 190.0, 150.0)
    pull = take_apart(POSITION, _swung(clean, rebound) + 0.3 * rng.normal(size=len(POSITION)))
    assert len(pull.teeth) == pytest.approx((600.0 - 190.0) // 40.0 + 1, abs=1)
    assert np.mean([tooth.peak for tooth in pull.teeth]) == pytest.approx(190.0, rel=0.01)
    assert np.mean([tooth.trough for tooth in pull.teeth]) == pytest.approx(150.0, rel=0.02)
    assert all(tooth.slope == pytest.approx(6000.0, rel=0.3) for tooth in pull.teeth)


@pytest.mark.parametrize("stiffness", [0.0, 1000.0])
def test_drops_without_a_rise_as_steep_as_the_first_are_no_teeth(stiffness: float) -> None:
    """The rebound alone is steep: what follows it stays level, or rises as no spring that loads the contact does."""
    rng = np.random.default_rng(4)
    rising = np.minimum(6000.0 * POSITION, 190.0)
    sliding = POSITION > 190.0 / 6000.0
    after = saw(POSITION[sliding] - POSITION[sliding][0], stiffness or 1e-9, 20.0, 0.0)
    steps = np.where(np.arange(sliding.sum()) // 600 % 2, 20.0, 0.0) if not stiffness else after
    force = rising.copy()
    force[sliding] = 170.0 + steps
    pull = take_apart(POSITION, _swung(force, 12.0) + 0.3 * rng.normal(size=len(POSITION)))
    assert not pull.teeth


@pytest.mark.slow
def test_slope_intervals_cover() -> None:
    rng = np.random.default_rng(1)
    misses = []
    for _ in range(30):
        force = np.minimum(7000.0 * POSITION[::3], 250.0) + rng.normal(size=2000)
        first = take_apart(POSITION[::3], force).first
        misses.append((first.slope - 7000.0) / first.slope_std)
    # 30 runs of a unit normal: std 1 ± 0.26 and mean 0 ± 0.36 at 95 %
    assert 0.6 < np.std(misses) < 1.5
    assert abs(np.mean(misses)) < 0.6


def test_plateau_makes_no_claim() -> None:
    rng = np.random.default_rng(2)
    wander = 6.0 * np.sin(2 * np.pi * POSITION / 0.02) + np.cumsum(0.05 * rng.normal(size=len(POSITION)))
    force = np.minimum(7000.0 * POSITION, 250.0) + np.where(POSITION > 0.04, wander, 0)
    pull = take_apart(POSITION, force + rng.normal(size=6000))
    assert not pull.stick_slip
    assert pull.slides
    assert pull.level == pytest.approx(250.0, abs=5 * max(pull.level_std, 0.5))


def test_knees_and_holds() -> None:
    """Two wheels let go before the others; the machine holds still for a while in the middle of the first rise."""
    rng = np.random.default_rng(3)
    position = np.concatenate([np.linspace(0, 0.015, 900), np.full(700, 0.015), np.linspace(0.015, 0.07, 3300)])
    force = np.interp(position, [0, 0.03, 0.05, 0.07], [0, 210, 280, 280]) + rng.normal(size=len(position))
    pull = take_apart(position, force)
    assert pull.first.slope == pytest.approx(7000, rel=0.01)
    assert pull.level == pytest.approx(280, abs=1)


def test_ramps_find_every_piece() -> None:
    rng = np.random.default_rng(4)
    x = np.linspace(0, 1, 900)
    y = np.select([x < 0.3, x < 0.6], [100 * x, 10 + 0 * x], 40 - 50 * x) + 0.2 * rng.normal(size=len(x))
    ramps = [ramp for ramp in find_ramps(x, y) if ramp.samples > 20]
    assert [round(ramp.slope, -1) for ramp in ramps] == [100, 0, -50]


def test_springs() -> None:
    assert behind_cable(in_series(22500.0, 6000.0), 6000.0) == pytest.approx(22500.0)
    assert belt_stiffness(6000.0) == 3000.0
    with pytest.raises(ValueError, match="not below"):
        behind_cable(7000.0, 6000.0)


def test_laws_are_told_apart() -> None:
    rng = np.random.default_rng(5)
    x = np.linspace(0, 0.008, 500)
    noise = 0.8 * rng.normal(size=len(x))
    assert compare_laws(x, 18000 * x + noise).best.name == "linear"
    # section 3.3: 15 kN/m up to 90 N, 21 kN/m beyond
    two = compare_laws(x, np.where(x < 0.006, 15000 * x, 90 + 21000 * (x - 0.006)) + noise).best
    assert two.name == "two slopes"
    assert abs(two.values["stiffness"] - 15000) < 4 * two.stds["stiffness"]
    assert abs(two.values["stiffness_2"] - 21000) < 4 * two.stds["stiffness_2"]
    assert two.values["knee"] == pytest.approx(0.006, abs=5e-4)
    cubic = compare_laws(x, 15000 * x + 3e8 * x**3 + noise).best
    assert cubic.name == "cubic"
    assert abs(cubic.values["k3"] - 3e8) < 4 * cubic.stds["k3"]


def test_load_curve_of_a_press() -> None:
    rng = np.random.default_rng(6)
    position = np.linspace(0, 0.004, 2000)
    force = np.maximum(80000.0 * (position - 0.001), 0) + 0.7 * rng.normal(size=len(position))
    curve = load_curve(position, force)
    assert abs(curve.stiffness - 80000.0) < 3.5 * curve.stiffness_std
    assert curve.choice.best.name == "linear"
    assert curve.zero == pytest.approx(0.0, abs=0.3)
    with pytest.raises(ValueError, match="hardly moves"):
        load_curve(np.zeros(100), force[:100])


@pytest.mark.slow
def test_speed_knee() -> None:
    """Section 3.3: a nearly linear fall, flat from 0.04 m/s on."""
    rng = np.random.default_rng(8)
    speed = np.linspace(0.002, 0.09, 24)
    clean = 25 + 170 * np.maximum(0, 1 - speed / 0.04)
    misses = []
    for _ in range(60):
        knee = speed_knee(speed, clean + 2 * rng.normal(size=len(speed)))
        misses.append(
            [
                (knee.at_rest - 195) / knee.at_rest_std,
                (knee.flat - 25) / knee.flat_std,
                (knee.knee - 0.04) / knee.knee_std,
            ]
        )
    # 60 runs of a unit normal: std 1 ± 0.18, mean 0 ± 0.25 at 95 %
    assert np.all(np.abs(np.std(misses, axis=0) - 1) < 0.35)
    assert np.all(np.abs(np.mean(misses, axis=0)) < 0.4)
    with pytest.raises(ValueError, match="5 different"):
        speed_knee(speed[:4], clean[:4])
