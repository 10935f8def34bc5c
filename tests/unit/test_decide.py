"""The decision on tables written by hand: no simulation."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from ssmr_ident.doctor.decide import MISSING, NOTHING, UNDETERMINED, decide
from ssmr_ident.doctor.laws import best_shape
from ssmr_ident.doctor.left import Left
from ssmr_ident.doctor.table import Row

SAMPLES = 5000.0


def row(ids: str, kinds: str, evidence: float, chi2: float, over: float = 1.0, generic: bool = False,
        variables: tuple[str, ...] = ()) -> Row:  # fmt: skip
    return Row(tuple(ids.split()), tuple(kinds.split()), ids or "baseline", generic, evidence, chi2, SAMPLES, over,
               variables=variables)  # fmt: skip


BASE = row("", "", 0.0, 50_000.0, 3.0)


def test_nothing_beats_the_baseline() -> None:
    quiet = row("", "", 0.0, 5000.0, 1.0)
    found = decide([quiet, row("dry_friction", "static_force", 4.0, 4990.0)])
    assert found.verdict == NOTHING
    assert found.chosen is None


def test_what_predicts_unseen_recordings_worse_is_no_finding() -> None:
    quiet = replace(row("", "", 0.0, 5000.0, 1.0), heldout=3.63)
    rides = row("unlisted", "extra_motion", 23.0, 4930.0)
    assert decide([quiet, replace(rides, heldout=3.64)]).verdict == NOTHING
    assert decide([quiet, replace(rides, heldout=3.60)]).chosen is not None
    assert decide([quiet, rides]).chosen is not None  # nothing was kept back


def test_much_is_left_and_nothing_takes_it() -> None:
    found = decide([BASE, row("dry_friction", "static_force", 4.0, 49_990.0, 3.0)])
    assert found.verdict == UNDETERMINED
    assert [s.kind for s in found.kinds] == ["static_force"]


def test_a_named_law_beside_its_kind_in_any_shape() -> None:
    law = row("nonlinear_stiffness", "static_force", 22_500.0, 5000.0)
    shape = row("unlisted", "static_force", 22_450.0, 4980.0, generic=True)
    other = row("hysteresis", "memory", 9000.0, 32_000.0, 2.5)
    found = decide([BASE, law, shape, other])
    assert found.verdict == MISSING
    assert found.chosen is law
    assert found.listed
    assert found.ties == ()
    assert found.confidence > 0.99
    assert [s.kind for s in found.kinds] == ["static_force", "memory"]
    assert found.kinds[0].share > 0.99 > found.kinds[1].share


def test_a_displaced_place_is_held_against_what_the_file_states() -> None:
    """It has one place; a mast may lie anywhere in a band, and gains as much by chance."""
    quiet = row("", "", 0.0, 5000.0, 1.0)
    offset, mast = row("com_offset", "geometry", 9.0, 4990.0), row("flexible_mast", "extra_motion", 10.0, 4985.0)
    assert decide([quiet, offset, mast]).chosen is offset
    assert decide([quiet, replace(offset, log_evidence=7.0), mast]).verdict == NOTHING


def test_a_law_that_leaves_half_of_the_misfit_is_named_without_much_confidence() -> None:
    """The world's own law would leave noise alone; nothing else was any better."""
    law = row("dry_friction", "memory", 9000.0, 25_000.0, 2.2)
    found = decide([BASE, law])
    assert found.chosen is law
    left = (25_000 / 5000 - 1.21) / (BASE.chi2 / 5000 - 1.0)
    assert found.confidence == pytest.approx(1.0 - left, abs=1e-6)
    noisy = replace(law, chi2=1.2 * 5000)
    assert decide([BASE, noisy]).confidence > 0.99


def test_two_laws_fit_alike() -> None:
    first = row("quadratic_damping", "static_force", 22_500.0, 5000.0)
    second = row("dry_friction", "static_force", 22_498.0, 5004.0)
    found = decide([BASE, first, second])
    assert found.chosen is first
    assert found.ties == ("dry_friction",)
    assert 0.8 < found.confidence < 0.95


def test_a_shape_that_no_law_has_is_unlisted() -> None:
    law = row("nonlinear_stiffness", "static_force", 18_000.0, 14_000.0, 1.6)
    shape = row("unlisted", "static_force", 22_400.0, 5000.0, generic=True)
    found = decide([BASE, law, shape])
    assert found.verdict == MISSING
    assert not found.listed
    assert found.chosen is shape


def test_a_formula_a_little_off_is_still_that_law() -> None:
    law = row("nonlinear_stiffness", "static_force", 22_200.0, 5600.0, 1.05)
    shape = row("unlisted", "static_force", 22_400.0, 5000.0, generic=True)
    found = decide([BASE, law, shape])
    assert found.listed
    assert found.chosen is law
    assert 0.0 < found.left < 0.02


def test_friction_in_another_formula_is_friction_where_its_kind_needs_it() -> None:
    law = row("dry_friction", "static_force", 20_000.0, 9600.0, 1.38)
    shape = row("unlisted", "static_force", 20_500.0, 8600.0, 1.31, generic=True)
    both = row("dry_friction unlisted", "static_force static_force", 22_300.0, 5000.0, 1.0, generic=True)
    assert decide([BASE, law, shape, both]).chosen is law
    smooth = row("dry_friction unlisted", "static_force static_force", 20_502.0, 8590.0, 1.31, generic=True)
    assert not decide([BASE, law, shape, smooth]).listed


def test_friction_on_one_side_of_the_travel_is_no_formula_of_friction() -> None:
    law = row("dry_friction", "static_force", 20_000.0, 8000.0, 1.8, variables=("v",))
    alone = row("unlisted", "static_force", 21_000.0, 5900.0, 1.2, generic=True, variables=("",))
    kinds = "static_force static_force"
    beside = row("dry_friction unlisted", kinds, 21_050.0, 5700.0, 1.1, True, ("v", ""))
    of_speed = row("dry_friction unlisted", kinds, 20_040.0, 7850.0, 1.8, True, ("v", "v"))
    found = decide([BASE, law, alone, beside, of_speed])
    assert not found.listed
    formula = replace(of_speed, log_evidence=21_040.0, chi2=5750.0, over=1.1)
    assert decide([BASE, law, alone, beside, formula]).chosen is law


def test_a_second_effect_has_to_beat_the_first_in_any_shape() -> None:
    law = row("dry_friction", "static_force", 20_000.0, 9000.0, 1.34)
    shape = row("unlisted", "static_force", 22_300.0, 5200.0, 1.02, generic=True)
    pair = row("dry_friction sensor_bandwidth", "static_force sensor_chain", 22_310.0, 5180.0, 1.02)
    found = decide([BASE, law, shape, pair])
    assert found.chosen is not pair


def test_a_second_effect_that_is_there() -> None:
    law = row("dry_friction", "static_force", 20_000.0, 9000.0, 1.34)
    shape = row("unlisted", "static_force", 20_100.0, 8700.0, 1.32, generic=True)
    pair = row("dry_friction sensor_bandwidth", "static_force sensor_chain", 22_400.0, 5000.0, 1.0)
    found = decide([BASE, law, shape, pair])
    assert found.chosen is pair
    assert found.listed


def test_a_second_effect_of_less_than_a_hundredth_in_size_is_not_believed() -> None:
    base = row("", "", 0.0, 1e8, 100.0)
    law = row("dry_friction", "static_force", 49_990_000.0, 20_000.0, 2.0)
    shape = row("unlisted", "static_force", 49_990_010.0, 19_900.0, 1.99, generic=True)
    pair = row("dry_friction sensor_bandwidth", "static_force sensor_chain", 49_994_900.0, 10_200.0, 1.3)
    assert decide([base, law, shape, pair]).chosen is law
    more = replace(pair, log_evidence=49_997_000.0, chi2=5900.0, over=1.0)
    assert decide([base, law, shape, more]).chosen is more


def test_a_shape_between_those_of_a_grid_is_found() -> None:
    def along(shape):
        return (math.log(shape["gap_m"] / 0.37)) ** 2, shape, 0.0, 0.0, shape

    found = best_shape(along, [{"gap_m": 0.1}, {"gap_m": 0.2}, {"gap_m": 0.9}])
    assert abs(math.log(found[1]["gap_m"] / 0.37)) < 0.13


def test_two_static_forces_are_two_where_no_shape_over_the_first_ones_variable_is_enough() -> None:
    law = row("nonlinear_stiffness", "static_force", 20_000.0, 9000.0, 1.34, variables=("x",))
    shape = row("unlisted", "static_force", 22_300.0, 5100.0, 1.02, generic=True, variables=("",))
    pair = row("nonlinear_stiffness quadratic_damping", "static_force static_force", 22_400.0, 5000.0, 1.0,
               variables=("x", "v"))  # fmt: skip
    over_x = row("nonlinear_stiffness unlisted", "static_force static_force", 20_100.0, 8800.0, 1.33, generic=True,
                 variables=("x", "x"))  # fmt: skip
    assert decide([BASE, law, shape, pair, over_x]).chosen is pair
    enough = row("nonlinear_stiffness unlisted", "static_force static_force", 22_395.0, 5000.0, 1.0, generic=True,
                 variables=("x", "x"))  # fmt: skip
    assert decide([BASE, law, shape, pair, enough]).chosen is not pair


def test_where_much_is_left_a_pair_has_to_gain_in_sizes_of_that() -> None:
    law = row("nonlinear_stiffness", "static_force", 20_000.0, 99_000.0, 9.0)
    play = row("free_play", "static_force", 20_100.0, 98_800.0, 9.0)
    pair = row("nonlinear_stiffness sensor_bandwidth", "static_force sensor_chain", 20_150.0, 49_000.0, 6.0)
    assert decide([BASE, law, play, pair]).chosen is play
    certain = row("nonlinear_stiffness sensor_bandwidth", "static_force sensor_chain", 20_800.0, 47_400.0, 6.0)
    assert decide([BASE, law, play, certain]).chosen is certain


def test_coloured_noise_is_nothing_that_a_second_effect_has_to_take() -> None:
    law = row("free_play", "static_force", 20_000.0, 9000.0, 1.9)
    pair = row("free_play viscoelastic_relaxation", "static_force memory", 21_000.0, 7000.0, 1.55)
    assert decide([BASE, law, pair]).chosen is law
    noise = replace(pair, left=Left(0.5, 2.0, "a.csv"))
    assert decide([BASE, law, noise]).chosen is noise


def test_a_law_of_another_kind_does_not_stand_for_a_kind_that_is_certainly_better() -> None:
    law = row("nonlinear_stiffness", "static_force", 20_000.0, 9000.0, 1.34)
    shape = row("unlisted", "static_force", 19_900.0, 9100.0, 1.35, generic=True)
    both = row("nonlinear_stiffness unlisted", "static_force static_force", 20_100.0, 8700.0, 1.32, generic=True)
    over_time = row("unlisted", "changing", 22_000.0, 5000.0, 1.0, generic=True)
    found = decide([BASE, law, shape, both, over_time])
    assert found.chosen is over_time
    assert not found.listed


def test_where_the_first_ones_variable_leaves_noise_alone_a_second_law_of_it_is_its_formula() -> None:
    first = row("dry_friction", "static_force", 22_440.0, 5120.0, 1.01, variables=("v",))
    pair = row("dry_friction unlisted", "static_force static_force", 22_490.0, 5000.0, 0.98, variables=("v", "v"))
    shape = row("dry_friction unlisted", "static_force static_force", 22_475.0, 4980.0, 0.978, True, ("v", "v"))
    found = decide([BASE, first, pair, shape])
    assert found.chosen is first


def test_two_listed_laws_of_one_variable_are_both_there_though_any_shape_of_it_holds_both() -> None:
    law = row("nonlinear_stiffness", "static_force", 20_000.0, 9500.0, 1.4, variables=("x",))
    play = row("free_play", "static_force", 18_000.0, 14_000.0, 1.7, variables=("x",))
    pair = row(
        "free_play nonlinear_stiffness", "static_force static_force", 22_400.0, 5000.0, 1.0, variables=("x", "x")
    )
    shape = row("nonlinear_stiffness unlisted", "static_force static_force", 22_360.0, 4985.0, 0.999, True, ("x", "x"))
    assert decide([BASE, law, play, pair, shape]).chosen is pair
    formula = replace(shape, log_evidence=22_405.0)
    assert decide([BASE, law, play, pair, formula]).chosen is not pair
    hardly = replace(law, chi2=5060.0, over=1.0, log_evidence=22_380.0)
    assert decide([BASE, hardly, play, pair, shape]).chosen is hardly


def test_friction_is_a_function_of_speed_where_drag_is_beside_it() -> None:
    """Friction and any shape over speed hold drag as well: no more is asked than that the two are not worse."""
    friction = row("dry_friction", "memory", 18_000.0, 14_000.0, 1.7, variables=("",))
    drag = row("quadratic_damping", "static_force", 9000.0, 32_000.0, 2.5, variables=("v",))
    over_speed = row("unlisted", "static_force", 21_000.0, 8000.0, 1.3, True, ("v",))
    pair = row("dry_friction quadratic_damping", "memory static_force", 22_400.0, 5000.0, 1.0, variables=("", "v"))
    both = row("dry_friction unlisted", "memory static_force", 22_390.0, 4990.0, 0.999, True, ("", "v"))
    pair, both = replace(pair, heldout=2.0), replace(both, heldout=1.9)
    found = decide([BASE, friction, drag, over_speed, pair, both])
    assert found.chosen is pair
    assert decide([BASE, friction, drag, over_speed, pair, replace(both, log_evidence=22_410.0)]).chosen is not pair
    other = replace(both, kinds=("memory", "memory"), variables=("", ""), chi2=5010.0)
    assert decide([BASE, friction, drag, over_speed, pair, other]).chosen is not pair


def test_the_other_effect_beside_any_shape_of_friction_is_not_friction_alone() -> None:
    kinds = "memory memory"
    branch = row("viscoelastic_relaxation", "memory", 4100.0, 26_762.0, 3.1)
    friction = row("dry_friction", "memory", 8400.0, 18_156.0, 2.37)
    pair = row("dry_friction viscoelastic_relaxation", kinds, 13_649.0, 7648.0, 1.146)
    other = row("unlisted viscoelastic_relaxation", "static_force memory", 13_571.0, 7759.0, 1.168, True, ("v", ""))
    pair = replace(pair, variables=("", ""))
    assert decide([BASE, branch, friction, pair, other]).chosen is pair


def test_friction_is_needed_where_a_smooth_shape_alone_is_worse() -> None:
    """A shape with a step where the motion turns has friction in it, and says nothing against it."""
    friction = row("dry_friction", "static_force", 21_000.0, 8000.0, 1.3, variables=("v",))
    steep = row("unlisted", "static_force", 22_400.0, 5000.0, 1.0, True, ("",))
    over_speed = row("dry_friction unlisted", "static_force static_force", 22_000.0, 5500.0, 1.05, True, ("v", "v"))
    beside = row("dry_friction unlisted", "static_force static_force", 22_350.0, 5050.0, 1.0, True, ("v", ""))
    smooth = row("unlisted", "static_force", 20_000.0, 9800.0, 1.4, True, ("",))
    beside, smooth = replace(beside, smooth=True), replace(smooth, smooth=True)
    found = decide([BASE, friction, steep, over_speed, beside, smooth])
    assert found.chosen is friction
    assert found.listed
    enough = replace(smooth, log_evidence=22_345.0)
    assert decide([BASE, friction, steep, over_speed, beside, enough]).chosen is steep


def test_where_no_spring_holds_the_mass_innovations_are_compared() -> None:
    """A run from its start adds up what no model knows."""
    first = row("dry_friction", "static_force", 20_000.0, 9500.0, 1.4, variables=("v",))
    pair = row("dry_friction sensor_delay", "static_force sensor_chain", 22_400.0, 5000.0, 1.0, variables=("v", ""))
    first, pair = replace(first, heldout=3.0, innovations=1.0), replace(pair, heldout=2.0, innovations=1.2)
    assert decide([BASE, first, pair]).chosen is first
    assert decide([BASE, first, replace(pair, heldout=4.0, innovations=0.9)]).chosen is not first


def test_friction_that_never_slides_is_a_loop_by_another_name() -> None:
    law = replace(row("dry_friction", "memory", 22_500.0, 5000.0), equal=("hysteresis",))
    found = decide([BASE, law])
    assert found.chosen is law
    assert found.ties == ("hysteresis",)
    assert found.confidence < 0.51


def test_a_pair_stands_no_better_than_a_fallen_one_that_explains_more() -> None:
    law = row("viscoelastic_relaxation", "memory", 7418.0, 3920.0, 1.236)
    fallen = row("viscoelastic_relaxation unlisted", "memory static_force", 7508.0, 3724.0, 1.183, variables=("", "x"))
    shape = row("viscoelastic_relaxation unlisted", "memory memory", 7483.0, 3741.0, 1.188, generic=True)
    weaker = row("viscoelastic_relaxation hysteresis", "memory memory", 7490.0, 3759.0, 1.192)
    weaker = replace(weaker, left=Left(2.0, 1.0))
    base = row("", "", 0.0, 18_772.0, 3.286)
    assert decide([base, law, weaker]).chosen is weaker
    other_way = replace(weaker, ids=weaker.ids[::-1], kinds=weaker.kinds[::-1], log_evidence=7489.0)
    assert decide([base, law, weaker, other_way]).confidence > 0.99
    assert decide([base, law, fallen, shape, weaker]).chosen is law


def test_a_second_effect_that_makes_what_was_kept_back_worse_is_not_named() -> None:
    law = replace(row("dry_friction", "static_force", 20_000.0, 9000.0, 1.34), heldout=1.80)
    pair = row("dry_friction sensor_bandwidth", "static_force sensor_chain", 22_400.0, 5000.0, 1.0)
    assert decide([BASE, law, replace(pair, heldout=1.85)]).chosen is law
    assert decide([BASE, law, replace(pair, heldout=1.75)]).chosen.ids == pair.ids


def test_friction_that_remembers_is_a_function_of_speed_beside_a_spring() -> None:
    """Any shape over deflection and speed holds both laws, whatever the friction's formula."""
    base = row("", "", 0.0, 5e6, 100.0)
    sine = row("nonlinear_stiffness", "static_force", 2_400_000.0, 200_000.0, 20.0, variables=("x",))
    over_x = row("unlisted", "static_force", 2_410_000.0, 180_000.0, 19.0, generic=True, variables=("x",))
    over_v = row("unlisted", "static_force", 50_000.0, 4.9e6, 99.0, generic=True, variables=("v",))
    shape = row("unlisted", "static_force", 2_496_000.0, 8_000.0, 4.0, generic=True, variables=("",))
    pair = row("nonlinear_stiffness dry_friction", "static_force memory", 2_495_000.0, 10_000.0, 4.5,
               variables=("x", ""))  # fmt: skip
    found = decide([base, sine, over_x, over_v, shape, pair])
    assert found.chosen is pair
    assert found.listed
