"""Pulls of a robot off its centre: which law of sliding decides where one of them is explained by neither."""

from __future__ import annotations

from dataclasses import replace

import pytest
from pulls_off_centre import AXLES, PULLS, pulled

from ssmr_ident.core.parameter import Estimate
from ssmr_ident.core.recording import Channel
from ssmr_ident.diagnose.baseline import best_baseline
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.diagnose.sliding import KEY, of_those_that_stand
from ssmr_ident.physics.robot import SLIDING_SPEED


@pytest.mark.parametrize(("cone", "plan"), [(False, PULLS), (True, AXLES)])
def test_a_pull_on_wheels_that_turn_has_no_say_where_neither_law_explains_it(
    cone: bool, plan: tuple[tuple[float, tuple[int, ...]], ...]
) -> None:
    campaign = pulled(cone, (plan[0], *plan), noise=0.05)
    # under neither law does a wheel fall to a third of its force
    strange = campaign.measurements[0]
    force = Channel("force", strange.recording["force"] / 3.0, "N")
    channels = tuple(force if c.name == "force" else c for c in strange.recording.channels)
    measured = (replace(strange, recording=replace(strange.recording, channels=channels)), *campaign.measurements[1:])
    campaign = replace(campaign, measurements=measured)
    known = campaign.parameters
    decided = known.updated({KEY: Estimate(SLIDING_SPEED, None, "m/s", fixed=True)})
    laws = [(set_up(replace(campaign, parameters=p), p), p) for p in (known, decided)]
    assert strange.name in [trial.name for trial in laws[0][0].fitted]
    fits = [best_baseline(setup.fitted, setup, p)[0] for setup, p in laws]
    assert of_those_that_stand(laws, {strange.name}, fits) == cone
    everything = {m.name for m in campaign.measurements}
    assert of_those_that_stand(laws, everything, fits) == 0  # none stands: the file's own law
    if cone:  # it would have turned the answer round
        assert of_those_that_stand(laws, set(), fits) == 0
