"""What every effect of the catalogue promises: a full declaration, exact nesting, a visible trace, no free energy."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.identify.robot.unknowns import predicted_modes
from ssmr_ident.physics import slots
from ssmr_ident.physics.effect import Effect, Site
from ssmr_ident.physics.effects import CATALOGUE, unlisted
from ssmr_ident.physics.element import STATES, element_advance, element_force, inner_slots
from ssmr_ident.physics.own_effect import FREE_SITES
from ssmr_ident.physics.robot import Robot
from ssmr_ident.workflows.effects import promises

IDS = (
    "translation_coupling", "nonlinear_stiffness", "dry_friction", "hysteresis", "quadratic_damping",
    "viscoelastic_relaxation", "flexible_mast", "free_play", "com_offset", "wheel_lift", "motor_belt",
    "cable_compliance", "stribeck", "load_sensitive_friction", "load_dependent_friction", "slip_coupling",
    "rolling_resistance", "ground_roughness", "ground_joints", "wheel_eccentricity", "coriolis", "sensor_saturation",
    "sensor_bandwidth", "sensor_delay", "sensor_misalignment", "load_cell_drift", "unlisted",
)  # fmt: skip
NO_SLOT = {
    "ground_roughness.length_m": "shapes the random floor before the run",
    "ground_roughness.seed": "shapes the random floor before the run",
    "translation_coupling.active": "the simulator is always coupled; its off is the linear model of pure rotations",
}
SHOWN = {"unlisted": {"c_abs_v_N_s_m": 5.0}}
"""Values in place of nominal ones. The smooth force is off at nominal: a search holds the terms that it does not fit
at their nominal values, and there these have to do nothing."""
EACH = pytest.mark.parametrize("effect", CATALOGUE.values(), ids=CATALOGUE.keys())


@pytest.fixture(scope="module")
def robot() -> Robot:
    return promises.robot_for_checks()


def _kept(outcome: promises.Outcome) -> None:
    assert outcome.passed, outcome.figure


def test_the_catalogue_holds_the_fixed_ids_and_no_other() -> None:
    assert sorted(CATALOGUE) == sorted(IDS)
    assert all(effect_id == effect.id for effect_id, effect in CATALOGUE.items())


def test_the_fixed_ids_are_those_of_the_specification(shared: Path) -> None:
    table = (shared / "spec" / "effects.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == sorted(IDS)


@EACH
def test_the_declaration_is_complete(effect: Effect) -> None:
    _kept(promises.declared(effect, SHOWN.get(effect.id)))
    assert effect.is_off(effect.values()) == (effect.id in SHOWN)


@pytest.mark.compiles
@EACH
def test_nominal_leaves_a_trace_that_an_instrument_shows(effect: Effect, robot: Robot) -> None:
    if effect.id == "translation_coupling":
        coupled, pure = (predicted_modes(robot, decoupled)["roll"][0] for decoupled in (False, True))
        assert coupled < 0.8 * pure
        return
    _kept(promises.shows(effect, promises.traces(effect, robot, SHOWN.get(effect.id))))


def test_slots_and_their_indices_agree() -> None:
    assert len(set(slots.SLOTS)) == len(slots.SLOTS)
    for slot in slots.SLOTS:
        effect_id, name = slot.split(".")
        assert name in CATALOGUE[effect_id].values()
    vector = slots.effect_vector(slots.checked({"motor_belt": {"K_b_N_m": 1234.0}, "free_play": {"gap_m": 0.003}}))
    assert vector[slots.BELT_STIFFNESS] == 1234.0
    assert vector[slots.GAP] == 0.003
    assert vector[slots.RIM_MASS] == CATALOGUE["motor_belt"].values()["rim_mass_kg"]
    assert slots.UNLISTED == slots.LOAD_ROUNDING + 1 == len(slots.SLOTS) - len(unlisted.EFFECT.parameters)
    assert slots.SLOTS.index("wheel_eccentricity.eccentricity_m") == slots.ECCENTRICITY == len(inner_slots(vector)) - 1


@pytest.mark.compiles
@EACH
def test_off_changes_nothing_to_the_last_bit(effect: Effect, robot: Robot) -> None:
    _kept(promises.nested(effect, robot))


@pytest.mark.compiles
@EACH
def test_every_parameter_reaches_the_code(effect: Effect) -> None:
    names = [parameter.name for parameter in effect.parameters]
    if effect.id == "unlisted":
        sizes = {"deflection": 5e-3, "speed": 0.2, "force": 20.0, "stiffness": 4e3, "time": 0.02, "duration": 1.0}
        probes = [*effect.probes, effect.rig_probes[5], effect.rig_probes[-12], effect.rig_probes[-1]]
        assert {name for probe in probes for name in probe} == set(names)
        motions = [promises.rig_motion({})]
        for probe in probes:
            values = {name: at if isinstance(at, float) else at.value(sizes) for name, at in probe.items()}
            motions.append(promises.rig_motion({effect.id: values}))
        for one, other in itertools.combinations(motions, 2):
            assert np.abs(one - other)[:, 2].max() > promises.QUANTUM, "two terms do the same"
        return
    if not effect.acts.keys().isdisjoint(FREE_SITES):
        _kept(promises.named_in_the_law(effect))
        return
    held = {slot.split(".")[1] for slot in slots.SLOTS if slot.startswith(f"{effect.id}.")}
    without = {key.split(".")[1] for key in NO_SLOT if key.startswith(f"{effect.id}.")}
    assert held | without == set(names)
    assert not held & without


@EACH
def test_only_what_a_sensor_makes_of_a_motion_leaves_it_as_it_is(effect: Effect, robot: Robot) -> None:
    if effect.id != "translation_coupling":
        _kept(promises.moves(effect, robot, SHOWN.get(effect.id)))


@EACH
def test_inputs_are_left_as_they_were(effect: Effect, robot: Robot) -> None:
    _kept(promises.inputs_left(effect, robot))


def _passive_cases() -> list[tuple[str, dict[str, float]]]:
    """Element effects at nominal, and at three draws within their bounds; softening springs are not passive."""
    random = np.random.default_rng(7)
    cases = []
    for effect in CATALOGUE.values():
        if Site.ELEMENT in effect.acts:
            cases.append((effect.id, effect.values()))
            for _ in range(3):
                draw = {}
                for p in effect.parameters:
                    low = max(p.lower, 0.0, 1e-3 * p.nominal)
                    share = random.uniform()
                    draw[p.name] = float(low ** (1 - share) * min(p.upper, 30 * p.nominal) ** share)
                cases.append((effect.id, draw))
    return cases


@pytest.mark.parametrize(("effect_id", "values"), _passive_cases())
def test_an_element_gives_back_no_more_than_it_took(effect_id: str, values: dict[str, float]) -> None:
    """From rest and along any path the work done on spring and effect together is never negative."""
    random = np.random.default_rng(3)
    time = np.arange(1500) * 1e-3
    phases, sizes = random.uniform(0, 2 * np.pi, 6), random.uniform(0.1e-3, 0.6e-3, 6)
    frequencies = np.array([0.7, 1.9, 3.1, 5.3, 8.9, 14.3])
    path = (sizes * np.sin(2 * np.pi * np.outer(time, frequencies) + phases)).sum(axis=1)
    path *= np.minimum(time / 0.2, 1.0)
    e, z, stiffness = slots.effect_vector({effect_id: values}), np.zeros(STATES), 18000.0
    work, before, lowest, dissipated = 0.0, 0.0, 0.0, 0.0
    for old, new in itertools.pairwise(path):
        speed = (new - old) / 1e-3
        element_advance(z, speed, 1e-3, True, e)
        force = stiffness * new + element_force(new, speed, z, stiffness, 1.0, 1.0, True, e)
        work += 0.5 * (force + before) * (new - old)
        before, lowest, dissipated = force, min(lowest, work), max(dissipated, work)
    assert lowest > -2e-3 * dissipated


@pytest.mark.parametrize(
    "effect_id",
    [i for i, e in CATALOGUE.items() if "free_response" in e.experiments and Site.OUTPUT not in e.acts],
)
def test_a_robot_without_damping_does_not_build_up_motion(effect_id: str, robot: Robot) -> None:
    _kept(promises.passive(CATALOGUE[effect_id], robot))


def test_off_is_nothing_or_infinity_or_one() -> None:
    """As the catalogue's file has it: no effect hides in a finite default. 1 is a ratio that is off at unity."""
    assert {p.off for effect in CATALOGUE.values() for p in effect.amplitudes} == {0.0, 1.0, np.inf}
    assert {e.id for e in CATALOGUE.values() if 1.0 in {p.off for p in e.amplitudes}} == {"hysteresis", "stribeck"}


def test_what_switches_an_effect_on_is_what_is_given() -> None:
    """A knee alone is no cubic besides; an effect of which nothing is given is its nominal one."""
    knee = slots.checked({"nonlinear_stiffness": {"knee_share": 0.3}})["nonlinear_stiffness"]
    assert (knee["k3_N_m3"], knee["k3_share_1_m2"], knee["knee_share"]) == (0.0, 0.0, 0.3)
    assert knee["knee_m"] > 0.0
    assert slots.checked({"nonlinear_stiffness": {}})["nonlinear_stiffness"]["k3_N_m3"] > 0.0
    placed = slots.checked({"nonlinear_stiffness": {"knee_m": 1e-3}})["nonlinear_stiffness"]
    assert placed["k3_N_m3"] > 0.0
