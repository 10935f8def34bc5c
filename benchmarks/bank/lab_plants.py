"""Two plants of any lab: a pendulum let go, which friction brings to rest, and a carriage under position control.

The pendulum is scipy's, the carriage its own loop with friction that holds; neither shares anything with the simulator.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

Array = np.ndarray

SESSION = """\
schema: ssmr-ident/session/1
name: s
robot: rig.yaml
baseline: sdof
recordings:
  - {{file: early.csv, experiment: {experiment}, channels: {channels}}}
  - {{file: late.csv, experiment: {experiment}, channels: {channels}, role: heldout}}
"""

SWINGS = (("sine", "friction"), ("sine",), ("sine", "drag"), ("friction",))
CARRIAGES = (("friction",), ("friction",), (), ("friction", "drag"))
NAMES = {"sine": "nonlinear_stiffness", "friction": "dry_friction", "drag": "quadratic_damping"}


@dataclass(frozen=True)
class Swing:
    """A pendulum and how it is let go and seen; ``periods`` : until friction, or drag, has taken about all."""

    laws: tuple[str, ...]
    inertia: float
    hz: float
    ratio: float
    degrees: float
    periods: float
    seconds: float
    rate: float
    encoder: float
    seed: int

    def write(self, folder: Path) -> Path:
        """The session, its second half kept back."""
        turning, size = 2.0 * math.pi * self.hz, math.radians(self.degrees)
        stiffness, damping = self.inertia * turning**2, 2.0 * self.ratio * self.inertia * turning
        friction = stiffness * size / (4.0 * self.periods) if "friction" in self.laws else 0.0
        drag = 0.25 * stiffness / turning**2 / self.periods if "drag" in self.laws else 0.0

        def rates(t: float, y: Array) -> list[float]:
            held = stiffness * (math.sin(y[0]) if "sine" in self.laws else y[0])
            rubs = friction * math.tanh(y[1] / (1e-4 * size * turning)) + drag * y[1] * abs(y[1])
            return [y[1], -(held + damping * y[1] + rubs) / self.inertia]

        time = np.arange(round(self.seconds * self.rate)) / self.rate
        angle = solve_ivp(rates, (0.0, time[-1]), [size, 0.0], "LSODA", t_eval=time, rtol=1e-8, atol=1e-10).y[0]
        noisy = angle + 0.3 * self.encoder * np.random.default_rng(self.seed).standard_normal(len(time))
        columns = {"time [s]": time, "angle [rad]": self.encoder * np.round(noisy / self.encoder)}
        rig = (
            f"inertia_kg_m2: {{value: {self.inertia:.6g}, unit: kg m^2, fixed: true}}\n"
            f"stiffness_N_m_rad: {{value: {1.2 * stiffness:.4g}, unit: N m/rad}}\n"
            f"damping_N_m_s_rad: {{value: {3.0 * damping:.4g}, unit: N m s/rad}}\n"
        )
        return _written(folder, columns, 0.5, rig, "free_response", "{angle: angle}")


@dataclass(frozen=True)
class Carriage:
    """A carriage on a rail; forces in shares of what accelerates it, ``disturbed`` one a value of the log."""

    mass: float
    speed: float
    acceleration: float
    friction: float
    damping: float
    drag: float
    offset: float
    disturbed: float
    control_hz: float
    seconds: float
    rate: float
    encoder_s: float
    seed: int

    def write(self, folder: Path) -> Path:
        """The session, its last two fifths kept back; the command is the log's force, held between values."""
        inner = 4
        random, scale, h = np.random.default_rng(self.seed), self.mass * self.acceleration, 1.0 / (inner * self.rate)
        count = inner * round(self.seconds * self.rate)
        wanted, wanted_rate = _trapezoids(random, self.speed, self.acceleration, h, count)
        turning = 2.0 * math.pi * self.control_hz
        damping, drag = scale / self.speed * self.damping, scale / self.speed**2 * self.drag
        pushed = self.disturbed * scale * np.repeat(random.standard_normal(count // inner), inner) + self.offset * scale
        x, v, command, log = 0.0, 0.0, 0.0, np.empty((count // inner, 2))
        for k in range(count):
            if k % inner == 0:
                error, rate = wanted[k] - x, wanted_rate[k] - v
                command = self.mass * (turning**2 * error + 1.4 * turning * rate) + damping * wanted_rate[k]
                log[k // inner] = command, x
            free = v + h * (command + pushed[k] - damping * v - drag * v * abs(v)) / self.mass
            v = math.copysign(max(abs(free) - h * self.friction * scale / self.mass, 0.0), free)
            x += h * v
        step = self.encoder_s * self.speed
        place = step * np.round(log[:, 1] / step)
        columns = {"time [s]": np.arange(len(log)) / self.rate, "force [N]": log[:, 0], "q [m]": place}
        rig = (
            f"mass_kg: {{value: {0.9 * self.mass:.4g}, std: {0.3 * self.mass:.3g}, unit: kg}}\n"
            "stiffness_N_m: {value: 0, unit: N/m, fixed: true}\n"
            f"damping_N_s_m: {{value: {1.5 * damping:.4g}, unit: N s/m}}\n"
        )
        return _written(folder, columns, 0.6, rig, "forced", "{force: force, position: q}")


def draw_swing(seed: int) -> Swing:
    """From 5 to 95 degrees, 0.3 to 1.5 Hz, an encoder of 0.3 or 1.5 mrad."""
    random, laws = np.random.default_rng(seed), SWINGS[seed % len(SWINGS)]
    hz = random.uniform(0.3, 1.5)
    return Swing(
        laws, 10.0 ** random.uniform(-2.3, 0.3), hz, 10.0 ** random.uniform(-3.0, -1.7),
        random.uniform(25.0, 95.0) if "sine" in laws else random.uniform(5.0, 60.0), random.uniform(6.0, 25.0),
        min(random.uniform(15.0, 35.0) / hz, 60.0), float(random.choice([100.0, 200.0, 250.0])),
        float(random.choice([3.14e-4, 1.53e-3])), seed,
    )  # fmt: skip


def draw_carriage(seed: int) -> tuple[tuple[str, ...], Carriage]:
    """What it hides, and the carriage: 0.3 to 100 kg, friction of a tenth to six tenths of what accelerates it."""
    random, laws = np.random.default_rng(10_000 + seed), CARRIAGES[seed % len(CARRIAGES)]
    speed = 10.0 ** random.uniform(-1.3, -0.3)
    return laws, Carriage(
        10.0 ** random.uniform(-0.5, 2.0), speed, speed * 10.0 ** random.uniform(0.3, 1.0),
        random.uniform(0.1, 0.6) if "friction" in laws else 0.0, random.uniform(0.1, 0.6),
        random.uniform(0.2, 0.5) if "drag" in laws else 0.0, random.uniform(-0.1, 0.1), random.uniform(0.02, 0.06),
        random.uniform(1.5, 5.0), random.uniform(10.0, 25.0), float(random.choice([200.0, 500.0, 1000.0])),
        10.0 ** random.uniform(-4.3, -3.0), seed,
    )  # fmt: skip


def _trapezoids(random: np.random.Generator, speed: float, pull: float, h: float, count: int) -> tuple[Array, Array]:
    """Places and speeds of moves between random stops, at rest for a moment at each."""
    rates, at, place = np.zeros(count), round(0.3 / h), 0.0
    while at < count:
        target = random.uniform(-1.5, 1.5) * speed
        way = abs(target - place)
        if way < 0.2 * speed:
            continue
        fastest = min(speed * random.uniform(0.4, 1.0), math.sqrt(way * pull))
        rising, moving = fastest / pull, way / fastest
        time = h * np.arange(round((moving + rising) / h))
        move = np.minimum(np.minimum(time, rising), np.maximum(moving + rising - time, 0.0)) * pull
        move = move[: count - at]
        rates[at : at + len(move)] = math.copysign(1.0, target - place) * move
        at, place = at + len(move) + round(random.uniform(0.05, 0.6) / h), target
    return h * np.cumsum(rates), rates


def _written(folder: Path, columns: dict[str, Array], fitted: float, rig: str, experiment: str, channels: str) -> Path:
    cut = round(fitted * len(next(iter(columns.values()))))
    for name, part in (("early", slice(0, cut)), ("late", slice(cut, None))):
        table = np.column_stack([column[part] for column in columns.values()])
        np.savetxt(folder / f"{name}.csv", table, "%.9g", ",", header=",".join(columns), comments="")
    (folder / "rig.yaml").write_text(f"schema: ssmr-ident/parameters/1\nname: r\n{rig}", encoding="utf-8")
    session = SESSION.format(experiment=experiment, channels=channels)
    (folder / "session.yaml").write_text(session, encoding="utf-8")
    return folder
