"""A baseline that has left what is known of it to follow recordings without what is missing."""

from __future__ import annotations

import numpy as np
import pytest
from bank import draw

from ssmr_ident.compare.recorded import follow, nearest
from ssmr_ident.diagnose import explore
from ssmr_ident.diagnose.baseline import bent, best_baseline
from ssmr_ident.diagnose.explain import SETTLING, beside, with_suspect
from ssmr_ident.diagnose.explore import search
from ssmr_ident.diagnose.race import FAR, started
from ssmr_ident.diagnose.scan import PROMISING, out_of_reach, scan
from ssmr_ident.diagnose.setup import set_up
from ssmr_ident.diagnose.sliding import with_law_of_sliding
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.physics.effects import CATALOGUE


def test_a_belt_that_no_straight_line_promises_is_tried_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = draw("decays", "one", 2, "motor_belt", 0.8, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    if not bent(base):
        pytest.skip("with this processor's rounding the baseline ends elsewhere")
    fields: list[list[JointFit]] = []
    monkeypatch.setattr(explore, "run_on", lambda field: fields.append(field) or field[:1])
    found = search(base, "rigid6", lengths)
    (belt,) = [group for group in found.suspects if group[0].effect == "motor_belt"]
    assert belt[0].gain < PROMISING + len(belt[0].at)
    tried = [fit for fit in fields[0] if fit.model.ids == ("motor_belt",)]
    # from the baseline and from what is known; and in the place of what the baseline had left that for
    assert len(tried) == 2 * len({s.at["K_b_N_m"] for s in belt}) + 1
    probes = {s.at["K_b_N_m"] for s in belt}
    led = [fit for fit in tried if fit.model.split(fit.point)[1]["motor_belt"]["K_b_N_m"] in probes]
    assert len(led) == len(probes)  # held there until now
    for fit in led:
        known = np.concatenate([np.zeros(len(base.model.physics)), fit.point[len(base.point) :]])
        assert fit.cost(base.counted) < follow(base.trials, fit.model, known).cost(base.counted)
    assert not [fit for fit in fields[0] if fit.model.ids == ("sensor_saturation",)]


def test_what_acts_beyond_some_value_is_tried_where_kept_recordings_alone_leave_something(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drawn = draw("decays", "none", 3, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    assert not bent(base)
    tried: list[list[tuple[str, ...]]] = []
    monkeypatch.setattr(explore, "run_on", lambda field: tried.append([fit.model.ids for fit in field]) or field[:1])
    for elsewhere in (False, True):
        search(base, "rigid6", lengths, elsewhere=elsewhere)
    assert not scan(base, [CATALOGUE["wheel_lift"]], small=True)  # no wheel lifts where the baseline is
    for effect in ("motor_belt", "wheel_lift"):
        without, with_it = (ids.count((effect,)) for ids in tried)
        assert without == 0
        assert with_it >= 2  # from the baseline, and from what is known


def test_releases_are_begun_anew_beside_wheels_that_lift() -> None:
    """What was fitted with all wheels on the floor holds them there, though small motions lead to a better fit."""
    drawn = draw("decays", "one", 13, "wheel_lift", 0.8, short=True)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, _ = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    ((lift,),) = out_of_reach(base, [CATALOGUE["wheel_lift"]], [])
    model, _ = with_suspect(base, lift)
    held = descend(nearest(base.trials, model, base.point, base.nuisances), SETTLING)
    begun = beside(base, lift)
    without = base.cost(base.counted)
    assert held.cost(base.counted) > without + 100.0
    assert begun.cost(base.counted) < without - 100.0


def test_an_effect_in_pulls_is_begun_beside_the_robot_as_known() -> None:
    """A wheel whose load the baseline had put elsewhere stays there beside a soft cable, and slides too late."""
    drawn = draw("bench", "one", 5548)
    assert set(drawn.truth.effects) == {"cable_compliance"}
    setup, known = with_law_of_sliding(drawn.campaign, drawn.campaign.parameters, None)
    base, lengths = setup.begun or best_baseline(setup.fitted, setup, known)
    if not bent(base):
        pytest.skip("with this processor's rounding the baseline ends elsewhere")
    cable = scan(base, [CATALOGUE["cable_compliance"]])[0][0]
    bent_as_well = descend(started(base, cable), 8)
    (found,) = [fit for fit in search(base, "rigid6", lengths).tried if fit.model.ids == ("cable_compliance",)]
    assert found.cost(base.counted) < bent_as_well.cost(base.counted) - 200.0
    assert np.all(np.abs(found.point[: len(base.model.physics)]) < FAR)
    true = drawn.truth.effects["cable_compliance"]["K_cable_N_m"]
    assert found.model.split(found.point)[1]["cable_compliance"]["K_cable_N_m"] == pytest.approx(true, rel=0.02)


def test_a_slow_sensor_on_a_rig_is_asked_where_anything_else_is() -> None:
    """A quick sensor's straight line promises nothing, for a little of its delay is a little damping."""
    drawn = draw("rig_decay", "one", 5435)
    setup = set_up(drawn.campaign, drawn.campaign.parameters)
    base, lengths = best_baseline(setup.fitted, setup, drawn.campaign.parameters)
    found = search(base, "sdof", lengths)
    (sensor,) = [group for group in found.suspects if group[0].effect == "sensor_bandwidth"]
    assert sensor[0].gain < PROMISING
    best = min(found.tried, key=lambda fit: fit.cost(base.counted))
    assert best.model.ids == ("sensor_bandwidth",)
    true = drawn.truth.effects["sensor_bandwidth"]["bandwidth_hz"]
    assert best.model.split(best.point)[1]["sensor_bandwidth"]["bandwidth_hz"] == pytest.approx(true, rel=0.05)
