"""What every effect promises, of the catalogue or of a file of one's own: asked one by one, each with its figure."""

from __future__ import annotations

import copy
import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments import EXPERIMENTS, Drive, Experiment, Scenario
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.own_effect import FREE_SITES
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.bench import compress_wheel, drag_wheel
from ssmr_ident.simulate.rig import simulate_rig

Values = Mapping[str, float]

QUANTUM = 5.0 / 2**12 * (3.4 * 9.8 / 5.0)
"""m/s^2 per code of a 12-bit converter: what a log can show."""

FORCE_FLOOR = 0.1
"""N; the hundredth part of a tooth of the thesis' pulls."""

WANDERS = 1.02
"""How far kinetic energy may grow from one quarter of a decay to the next: the share between modes wanders."""

_NAME = r"(?:1|N|m|s|kg|rad|Hz|V|A|K|W|J|Pa)(?:\^\d+(?:\.\d+)?)?"
UNIT = re.compile(rf"{_NAME}(?: {_NAME})*(?:/(?:{_NAME}|\({_NAME}(?: {_NAME})*\)))?")
"""SI, as in N s^2/m^2."""

_SUFFIXES = {"N/m": "N_m", "m/s^2": "m_s2"}
_RIG = Rig(8.0, 30.0, 18000.0)
_HEAD = np.concatenate([np.linspace(0.0, 0.012, 240), np.full(40, 0.012)])


@dataclass(frozen=True)
class Outcome(Shown):
    """What one check found: its name, whether the effect keeps the promise, and the figure that says so."""

    check: str
    passed: bool
    figure: str

    def __str__(self) -> str:
        return f"{'ok   ' if self.passed else 'FAILS'}  {self.check}: {self.figure}"


def robot_for_checks() -> Robot:
    """Without slip coupling, so that this too is something to be switched on."""
    return robot_from_parameters(read_parameters("p3at-extended")).with_changes(slip_coupling=0.0)


def declared(effect: Effect, values: Values | None = None) -> Outcome:
    """The declaration is complete; ``values`` in place of nominal ones switch the effect on."""
    lacks = [
        f"{name} says too little"
        for name in ("sentence", "equation", "source", "signature")
        if len(getattr(effect, name)) <= 10
    ]
    if not effect.sentence.endswith("."):
        lacks.append("sentence ends without a full stop")
    if not effect.acts:
        lacks.append("acts is empty")
    if not effect.amplitudes:
        lacks.append("no parameter has an off value")
    if not effect.experiments:
        lacks.append("experiments is empty")
    lacks += [f"{name!r} is no experiment" for name in sorted(set(effect.experiments).difference(EXPERIMENTS))]
    if effect.rig != any(kind.drive is Drive.FORCE and kind.shows(effect) for kind in EXPERIMENTS.values()):
        lacks.append("rig and the experiment forced go together")
    for p in effect.parameters:
        if not UNIT.fullmatch(p.unit):
            lacks.append(f"{p.name}: {p.unit!r} is no SI unit as in N s^2/m^2")
        if not p.lower <= p.nominal <= p.upper:
            lacks.append(f"{p.name}: nominal is beyond its bounds")
        if p.off is not None and not p.lower <= p.off <= p.upper:
            lacks.append(f"{p.name}: off is beyond its bounds")
        if not p.name.endswith(_SUFFIXES.get(p.unit, "")):
            lacks.append(f"{p.name} ends in {_SUFFIXES[p.unit]}, its unit")
    if effect.amplitudes:
        if effect.is_off(effect.values(values)):
            lacks.append("its nominal values switch it off")
        if not effect.is_off({**effect.values(), **{p.name: float(p.off or 0.0) for p in effect.amplitudes}}):
            lacks.append("its off values do not switch it off")
    searched = "a diagnosis looks for it" if effect.probes else "no probes: a diagnosis does not look for it"
    return Outcome(
        "declaration", not lacks, "; ".join(lacks) or f"complete, {len(effect.parameters)} parameters, {searched}"
    )


def named_in_the_law(effect: Effect) -> Outcome:
    """Laws that are plain functions take the parameters by name, in the order in which they are declared."""
    names = [parameter.name for parameter in effect.parameters]
    for site in FREE_SITES:
        law = effect.acts.get(site)
        if law is not None:
            taken = list(inspect.signature(law).parameters)[-len(names) :]
            if taken != names:
                wrong = f"{site.name} takes {', '.join(taken)}; expected {', '.join(names)} last"
                return Outcome("parameters reach the law", False, wrong)
    return Outcome("parameters reach the law", True, ", ".join(names))


def scenarios(robot: Robot, long: bool) -> dict[str, tuple[Scenario, ...]]:
    """Scenarios by experiment, for nesting (short) or for traces (long enough to let go)."""
    checked = {name: kind.effect_checks for name, kind in EXPERIMENTS.items() if kind.effect_checks}
    return {name: made(robot, 8.0 if long else 3.0) for name, made in checked.items()}


def bench_of(kind: Experiment) -> Callable[..., np.ndarray]:
    """What simulates one wheel on a bench."""
    return compress_wheel if kind.vertical else drag_wheel


def rig_motion(effects: Mapping[str, Values]) -> np.ndarray:
    """(400, 3) float: position [m], velocity [m/s], acceleration [m/s^2] of a rig that is let go and driven."""
    time = np.arange(400) / 1000.0
    return simulate_rig(_RIG, 150.0 * np.sin(2 * np.pi * 7.0 * time), 1000.0, position=2e-3, effects=effects)


def nested(effect: Effect, robot: Robot) -> Outcome:
    """Off changes nothing to the last bit, in every experiment, its own or not, its other parameters anywhere."""
    off = {p.name: p.upper if np.isfinite(p.upper) else p.nominal for p in effect.parameters}
    off |= {p.name: float(p.off) for p in effect.amplitudes if p.off is not None}
    pairs = []
    for some in scenarios(robot, long=False).values():
        for scenario in some:
            plain, other = (simulate(robot, scenario, 200.0, effects=e).values for e in ({}, {effect.id: off}))
            pairs.append((other, plain))
    for bench in (drag_wheel, compress_wheel):
        pairs.append((bench(robot, _HEAD, 0.05, effects={effect.id: off}), bench(robot, _HEAD, 0.05)))
    if effect.rig:
        pairs.append((rig_motion({effect.id: off}), rig_motion({})))
    differ = sum(not np.array_equal(one, other) for one, other in pairs)
    largest = max(float(np.max(np.abs(one - other))) for one, other in pairs)
    return Outcome(
        "off changes nothing", not differ, f"largest difference {largest:g}, in {differ} of {len(pairs)} runs"
    )


def traces(effect: Effect, robot: Robot, values: Values | None = None) -> dict[str, float]:
    """Rms change by experiment, in steps of a converter or in tenths of a newton; ``values`` in place of nominal."""
    on = {effect.id: effect.values(values)}
    found: dict[str, float] = {}
    for name, some in scenarios(robot, long=True).items():
        kind = EXPERIMENTS[name]
        for scenario in some if kind.shows(effect) else ():
            plain, changed = simulate(robot, scenario), simulate(robot, scenario, effects=on)
            channels = ["force"] if kind.on_a_testing_machine else ["ax", "ay", "az"]
            floor = FORCE_FLOOR if kind.on_a_testing_machine else QUANTUM
            size = max(_rms(changed[channel] - plain[channel]) for channel in channels) / floor
            found[name] = max(size, found.get(name, 0.0))
    for kind in EXPERIMENTS.values():
        if kind.of_one_wheel and kind.shows(effect):
            bench = bench_of(kind)
            difference = bench(robot, _HEAD, 0.05, effects=on) - bench(robot, _HEAD, 0.05)
            found[kind.name] = _rms(difference) / FORCE_FLOOR
    if effect.rig:
        found["forced"] = _rms((rig_motion(on) - rig_motion({}))[:, 2]) / QUANTUM
    return found


def shows(effect: Effect, found: Values) -> Outcome:
    """Nominal leaves a trace that an instrument shows, in one of its experiments at least."""
    missing = set(effect.experiments) - set(found)
    figure = ", ".join(f"{name} {size:.3g}" for name, size in found.items())
    figure += " times what an instrument resolves" + (f"; not simulated: {', '.join(missing)}" if missing else "")
    return Outcome("nominal shows", not missing and max(found.values(), default=0.0) > 1.0, figure)


def moves(effect: Effect, robot: Robot, values: Values | None = None) -> Outcome:
    """What a sensor makes of a motion leaves it as it is, to the last bit; all else changes it in an experiment."""
    on, names = {effect.id: effect.values(values)}, ["x", "y", "z", "roll", "pitch", "yaw"]
    changed, asked = 0, 0
    for kind, some in scenarios(robot, long=False).items():
        if EXPERIMENTS[kind].shows(effect) or not effect.moves:
            for scenario in some:
                plain, other = (simulate(robot, scenario, 200.0, effects=e) for e in ({}, on))
                asked += 1
                changed += any(not np.array_equal(plain[name], other[name]) for name in names)
    if not effect.robot:
        asked += 1
        changed += not np.array_equal(rig_motion(on), rig_motion({}))
    expected = "expected some" if effect.moves else "expected none, as it acts on a sensor alone"
    return Outcome("motion", bool(changed) == effect.moves, f"other in {changed} of {asked} runs, {expected}")


def inputs_left(effect: Effect, robot: Robot) -> Outcome:
    """Robot, scenario and values are as they were before."""
    given = robot, swivel(wheel_rates(robot, 0.0, 1.0), 0.1), {effect.id: effect.values()}
    before = copy.deepcopy(given)
    if effect.robot:
        simulate(given[0], given[1], effects=given[2])
    else:
        rig_motion(given[2])
    touched = [type(now).__name__ for kept, now in zip(before, given, strict=True) if _plain(kept) != _plain(now)]
    return Outcome("inputs", not touched, f"changed: {', '.join(touched)}" if touched else "left as they were")


def passive(effect: Effect, robot: Robot) -> Outcome:
    """Without damping no motion builds up: the mean kinetic energy of a free response never rises."""
    bare = robot.with_changes(damping=np.zeros(3), mu_static=1e9, mu_kinetic=1e9)
    scenario = Scenario("free_response", 8.0, offset={"roll": 1e-3, "pitch": 5e-4, "yaw": 1e-3, "z": 2e-4})
    result = simulate(bare, scenario, 500.0, effects={effect.id: {}})
    velocity = np.column_stack([np.gradient(result[name], 1 / 500.0) for name in "xyz"])
    turning = np.column_stack([result[name] for name in ("wx", "wy", "wz")])
    kinetic = 0.5 * bare.mass * (velocity**2).sum(axis=1)
    kinetic += 0.5 * np.einsum("ni,ij,nj->n", turning, bare.inertia, turning)
    means = [float(part.mean()) for part in np.split(kinetic, 4)]
    passed = 1e-9 < max(means[1:]) <= WANDERS * means[0]
    figure = f"at most {max(means[1:]) / means[0]:.3g} of the kinetic energy is there later, without damping"
    return Outcome("no energy from nothing", passed, figure)


def _rms(difference: np.ndarray) -> float:
    return float(np.sqrt(np.mean(difference**2)))


def _plain(value: object) -> object:
    """Nested plain values, so that arrays can be compared."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return {key: _plain(item) for key, item in vars(value).items()} if hasattr(value, "__dict__") else value
