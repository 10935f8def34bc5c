"""Peers on rigs whose answer is known: they run, they recover the baseline, and what they claim is read right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bank import draw

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.rig import rig_from_parameters
from ssmr_ident.simulate.rig import simulate_rig
from ssmr_proof.peers import grey_box, mujoco_sysid, sindy

pytestmark = pytest.mark.slow


def quiet(campaign: Campaign, noise: float = 0.01) -> Campaign:
    """The same drives through the file's own linear rig, with white noise."""
    rng = np.random.default_rng(5)
    made = []
    for m in campaign.measurements:
        force = m.recording["force"]
        motion = simulate_rig(rig_from_parameters(campaign.parameters), force, m.recording.sample_rate)[:, 2]
        motion += noise * rng.standard_normal(len(force))
        channels = [
            m.recording.channel("force"),
            replace(m.recording.channels[-1], name="acceleration", samples=motion),
        ]
        made.append(replace(m, recording=replace(m.recording, channels=tuple(channels))))
    return replace(campaign, measurements=tuple(made))


@pytest.fixture(scope="module")
def null() -> Campaign:
    return quiet(draw("forced", "none", 3, short=True).campaign)


def test_least_squares_finds_the_rig_and_a_white_residual(null: Campaign) -> None:
    answer = grey_box(null)
    assert not answer.says_missing, answer
    for name, (value, half) in answer.parameters.items():
        assert abs(value - null.parameters.number(name)) < 2.0 * half


def test_least_squares_sees_that_something_is_missing() -> None:
    answer = grey_box(draw("forced", "one", 3, "nonlinear_stiffness", 1.0, short=True).campaign)
    assert answer.says_missing
    assert answer.effects == ()


def test_pysindy_reads_a_cubic_spring() -> None:
    pytest.importorskip("pysindy")
    answer = sindy(draw("forced", "one", 4, "nonlinear_stiffness", 1.0, short=True).campaign)
    assert "nonlinear_stiffness" in answer.effects, answer


def test_mujoco_recovers_the_rig(null: Campaign) -> None:
    pytest.importorskip("mujoco.sysid.report.defaults")
    answer = mujoco_sysid(null)
    assert not answer.says_missing
    for name, (value, _) in answer.parameters.items():
        assert value == pytest.approx(null.parameters.number(name), rel=0.01)


def test_peers_refuse_what_is_no_driven_rig() -> None:
    with pytest.raises(InputError, match="not a rig driven"):
        grey_box(draw("rig_decay", "none", 1, short=True).campaign)
