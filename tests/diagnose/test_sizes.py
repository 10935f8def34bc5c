"""How far the motions of a session go, told from decays that are a third noise; and probes that burst."""

from __future__ import annotations

import numpy as np
import pytest
from bank import FAMILIES, draw, mixed
from bank.decays import draw_decays
from bank.scaled import Scale

from ssmr_ident.diagnose.scan import candidates, probes, scan
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.diagnose.sizes import limits_of, sizes_of
from ssmr_ident.doctor.robots.calibrated import baseline_of
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.physics.effects import CATALOGUE

pytestmark = pytest.mark.slow

SEED, K3 = 6264, -4.222e7
OF_ANY_SIZE = ("flexible_mast", "com_offset", "motor_belt", "sensor_bandwidth")


@pytest.fixture(scope="module")
def bent() -> JointFit:
    """A baseline beside tires that soften, in nine noisy decays."""
    drawn = mixed(SEED, tuple(FAMILIES))
    assert drawn.truth.effects["nonlinear_stiffness"]["k3_N_m3"] == pytest.approx(K3, rel=1e-3)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    return differentiate(baseline_of(setup.fitted, setup.model))


def test_motions_are_as_large_as_the_states_they_begin_in_and_not_as_their_noise_is_quick(bent: JointFit) -> None:
    sizes = sizes_of(bent)
    starts = {
        trial.name: dict(zip(trial.nuisances, own * trial.scales, strict=True))
        for trial, own in zip(bent.trials, bent.nuisances, strict=True)
    }
    farthest = max(abs(start["x"]) for start in starts.values())
    assert 3e-3 < farthest < 8e-3
    assert sizes["reach"] == pytest.approx(farthest, rel=0.25)
    assert sizes["slope"] == pytest.approx(bent.model.split(bent.point)[0]["tire.stiffness_x_N_m"])
    # the loudest goes along the stiffer axis, and less far
    assert 0.5e-3 < sizes["deflection"] < 2.5e-3
    assert 1.0 / sizes["time"] == pytest.approx(49.0, rel=0.1)


def test_a_spring_that_would_soften_to_nothing_is_tried_at_a_tenth(
    bent: JointFit, monkeypatch: pytest.MonkeyPatch
) -> None:
    softens = [e for e in candidates(bent, "rigid6") if e.id == "nonlinear_stiffness"]
    at = probes(bent, softens)
    far = [(effect, {**p, "k3_N_m3": -20.0 * abs(p["k3_N_m3"])}, held) for effect, p, held in at if "k3_N_m3" in p][:1]
    monkeypatch.setattr("ssmr_ident.diagnose.scan.probes", lambda fit, effects: far)
    ((suspect,),) = scan(bent, softens)
    assert suspect.at["k3_N_m3"] == pytest.approx(K3, rel=0.6)


@pytest.mark.parametrize("scale", [Scale(0.064, 0.4), Scale(15.6, 2.5)])
def test_a_search_begins_alike_on_robots_of_all_sizes(scale: Scale) -> None:
    """Units grow with the robot, and with them where effects are looked for and how far they may go."""
    found = []
    for own in (Scale(), scale):
        campaign = draw_decays("none", 5, None, 0.0, True, own).campaign
        setup = set_up(campaign, campaign.parameters)
        model = setup.model
        point = model.as_known(np.zeros(len(model.unknowns)))
        values, effects = model.split(point)
        fit = evaluate(setup.fitted, model, point, [t.begin(values, effects) for t in setup.fitted])
        asked = [e for e in candidates(fit, "rigid6") if e.id in OF_ANY_SIZE]
        assert {e.id for e in asked} == set(OF_ANY_SIZE)
        found.append((probes(fit, asked), {e.id: limits_of(fit, e) for e in asked}))
    (ours, limits), (theirs, their_limits) = found
    for (effect, at, _), (_, grown, _) in zip(ours, theirs, strict=True):
        units = {p.name: p.unit for p in effect.parameters}
        assert grown == pytest.approx({n: scale.factor(units[n]) * value for n, value in at.items()}, rel=0.02)
        for name, (low, high) in limits[effect.id].items():
            assert low <= at[name] <= high
            own = scale.factor(units[name])
            assert their_limits[effect.id][name] == pytest.approx((own * low, own * high), rel=0.02)


def test_a_cable_stretches_by_no_more_than_the_head_goes() -> None:
    """On a bench a wheel is pressed as well, which rises far more steeply than any cable lets a drag rise."""
    drawn = draw("bench", "one", 3, "cable_compliance", 1.0, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    point = setup.model.as_known(np.zeros(len(setup.model.unknowns)))
    values, effects = setup.model.split(point)
    fit = evaluate(setup.fitted, setup.model, point, [t.begin(values, effects) for t in setup.fitted])
    assert any(trial.experiment.vertical for trial in fit.trials)
    low, high = limits_of(fit, CATALOGUE["cable_compliance"])["K_cable_N_m"]
    rises = [np.ptp(t.target) / t.facts["travel_m"] for t in fit.trials if not t.experiment.vertical]
    assert low == pytest.approx(0.8 * max(rises))
    assert low < drawn.truth.effects["cable_compliance"]["K_cable_N_m"] < high == np.inf
