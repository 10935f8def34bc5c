"""Free swings that friction ends, and carriages under position control: plants by scipy and by a drive's own loop."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ssmr_ident.workflows.diagnose import diagnose_session

pytestmark = pytest.mark.slow

SESSION = """\
schema: ssmr-ident/session/1
name: s
robot: rig.yaml
baseline: sdof
recordings:
  - {{file: early.csv, experiment: {experiment}, channels: {channels}}}
  - {{file: late.csv, experiment: {experiment}, channels: {channels}, role: heldout}}
"""


def written(folder: Path, columns: dict[str, np.ndarray], cut: int, rig: str, experiment: str, channels: str) -> Path:
    """The log in two files, the second one kept back."""
    for name, part in (("early", slice(0, cut)), ("late", slice(cut, None))):
        table = np.column_stack([column[part] for column in columns.values()])
        np.savetxt(folder / f"{name}.csv", table, "%.9g", ",", header=",".join(columns), comments="")
    (folder / "rig.yaml").write_text(f"schema: ssmr-ident/parameters/1\nname: r\n{rig}", encoding="utf-8")
    session = SESSION.format(experiment=experiment, channels=channels)
    (folder / "session.yaml").write_text(session, encoding="utf-8")
    return folder


def swing(folder: Path, sine: bool, degrees: float, hz: float, periods: float, seed: int) -> Path:
    """A pendulum that friction brings to rest after so many periods of a line; an encoder of 1.5 mrad."""
    inertia, rate, step, turning = 0.02, 200.0, 1.53e-3, 2.0 * math.pi * hz
    stiffness, size = inertia * turning**2, math.radians(degrees)
    damping, friction = 2.0 * 0.003 * inertia * turning, stiffness * size / (4.0 * periods)

    def rates(t: float, y: np.ndarray) -> list[float]:
        held = stiffness * (math.sin(y[0]) if sine else y[0])
        return [y[1], -(held + damping * y[1] + friction * math.tanh(y[1] / (1e-4 * size * turning))) / inertia]

    time = np.arange(round(1.1 * periods / hz * rate)) / rate
    angle = solve_ivp(rates, (0.0, time[-1]), [size, 0.0], "LSODA", t_eval=time, rtol=1e-8, atol=1e-10).y[0]
    noisy = angle + 0.3 * step * np.random.default_rng(seed).standard_normal(len(time))
    columns = {"time [s]": time, "angle [rad]": step * np.round(noisy / step)}
    rig = (
        f"inertia_kg_m2: {{value: {inertia}, unit: kg m^2, fixed: true}}\n"
        f"stiffness_N_m_rad: {{value: {1.2 * stiffness}, unit: N m/rad}}\n"
        f"damping_N_m_s_rad: {{value: {3.0 * damping}, unit: N m s/rad}}\n"
    )
    return written(folder, columns, len(time) // 2, rig, "free_response", "{angle: angle}")


def carriage(folder: Path, friction: float, seed: int) -> Path:
    """A carriage that a controller takes to and fro; its command, held for a millisecond, is the log's force."""
    random = np.random.default_rng(seed)
    mass, damping, speed, pull, rate, inner = 12.0, 15.0, 0.2, 1.0, 1000.0, 4
    h, count = 1.0 / (rate * inner), 12_000 * inner
    wanted = 0.25 * np.sin(np.cumsum(2.0 * math.pi * h * np.repeat(random.uniform(0.15, 0.5, 12), count // 12)))
    wanted_rate = np.gradient(wanted, h)
    stiff, braking = mass * 20.0**2, 1.4 * mass * 20.0
    disturbed = 0.04 * mass * pull * np.repeat(random.standard_normal(count // inner), inner)
    x, v, command = 0.0, 0.0, 0.0
    log = np.empty((count // inner, 2))
    for k in range(count):
        if k % inner == 0:
            command = stiff * (wanted[k] - x) + braking * (wanted_rate[k] - v)
            log[k // inner] = command, x
        free = v + h * (command + disturbed[k] + 0.5 - damping * v) / mass
        v = math.copysign(max(abs(free) - h * friction / mass, 0.0), free)
        x += h * v
    step = 1e-4 * speed
    columns = {
        "time [s]": np.arange(len(log)) / rate,
        "force [N]": log[:, 0],
        "q [m]": step * np.round(log[:, 1] / step),
    }
    rig = (
        f"mass_kg: {{value: {0.9 * mass}, std: 3, unit: kg}}\n"
        "stiffness_N_m: {value: 0, unit: N/m, fixed: true}\n"
        f"damping_N_s_m: {{value: {2.0 * damping}, unit: N s/m}}\n"
    )
    return written(folder, columns, 7000, rig, "forced", "{force: force, position: q}")


@pytest.mark.parametrize(("sine", "degrees", "hz", "periods"), [(True, 70.0, 0.8, 14.0), (False, 50.0, 0.9, 9.0)])
def test_a_swing_that_friction_ends(tmp_path: Path, sine: bool, degrees: float, hz: float, periods: float) -> None:
    found = diagnose_session(swing(tmp_path, sine, degrees, hz, periods, 1))
    assert {e.id for e in found.effects} == {"dry_friction", *(["nonlinear_stiffness"] if sine else [])}
    assert found.training.after < 1.3 * found.training.noise_floor


def test_a_carriage_rubs(tmp_path: Path) -> None:
    found = diagnose_session(carriage(tmp_path, 4.0, 2))
    assert [e.id for e in found.effects] == ["dry_friction"]
    force = found.effects[0].parameters["F_c_N"]
    assert force.std is not None
    assert abs(float(force.value) - 4.0) < 3.0 * force.std + 0.05


def test_a_held_command_is_no_delay(tmp_path: Path) -> None:
    found = diagnose_session(carriage(tmp_path, 0.0, 3))
    assert (found.verdict, found.effects) == ("nothing_missing", ())
