"""Laws of a robot's decays end where they leave noise, on robots of another plant."""

from __future__ import annotations

import pytest
from bank.decays import draw_decays
from doctor.sources import drawn_by

from ssmr_ident.doctor.decays import law_members, linear_members, run, search
from ssmr_ident.doctor.decays.laws import left_known
from ssmr_ident.doctor.decays.linear import fit_linear
from ssmr_ident.doctor.decays.small_motions import small_motions
from ssmr_ident.identify.trials.decay import FEWEST


@pytest.mark.slow
@pytest.mark.parametrize("seed", [910002, 910003, 910005])
def test_hardening_is_fitted_down_to_the_noise(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From a baseline that leaves three to eight times the noise."""
    members = linear_members.members
    monkeypatch.setattr(
        linear_members, "members", lambda fit: [m for m in members(fit) if m.id == "nonlinear_stiffness"]
    )
    drawn = draw_decays("one", seed, "nonlinear_stiffness", None, True)
    setup, decays = run._prepared(drawn.campaign, drawn.campaign.parameters)
    found = search.begun(decays, setup.model)
    assert found.over(found.baseline) > 2.9
    law_members.laws_beside(found, found.baseline, lambda *_: None)
    law_members.settled(found, lambda *_: None)
    assert found.over(min(found.found, key=lambda f: f.cost)) < 1.2


@pytest.mark.slow
def test_a_stiffness_that_changes_over_each_recording_is_of_that_kind(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside hardening, which makes as much of it as a wrong law can."""
    members = linear_members.members
    monkeypatch.setattr(
        linear_members, "members", lambda fit: [m for m in members(fit) if m.id == "nonlinear_stiffness"]
    )
    drawn = drawn_by("bank/decays/missing/636009")
    assert drawn.truth.formula == "a stiffness that changes over each recording"
    setup, decays = run._prepared(drawn.campaign, drawn.campaign.parameters)
    found = search.begun(decays, setup.model)
    law_members.laws_beside(found, found.baseline, lambda *_: None)
    law_members.settled(found, lambda *_: None)
    best = found.best
    assert [m.kind for m in best.members] == ["changing"]
    assert found.over(best) < 1.1


@pytest.mark.slow
def test_small_motions_show_the_robot_that_large_ones_hide(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wheels that leave the floor: the baseline of whole recordings leaves what is known, that of their ends does not,
    and the law begun there follows them."""
    members = linear_members.members
    monkeypatch.setattr(linear_members, "members", lambda fit: [m for m in members(fit) if m.id == "wheel_lift"])
    drawn = draw_decays("one", 910003, "wheel_lift", 1.0, False)
    setup, decays = run._prepared(drawn.campaign, drawn.campaign.parameters)
    found = search.begun(decays, setup.model)
    assert found.baseline.fit is not None
    assert left_known(found.baseline.fit)
    point = small_motions(found.decays, setup.model)
    assert point is not None
    assert abs(point).max() < 3.0
    ends = [d.later(0.6 * float(d.times[-1])) for d in found.decays]
    at_ends, known = (fit_linear(ends, setup.model, x, 0) for x in (point, 0.0 * point))
    assert at_ends is not None
    assert known is not None
    assert at_ends.chi2 < 1.2 * sum(d.trial.size for d in ends) < 0.5 * known.chi2
    law_members.laws_beside(found, found.baseline, lambda *_: None)
    (law,) = (f for f in found.found if not f.members[0].generic)
    assert found.over(law) < 1.1 < 0.6 * found.over(found.baseline)


@pytest.mark.slow
def test_an_end_of_a_decay_is_its_last_part() -> None:
    drawn = draw_decays("none", 910003, None, None, True)
    _, decays = run._prepared(drawn.campaign, drawn.campaign.parameters)
    whole = decays[0].trial
    late, cut = whole.since(0.25), round(0.25 / whole.step)
    assert late.times == pytest.approx(whole.times[cut:])
    assert (late.target == whole.target[cut:]).all()
    assert len(whole.since(1e3).times) == FEWEST
