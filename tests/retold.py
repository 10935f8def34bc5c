"""One experiment, logged in other ways: order, folder, units, volts, signs, zeros, starts, rates.

Rigs are integrated by scipy, which shares nothing with the simulator; the robot's decays are the simulator's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

Log = Mapping[str, np.ndarray]

MASS, DAMPING, STIFFNESS = 2.0, 9.0, 6000.0
RATE, SECONDS = 400.0, 4.0
RIG = """\
schema: ssmr-ident/parameters/1
name: r
mass_kg: {value: 2.0, std: 0.02, unit: kg}
stiffness_N_m: {value: 5600, std: 900, unit: N/m}
damping_N_s_m: {value: 7, std: 4, unit: N s/m}
"""
VOLTS_ZERO, VOLTS_PER_M_S2 = 2.6, 0.15006002400960383
"""Of the bundled robot's accelerometer."""


@dataclass(frozen=True)
class Column:
    """How a channel is written: unit, SI of one of it, and what stands for nothing."""

    unit: str
    size: float = 1.0
    zero: float = 0.0


@dataclass(frozen=True)
class Told:
    """Logs as they are written, and what session.yaml says of them all."""

    logs: tuple[Log, ...]
    columns: Mapping[str, Column]
    entry: str
    other_units: Mapping[str, Column]
    volts: Mapping[str, Column]
    in_volts: str
    offsets: Mapping[str, float]
    model: tuple[str, str] = ("rig.yaml", RIG)
    baseline: str = "sdof"
    names: tuple[str, ...] = ("one", "two", "three")
    folder: str = "session"
    order: tuple[int, ...] = field(default=(0, 1, 2))

    def write(self, below: Path) -> Path:
        """The session in a folder of its own."""
        folder = below / self.folder
        folder.mkdir()
        rows = []
        for index in self.order:
            log = self.logs[index]
            columns = [log["time"], *((log[key] / c.size) + c.zero for key, c in self.columns.items())]
            head = ",".join(["time [s]", *(f"{key} [{c.unit}]" for key, c in self.columns.items())])
            name = f"{self.names[index]}.csv"
            np.savetxt(folder / name, np.column_stack(columns), "%.9g", ",", header=head, comments="")
            rows.append(f"  - {{file: {name}, role: {'heldout' if index == 2 else 'target'}, {self.entry}}}\n")
        (folder / self.model[0]).write_text(self.model[1], encoding="utf-8")
        (folder / "session.yaml").write_text(
            f"schema: ssmr-ident/session/1\nname: s\nrobot: {self.model[0]}\nbaseline: {self.baseline}\nrecordings:\n"
            + "".join(rows),
            encoding="utf-8",
        )
        return folder

    def each(self, change: Callable[[Log], Log]) -> Told:
        """Every log changed."""
        return replace(self, logs=tuple(change(log) for log in self.logs))


def _volts(told: Told) -> Told:
    return replace(told, columns=told.volts, entry=told.entry + told.in_volts)


def _mirrored(told: Told) -> Told:
    """A rig's whole world turned; a robot's accelerometer mounted the other way round, and said to be."""
    if told.baseline == "sdof":
        return told.each(lambda log: {key: values if key == "time" else -values for key, values in log.items()})
    turned = {key: replace(c, size=-c.size) if key == "ay" else c for key, c in told.volts.items()}
    name, text = told.model
    return replace(_volts(told), columns=turned, model=(name, text.replace("y: 1, z: 1}", "y: -1, z: 1}")))


def _cut(told: Told) -> Told:
    """Driven runs without their first half second, decays without a fiftieth of one."""
    driven = "force" in told.logs[0] or "F" in told.logs[0]
    late = round((0.5 if driven else 0.02) / (told.logs[0]["time"][1] - told.logs[0]["time"][0]))
    return told.each(lambda log: {key: v[late:] - (v[late] if key == "time" else 0.0) for key, v in log.items()})


OTHERWISE: dict[str, Callable[[Told], Told]] = {
    "in another order": lambda told: replace(told, order=(2, 1, 0)),
    "in another folder, under other names": lambda told: replace(told, folder="x y", names=("z", "b", "a")),
    "in other units": lambda told: replace(told, columns=told.other_units),
    "in volts": _volts,
    "with signs turned": _mirrored,
    "with another zero of the sensor": lambda told: told.each(
        lambda log: {key: values + told.offsets.get(key, 0.0) for key, values in log.items()}
    ),
    "with a clock that begins elsewhere": lambda told: told.each(lambda log: {**log, "time": log["time"] + 5.0}),
    "begun later": _cut,
    "at half the rate": lambda told: told.each(lambda log: {key: values[::2] for key, values in log.items()}),
}
SAME_SAMPLES = {*list(OTHERWISE)[:5], "with a clock that begins elsewhere"}
"""Ways in which nothing but digits is lost."""


@cache
def shaken(hardening: float = 0.0, friction: float = 0.0) -> Told:
    """A rig under a measured force, its acceleration logged; a cubic spring [N/m^3], dry friction [N]."""
    logs = []
    for seed in (1, 2, 3):
        random = np.random.default_rng(seed)
        time = np.arange(round(SECONDS * RATE)) / RATE
        frequencies, phases = np.arange(4.0, 14.0, 0.5), random.uniform(0.0, 2 * np.pi, 20)
        force = lambda t, f=frequencies, p=phases: 3.0 * np.sin(2 * np.pi * np.multiply.outer(t, f) + p).sum(-1)  # noqa: E731
        pull = _law(force, hardening, friction)
        way = _integrated(pull, time, 0.0)
        noise = 0.02 * random.standard_normal(len(time))
        logs.append({"time": time, "F": force(time), "a": pull(time, way) + noise})
    return Told(
        tuple(logs),
        {"F": Column("N"), "a": Column("m/s^2")},
        "experiment: forced, channels: {force: F, acceleration: a}",
        {"F": Column("kN", 1000.0), "a": Column("g", 9.80665)},
        {"F": Column("V", 40.0), "a": Column("V", 5.0)},
        ", per_volt: {acceleration: 5.0, force: 40.0}",
        {"a": 0.3},
    )


@cache
def let_go(friction: float = 0.0) -> Told:
    """The rig let go, its position logged; dry friction [N]."""
    logs = []
    for seed, start in ((1, 8e-3), (2, 6e-3), (3, 7e-3)):
        random = np.random.default_rng(seed)
        time = np.arange(round(2.0 * RATE)) / RATE
        way = _integrated(_law(lambda t: 0.0 * t, 0.0, friction), time, start)
        logs.append({"time": time, "x": way[0] + 2e-5 * random.standard_normal(len(time))})
    return Told(
        tuple(logs),
        {"x": Column("m")},
        "experiment: free_response, channels: {position: x}",
        {"x": Column("mm", 1e-3)},
        {"x": Column("V", 2e-3)},
        ", per_volt: {position: 0.002}",
        {"x": 1e-3},
    )


def _law(force: Callable[..., np.ndarray], hardening: float, friction: float) -> Callable[..., np.ndarray]:
    return lambda t, y: (
        force(t) - DAMPING * y[1] - STIFFNESS * y[0] - hardening * y[0] ** 3 - friction * np.tanh(y[1] / 1e-4)
    ) / MASS  # fmt: skip


def _integrated(pull: Callable[..., np.ndarray], time: np.ndarray, start: float) -> np.ndarray:
    return solve_ivp(
        lambda t, y: [y[1], pull(t, y)], (0.0, time[-1]), [start, 0.0], "LSODA", t_eval=time, rtol=1e-9, atol=1e-12
    ).y


@cache
def rolls(effect: str = "", value: float = 0.0) -> Told:
    """The bundled robot let go in roll from three sizes of motion, its three accelerations logged at 1,000 Hz: releases
    of one size do not tell tires that harden under the robot's weight from a mast at twice the frequency."""
    from ssmr_ident.core.parameter import Estimate
    from ssmr_ident.experiments import FREE_RESPONSE, Conditions
    from ssmr_ident.physics.robot import robot_from_parameters
    from ssmr_ident.physics.slots import effect_values
    from ssmr_ident.session import read_parameters
    from ssmr_ident.workflows.simulate.request import Request
    from ssmr_ident.workflows.simulate.robot import run_robot

    parameters = read_parameters("p3at-extended")
    if effect:
        id, key = effect.split(".")
        parameters = replace(parameters, effects={id: {key: Estimate(value, None)}})
    logs = []
    for seed, amplitude in ((1, 0.35), (2, 0.12), (3, 0.25)):
        random = np.random.default_rng(seed)
        request = Request(FREE_RESPONSE, Conditions(motion="roll", amplitude_mm=amplitude), duration_s=1.2)
        run = run_robot(robot_from_parameters(parameters), effect_values(parameters), request)
        found = run.recording("ax", "ay", "az")
        clean = {channel.name: channel.samples for channel in found.channels}
        noisy = {name: values + 0.02 * random.standard_normal(len(values)) for name, values in clean.items()}
        logs.append({"time": found.time, **noisy})
    axes = ("ax", "ay", "az")
    text = Path(read_parameters("p3at-extended").file).read_text(encoding="utf-8")
    return Told(
        tuple(logs),
        dict.fromkeys(axes, Column("m/s^2")),
        "experiment: free_response, motion: roll",
        dict.fromkeys(axes, Column("g", 9.80665)),
        dict.fromkeys(axes, Column("V", 1.0 / VOLTS_PER_M_S2, VOLTS_ZERO)),
        "",
        {"ax": 0.1, "ay": -0.2, "az": 0.1},
        ("robot.yaml", text.replace("hum_m_s2: {value: 0.05", "hum_m_s2: {value: 0.0")),
        "rigid6",
    )
