"""What every effect of the catalogue promises: a full declaration, exact nesting, a visible trace, no free energy."""

from __future__ import annotations

import copy
import inspect
import itertools
import re
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.experiments import EXPERIMENTS, Scenario
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.experiments.pull import pull
from ssmr_ident.experiments.straight import straight
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.identify.robot.unknowns import predicted_modes
from ssmr_ident.physics import slots
from ssmr_ident.physics.effect import Effect, Site
from ssmr_ident.physics.effects import CATALOGUE, unlisted
from ssmr_ident.physics.element import STATES, element_advance, element_force, inner_slots
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.bench import compress_wheel, drag_wheel
from ssmr_ident.simulate.rig import simulate_rig

NOT_MODELLED = ("load_dependent_friction",)
"""Of the specification: friction that grows with the torque of a gear, which needs the drive's torque at the joint."""
IDS = (
    "translation_coupling", "nonlinear_stiffness", "dry_friction", "hysteresis", "quadratic_damping",
    "viscoelastic_relaxation", "flexible_mast", "free_play", "com_offset", "wheel_lift", "motor_belt",
    "cable_compliance", "stribeck", "load_sensitive_friction", "slip_coupling", "rolling_resistance",
    "ground_roughness", "ground_joints", "wheel_eccentricity", "coriolis", "sensor_saturation",
    "sensor_bandwidth", "sensor_delay", "sensor_misalignment", "load_cell_drift", "unlisted",
)  # fmt: skip
UNITS = {
    "1", "1/m^2", "N", "N/m", "N/m^2", "N/m^3", "N s/m", "N s/m^2", "N s/m^3", "N s^2/m^2", "N s^3/m^3", "N/s", "1/s",
    "m", "N s^0.5/m^0.5", "m/s", "m/s^2", "s", "kg", "Hz", "rad", "rad/s", "N/(m s)",
}  # fmt: skip
NO_SLOT = {
    "ground_roughness.length_m": "shapes the random floor before the run",
    "ground_roughness.seed": "shapes the random floor before the run",
    "translation_coupling.active": "the simulator is always coupled; its off is the linear model of pure rotations",
}
SHOWN = {"unlisted": {"c_abs_v_N_s_m": 5.0}}
"""Values in place of nominal ones. The smooth force is off at nominal: a search holds the terms that it does not fit
at their nominal values, and there these have to do nothing."""
QUANTUM = 5.0 / 2**12 * (3.4 * 9.8 / 5.0)  # m/s^2 per code of a 12-bit converter: what a log can show
FORCE_FLOOR = 0.1  # N; the hundredth part of a tooth of the thesis' pulls

EACH = pytest.mark.parametrize("effect", CATALOGUE.values(), ids=CATALOGUE.keys())


@pytest.fixture(scope="module")
def robot() -> Robot:
    """Without slip coupling, so that this too is something to be switched on."""
    return robot_from_parameters(read_parameters("p3at-extended")).with_changes(slip_coupling=0.0)


def test_the_catalogue_holds_the_fixed_ids_and_no_other() -> None:
    assert sorted(CATALOGUE) == sorted(IDS)
    assert all(effect_id == effect.id for effect_id, effect in CATALOGUE.items())


def test_the_fixed_ids_are_those_of_the_specification(shared: Path) -> None:
    table = (shared / "spec" / "effects.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == sorted((*IDS, *NOT_MODELLED))


@EACH
def test_the_declaration_is_complete(effect: Effect) -> None:
    for text in (effect.sentence, effect.equation, effect.source, effect.signature):
        assert len(text) > 10
    assert effect.sentence.endswith(".")
    assert effect.parameters
    assert effect.amplitudes, "nothing switches it off"
    assert set(effect.experiments) <= set(EXPERIMENTS)
    assert effect.experiments
    assert effect.acts
    assert effect.rig == ("forced" in effect.experiments)
    for parameter in effect.parameters:
        assert parameter.unit in UNITS
        assert parameter.lower <= parameter.nominal <= parameter.upper
        assert parameter.off is None or parameter.lower <= parameter.off <= parameter.upper
        suffix = {"N/m": "N_m", "1": "", "m/s^2": "m_s2"}.get(parameter.unit)
        assert suffix is None or parameter.name.endswith(suffix), "the key names the unit"
    nominal = effect.values()
    assert effect.is_off(nominal) == (effect.id in SHOWN)
    assert not effect.is_off(effect.values(SHOWN.get(effect.id)))
    assert effect.is_off({**nominal, **{p.name: p.off for p in effect.amplitudes}})


@pytest.mark.compiles
@EACH
def test_every_parameter_reaches_the_code(effect: Effect) -> None:
    names = [parameter.name for parameter in effect.parameters]
    if effect.id == "unlisted":
        sizes = {"deflection": 5e-3, "speed": 0.2, "force": 20.0, "stiffness": 4e3, "time": 0.02, "duration": 1.0}
        probes = [*effect.probes, effect.rig_probes[5], effect.rig_probes[-12], effect.rig_probes[-1]]
        assert {name for probe in probes for name in probe} == set(names)
        motions = [_rig_motion({})]
        for probe in probes:
            values = {name: at if isinstance(at, float) else at.value(sizes) for name, at in probe.items()}
            motions.append(_rig_motion({effect.id: values}))
        for one, other in itertools.combinations(motions, 2):
            assert np.abs(one - other)[:, 2].max() > QUANTUM, "two terms do the same"
        return
    for site in (Site.ROBOT, Site.SENSOR, Site.PULL, Site.OUTPUT):
        if site in effect.acts:
            change = effect.acts[site]
            assert change is not None
            assert list(inspect.signature(change).parameters)[-len(names) :] == names
            return
    held = {slot.split(".")[1] for slot in slots.SLOTS if slot.startswith(f"{effect.id}.")}
    without = {key.split(".")[1] for key in NO_SLOT if key.startswith(f"{effect.id}.")}
    assert held | without == set(names)
    assert not held & without


def test_slots_and_their_indices_agree() -> None:
    assert len(set(slots.SLOTS)) == len(slots.SLOTS)
    for slot in slots.SLOTS:
        effect_id, name = slot.split(".")
        assert name in CATALOGUE[effect_id].values()
    vector = slots.effect_vector(slots.checked({"motor_belt": {"K_b_N_m": 1234.0}, "free_play": {"gap_m": 0.003}}))
    assert vector[slots.BELT_STIFFNESS] == 1234.0
    assert vector[slots.GAP] == 0.003
    assert vector[slots.RIM_MASS] == CATALOGUE["motor_belt"].values()["rim_mass_kg"]
    assert slots.UNLISTED == slots.RIM_MASS + 1 == len(slots.SLOTS) - len(unlisted.EFFECT.parameters)
    assert slots.SLOTS.index("wheel_eccentricity.eccentricity_m") == slots.ECCENTRICITY == len(inner_slots(vector)) - 1


def _experiments(robot: Robot, long: bool) -> dict[str, list[Scenario]]:
    """Scenarios by experiment, for nesting (short) or for traces (long enough to let go)."""
    spinning = np.full((1, 2), 0.003 / robot.radius)
    seconds = 8.0 if long else 3.0
    return {
        "free_response": [
            Scenario("free_response", 0.5, offset={"roll": 2e-3, "pitch": 1e-3, "yaw": 2e-3}),
            free_response("roll", 4e-3, 0.5),
        ],
        "pull": [
            pull("lateral", 1.0, seconds, height=0.2),
            pull("longitudinal", 2.0, seconds),
            pull("lateral", 1.0, seconds, wheel_rates=spinning, held=True),
        ],
        "swivel": [swivel(wheel_rates(robot, 0.0, 1.0), 1.0)],
        "straight": [straight(wheel_rates(robot, 0.4, 0.0), 1.0)],
    }


RIG = Rig(8.0, 30.0, 18000.0)
HEAD = np.concatenate([np.linspace(0.0, 0.012, 240), np.full(40, 0.012)])


def _rig_motion(effects: dict[str, dict[str, float]]) -> np.ndarray:
    time = np.arange(400) / 1000.0
    force = 150.0 * np.sin(2 * np.pi * 7.0 * time)
    return simulate_rig(RIG, force, 1000.0, position=2e-3, effects=effects)


@pytest.mark.compiles
@EACH
def test_off_changes_nothing_to_the_last_bit(effect: Effect, robot: Robot) -> None:
    """In every experiment, its own or not, and with its other parameters anywhere."""
    off = {p.name: p.upper if np.isfinite(p.upper) else p.nominal for p in effect.parameters}
    off |= {p.name: p.off for p in effect.amplitudes}
    for scenarios in _experiments(robot, long=False).values():
        for scenario in scenarios:
            plain = simulate(robot, scenario, 200.0).values
            assert np.array_equal(simulate(robot, scenario, 200.0, effects={effect.id: off}).values, plain)
    for bench in (drag_wheel, compress_wheel):
        assert np.array_equal(bench(robot, HEAD, 0.05, effects={effect.id: off}), bench(robot, HEAD, 0.05))
    if effect.rig:
        assert np.array_equal(_rig_motion({effect.id: off}), _rig_motion({}))


@pytest.mark.compiles
@EACH
def test_nominal_leaves_a_trace_that_an_instrument_shows(effect: Effect, robot: Robot) -> None:
    """In at least one of its experiments, by more than the converter's step, or by 0.1 N in a pull."""
    if effect.id == "translation_coupling":
        coupled, pure = (predicted_modes(robot, decoupled)["roll"][0] for decoupled in (False, True))
        assert coupled < 0.8 * pure
        return
    on = {effect.id: effect.values(SHOWN.get(effect.id))}
    traces = {}
    for experiment, scenarios in _experiments(robot, long=True).items():
        if experiment in effect.experiments:
            for scenario in scenarios:
                plain, changed = simulate(robot, scenario), simulate(robot, scenario, effects=on)
                names = ["force"] if experiment == "pull" else ["ax", "ay", "az"]
                floor = FORCE_FLOOR if experiment == "pull" else QUANTUM
                size = max(np.sqrt(np.mean((changed[name] - plain[name]) ** 2)) for name in names) / floor
                traces[experiment] = max(size, traces.get(experiment, 0.0))
    for experiment, bench in (("wheel_drag", drag_wheel), ("vertical_compression", compress_wheel)):
        if experiment in effect.experiments:
            difference = bench(robot, HEAD, 0.05, effects=on) - bench(robot, HEAD, 0.05)
            traces[experiment] = np.sqrt(np.mean(difference**2)) / FORCE_FLOOR
    if effect.rig:
        traces["forced"] = np.sqrt(np.mean((_rig_motion(on) - _rig_motion({}))[:, 2] ** 2)) / QUANTUM
    assert set(traces) == set(effect.experiments)
    assert max(traces.values()) > 1.0, traces


@EACH
def test_only_what_a_sensor_makes_of_a_motion_leaves_it_as_it_is(effect: Effect, robot: Robot) -> None:
    """To the last bit; all others change it in one of their experiments at least."""
    if effect.id == "translation_coupling":
        return
    on, names = {effect.id: effect.values(SHOWN.get(effect.id))}, ["x", "y", "z", "roll", "pitch", "yaw"]
    changed = []
    for experiment, scenarios in _experiments(robot, long=False).items():
        if experiment in effect.experiments or not effect.moves:
            for scenario in scenarios:
                plain, other = (simulate(robot, scenario, 200.0, effects=e) for e in ({}, on))
                changed += [not np.array_equal(plain[name], other[name]) for name in names]
    assert any(changed) == effect.moves


@EACH
def test_inputs_are_left_as_they_were(effect: Effect, robot: Robot) -> None:
    scenario = swivel(wheel_rates(robot, 0.0, 1.0), 0.1)
    on = {effect.id: effect.values()}
    before = copy.deepcopy((robot, scenario, on))
    simulate(robot, scenario, effects=on)
    for kept, now in zip(before, (robot, scenario, on), strict=True):
        assert _plain(kept) == _plain(now)


def _plain(value: object) -> object:
    """Nested plain values, so that arrays can be compared."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return {key: _plain(item) for key, item in vars(value).items()} if hasattr(value, "__dict__") else value


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
    """Every effect that a free response can show is passive: the mean kinetic energy never rises."""
    bare = robot.with_changes(damping=np.zeros(3), mu_static=1e9, mu_kinetic=1e9)
    scenario = Scenario("free_response", 8.0, offset={"roll": 1e-3, "pitch": 5e-4, "yaw": 1e-3, "z": 2e-4})
    result = simulate(bare, scenario, 500.0, effects={effect_id: {}})
    velocity = np.column_stack([np.gradient(result[name], 1 / 500.0) for name in "xyz"])
    turning = np.column_stack([result[name] for name in ("wx", "wy", "wz")])
    kinetic = 0.5 * bare.mass * (velocity**2).sum(axis=1)
    kinetic += 0.5 * np.einsum("ni,ij,nj->n", turning, bare.inertia, turning)
    means = [float(part.mean()) for part in np.split(kinetic, 4)]
    assert 1e-9 < max(means[1:]) <= 1.02 * means[0]  # 2 %: how far the share between modes wanders in 2 s


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
