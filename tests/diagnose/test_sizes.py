"""How far the motions of a session go, told from decays that are a third noise; and probes that burst."""

from __future__ import annotations

import numpy as np
import pytest
from bank import FAMILIES, mixed

from ssmr_ident.diagnose.baseline import fit_baseline
from ssmr_ident.diagnose.scan import candidates, probes, scan
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.diagnose.sizes import sizes_of
from ssmr_ident.identify.joint import JointFit, differentiate
from ssmr_ident.pipeline.diagnose import diagnose

SEED, K3 = 6264, -4.222e7


@pytest.fixture(scope="module")
def bent() -> JointFit:
    """A baseline beside tires that soften, in nine noisy decays."""
    drawn = mixed(SEED, tuple(FAMILIES))
    assert drawn.truth.effects["nonlinear_stiffness"]["k3_N_m3"] == pytest.approx(K3, rel=1e-3)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    return differentiate(fit_baseline(setup.fitted, setup, drawn.campaign.parameters))


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


def test_tires_that_soften_are_named_under_noise() -> None:
    found = diagnose(mixed(SEED, tuple(FAMILIES)).campaign)
    assert [effect.id for effect in found.effects] == ["nonlinear_stiffness"]
    assert found.effects[0].parameters["k3_N_m3"].value == pytest.approx(K3, rel=0.1)
    assert found.heldout.after < 0.75 * found.heldout.before
    assert np.isfinite(found.heldout.after)
