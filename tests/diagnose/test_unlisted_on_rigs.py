"""What no list holds on a rig: found at the frequency that it has, and begun in the place that it may have."""

from __future__ import annotations

import math

import pytest
from small_rigs import Run, campaign, fitted, prepared

from ssmr_ident.diagnose import explore
from ssmr_ident.diagnose.explain import with_suspect
from ssmr_ident.diagnose.race import ranked, started
from ssmr_ident.diagnose.scan import PLACES, both_ways, scan
from ssmr_ident.diagnose.sizes import sizes_of
from ssmr_ident.identify.fitting.descent import LOUD
from ssmr_ident.physics.effects import CATALOGUE

pytestmark = pytest.mark.slow

RUNS = [Run(force=20.0), Run(force=40.0), Run(force=10.0)]
RIDER = {"rider_share": 0.08, "rider_Hz": 6.0, "rider_ratio": 0.04}
STOP = {"c_abs_s_N_m": 2500.0, "place_m": 6e-4}
PULSE = {"c_sin_s_N_m": 900.0, "c_cos_s_N_m": -500.0, "pulse_Hz": 1.3}


@pytest.mark.parametrize(("law", "frequency"), [(RIDER, "rider_Hz"), (PULSE, "pulse_Hz")], ids=["mass", "pulse"])
def test_a_straight_line_points_to_the_frequency(law: dict[str, float], frequency: str) -> None:
    fit = fitted(prepared(campaign({"unlisted": law}, RUNS, seed=3, duration=6.0)))
    (group,) = scan(fit, [CATALOGUE["unlisted"]])
    places = [suspect for suspect in group if frequency in suspect.at]
    assert len(places) == PLACES
    assert min(abs(math.log(s.at[frequency] / law[frequency])) for s in places) < 0.12


def test_a_bend_is_begun_in_the_middle_and_free_to_leave_it() -> None:
    """A prior as narrow as where a fit begins held a spring that touches off the middle there: a robot's (bank 6401)
    needed hardening beside it then."""
    fit = fitted(prepared(campaign({"unlisted": STOP}, RUNS, seed=3, duration=6.0)))
    (group,) = scan(fit, [CATALOGUE["unlisted"]])
    bends = [suspect for suspect in group if "place_m" in suspect.at]
    assert {math.copysign(1.0, s.at["place_m"]) if s.at["place_m"] else 0.0 for s in bends} == {-1.0, 0.0, 1.0}
    assert {s.sizes["place_m"] for s in bends} == {max(s.at["place_m"] for s in bends)}
    model, _ = with_suspect(fit, next(s for s in bends if not s.at["place_m"]))
    assert model.free[-1].unknown.prior_std == pytest.approx(1.2 * sizes_of(fit)["deflection"])
    # and is not turned about with the sign of its stiffness
    assert [way.at["place_m"] for way in both_ways(bends[0])] == [bends[0].at["place_m"]] * 2


def test_where_the_first_horizons_mislead_whole_recordings_are_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mass that rides along looks like hardening for a while; no law along a path comes near it."""
    fit = fitted(prepared(campaign({"unlisted": RIDER}, RUNS, seed=3, duration=6.0)))

    def misled(base, groups, lengths, progress):  # type: ignore[no-untyped-def]
        return [started(base, group[0]) for group in groups if group[0].effect == "nonlinear_stiffness"]

    monkeypatch.setattr(explore, "screened", misled)
    tried = explore.search(fit, "sdof", (1.0, math.inf)).tried
    assert [f.model.ids for f in ranked(tried)[:1]] == [("unlisted",)]
    assert "rider_share" in {c.parameter.name for c in ranked(tried)[0].model.free}
    assert ("nonlinear_stiffness",) in [f.model.ids for f in tried]


def test_where_a_law_explains_all_only_what_is_no_law_is_tried_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    fit = fitted(prepared(campaign({"unlisted": STOP}, RUNS, seed=3, duration=6.0)))
    asked: list[set[str]] = []

    def screened(base, groups, lengths, progress):  # type: ignore[no-untyped-def]
        asked.extend(set(suspect.at) for group in groups for suspect in group)
        return []

    monkeypatch.setattr(explore, "screened", screened)
    found = explore.search(fit, "sdof", (1.0, math.inf))
    assert ranked(found.tried)[0].model.ids == ("unlisted",)
    assert max(ranked(found.tried)[0].parts / [t.size for t in fit.trials]) < LOUD
    assert any("rider_share" in names for names in asked)
    assert not any({"c_abs_s_N_m", "k3_N_m3", "gap_m"} & names for names in asked)
    # what is reported of all suspects is as it was
    assert {"nonlinear_stiffness", "free_play"} <= {group[0].effect for group in found.suspects}
