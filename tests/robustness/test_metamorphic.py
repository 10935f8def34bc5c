"""One experiment, logged in other ways, has one answer: order, folder, units, volts, signs, zeros, starts, rates.

The rig is integrated by scipy, which shares nothing with the simulator.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ssmr_ident.workflows.diagnose import diagnose_session
from ssmr_ident.workflows.fit.run import fit_session

MASS, DAMPING, STIFFNESS = 2.0, 9.0, 6000.0
RATE, SECONDS = 400.0, 4.0
RIG = """\
schema: ssmr-ident/parameters/1
name: r
mass_kg: {value: 2.0, std: 0.02, unit: kg}
stiffness_N_m: {value: 5600, std: 900, unit: N/m}
damping_N_s_m: {value: 7, std: 4, unit: N s/m}
"""


@dataclass(frozen=True)
class Told:
    """Logs as they are written: columns by header, and what session.yaml says of them all."""

    logs: tuple[tuple[np.ndarray, np.ndarray, np.ndarray], ...]
    names: tuple[str, ...] = ("one", "two", "three")
    folder: str = "session"
    force: tuple[str, float] = ("N", 1.0)
    acceleration: tuple[str, float] = ("m/s^2", 1.0)
    more: str = ""
    order: tuple[int, ...] = field(default=(0, 1, 2))

    def write(self, below: Path) -> Path:
        folder = below / self.folder
        folder.mkdir()
        rows = []
        for index in self.order:
            time, force, acceleration = self.logs[index]
            table = np.column_stack([time, force / self.force[1], acceleration / self.acceleration[1]])
            text = "\n".join(",".join(f"{value:.9g}" for value in row) for row in table)
            head = f"time [s],F [{self.force[0]}],a [{self.acceleration[0]}]"
            (folder / f"{self.names[index]}.csv").write_text(f"{head}\n{text}\n")
            role = "heldout" if index == 2 else "target"
            rows.append(
                f"  - {{file: {self.names[index]}.csv, experiment: forced, role: {role}, "
                f"channels: {{force: F, acceleration: a}}{self.more}}}"
            )
        head = "schema: ssmr-ident/session/1\nname: s\nrobot: rig.yaml\nbaseline: sdof\nrecordings:\n"
        (folder / "session.yaml").write_text(head + "\n".join(rows) + "\n")
        (folder / "rig.yaml").write_text(RIG)
        return folder


@cache
def _made() -> Told:
    logs = []
    for seed in (1, 2, 3):
        random = np.random.default_rng(seed)
        time = np.arange(round(SECONDS * RATE)) / RATE
        frequencies, phases = np.arange(4.0, 14.0, 0.5), random.uniform(0.0, 2 * np.pi, 20)
        force = lambda t, f=frequencies, p=phases: 3.0 * np.sin(2 * np.pi * np.multiply.outer(t, f) + p).sum(-1)  # noqa: E731
        pull = lambda t, y, force=force: (force(t) - DAMPING * y[1] - STIFFNESS * y[0]) / MASS  # noqa: E731
        way = solve_ivp(
            lambda t, y, pull=pull: [y[1], pull(t, y)], (0.0, time[-1]), [0.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-12
        ).y
        noise = 0.02 * random.standard_normal(len(time))
        logs.append((time, force(time), pull(time, way) + noise))
    return Told(tuple(logs))


def _each(change: Callable[..., tuple[np.ndarray, np.ndarray, np.ndarray]]) -> Callable[[Told], Told]:
    return lambda told: replace(told, logs=tuple(change(*log) for log in told.logs))


OTHERWISE: dict[str, Callable[[Told], Told]] = {
    "in another order": lambda told: replace(told, order=(2, 1, 0)),
    "in another folder, under other names": lambda told: replace(told, folder="x y", names=("z", "b", "a")),
    "in g and kN": lambda told: replace(told, acceleration=("g", 9.80665), force=("kN", 1000.0)),
    "in volts": lambda told: replace(
        told, acceleration=("V", 5.0), force=("V", 40.0), more=", per_volt: {acceleration: 5.0, force: 40.0}"
    ),
    "with both signs turned": _each(lambda t, f, a: (t, -f, -a)),
    "with another zero of the sensor": _each(lambda t, f, a: (t, f, a + 0.3)),
    "with a clock that begins elsewhere": _each(lambda t, f, a: (t + 5.0, f, a)),
    "without its first half second": _each(lambda t, f, a: (t[200:] - t[200], f[200:], a[200:])),
    "at half the rate": _each(lambda t, f, a: (t[::2], f[::2], a[::2])),
}
SAME_SAMPLES = {*list(OTHERWISE)[:5], "with a clock that begins elsewhere"}


@pytest.mark.slow
@pytest.mark.parametrize("way", OTHERWISE)
def test_the_same_fit(tmp_path: Path, way: str) -> None:
    made = _made()
    usual = fit_session(made.write(tmp_path)).parameters
    other = fit_session(OTHERWISE[way](replace(made, folder="other")).write(tmp_path)).parameters
    for key in ("mass_kg", "damping_N_s_m", "stiffness_N_m"):
        a, b = usual[key], other[key]
        assert a.std is not None
        assert b.std is not None
        apart = 1e-3 if way in SAME_SAMPLES else 3.0
        assert abs(a.value - b.value) <= apart * np.hypot(a.std, b.std), (key, str(a), str(b))


@pytest.mark.slow
@pytest.mark.parametrize("way", OTHERWISE)
def test_the_same_diagnosis_where_nothing_is_missing(tmp_path: Path, way: str) -> None:
    told = diagnose_session(OTHERWISE[way](_made()).write(tmp_path))
    assert (told.verdict, told.effects) == ("nothing_missing", ())
