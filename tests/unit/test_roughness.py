"""Where contacts slide, estimates scatter as far as the hollows of the cost are deep; elsewhere by its curvature."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bank import draw

from ssmr_ident.diagnose import exported
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.doctor.robots.calibrated import baseline_of
from ssmr_ident.doctor.robots.found import cost_of
from ssmr_ident.doctor.robots.run import under_laws_of_sliding
from ssmr_ident.identify.fitting.joint import Slopes, differentiate, evaluate
from ssmr_ident.identify.fitting.roughness import scatter_of
from ssmr_ident.identify.fitting.scatter import covariance

SAMPLES, COUNT, STEEP, HIDDEN = 400, 12, 20.0, 1.5


class Rough:
    """A trial that every parameter moves its own way, and a wave far finer than any step shakes aside."""

    name, channels, idle, nuisances, coarse, size = "made", ("force",), (), (), 2.0, SAMPLES

    def __init__(self, wave: float, searched: bool) -> None:
        self.wave, self.searched = wave, searched
        white = np.linalg.qr(np.random.default_rng(8).standard_normal((SAMPLES, COUNT + 2)))[0]
        self.along, self.aside = white[:, :COUNT], white[:, COUNT]
        self.white_target = np.sqrt(SAMPLES) * white[:, -1] + HIDDEN * self.aside
        self.target = self.white_target[:, None]

    def runs(self, asked: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
        at = np.array([point for point, _ in asked])
        waves = self.wave * np.sin(1e6 * at.sum(axis=1))
        return (STEEP * self.along @ at.T + np.outer(self.aside, waves))[:, None]

    @staticmethod
    def whitened(simulated: np.ndarray) -> np.ndarray:
        return simulated[:, 0]

    @staticmethod
    def by_channel(residual: np.ndarray) -> np.ndarray:
        return residual[:, None]


@pytest.mark.parametrize("wave", [0.3, 3.0])
def test_a_rough_cost_widens_the_scatter_by_the_depth_of_its_hollows(wave: float) -> None:
    """In closed form: beside a plane a wave s is worth w (s² - 2 s c), of a variance w² (2 c² S² + S⁴/8)."""
    model = SimpleNamespace(split=lambda point: (point,), unknowns=(), steps=lambda: [])
    found = {}
    for searched in (False, True):
        trial = Rough(wave, searched)
        begun = evaluate([trial], model, np.zeros(COUNT), [np.zeros(0)])  # type: ignore[list-item, arg-type]
        fit = replace(begun, slopes=(Slopes(STEEP * trial.along, np.zeros((SAMPLES, 0))),))
        found[searched] = scatter_of(fit)
        assert (found[searched] == covariance(fit)).all() is not searched
    depth = float(fit.weights[0]) * np.sqrt(2.0 * (HIDDEN * wave) ** 2 + wave**4 / 8.0)
    widened = np.trace(found[True]) / np.trace(found[False])
    assert widened == pytest.approx(1.0 + depth, rel=0.25)


@pytest.mark.slow
def test_estimates_from_pulls_lie_within_what_is_said_of_them() -> None:
    """The curvature alone says far too little of a cost that is rough."""
    rough, local = [], []
    for seed in (5512, 5513):
        drawn = draw("pulls", "none", seed)
        laws = under_laws_of_sliding(arranged(drawn.campaign), drawn.campaign.parameters)
        fits = [baseline_of(setup.fitted, setup.model) for setup, _ in laws]
        fit = differentiate(min(fits, key=cost_of))
        truth = drawn.truth.parameters
        places = np.array([(k, u.scaled(truth[u.name])) for k, u in enumerate(fit.model.physics) if u.name in truth])
        own = places[:, 0].astype(int)
        off = np.abs(fit.point[own] - places[:, 1])
        for found, scatter in ((rough, scatter_of(fit)), (local, covariance(fit))):
            found += list(off / np.sqrt(np.diag(scatter)[own]))
    assert np.sqrt(np.mean(np.square(rough))) < 2.0
    assert np.sqrt(np.mean(np.square(local))) > 3.0


@pytest.mark.parametrize(
    ("effect", "name", "value", "left", "std"),
    [
        ("stribeck", "kinetic_share", 0.87, 30.0, 0.05),  # begun at 0.8 and 0.9
        ("stribeck", "kinetic_share", 0.93, 30.0, 0.025),
        ("stribeck", "kinetic_share", 0.99, 30.0, 0.025),
        ("stribeck", "stribeck_velocity_m_s", 5e-4, 30.0, 1e-3),
        ("stribeck", "kinetic_share", 0.87, 1.2, 0.0),  # teeth in step
        ("stribeck", "exponent", 2.0, 30.0, 0.0),
        ("cable_compliance", "K_cable_N_m", 1e5, 30.0, 0.0),
    ],
)
def test_teeth_out_of_step_tell_no_more_than_what_they_were_begun_at(
    effect: str, name: str, value: float, left: float, std: float
) -> None:
    trial = SimpleNamespace(searched=True, size=100)
    fit = SimpleNamespace(trials=(trial,), parts=np.array([100.0 * left]))
    assert exported._between(fit, effect, name, value) == pytest.approx(std)  # type: ignore[arg-type]
