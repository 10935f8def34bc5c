"""Networks of bodies on springs simulated for tests by scipy's Runge-Kutta, which shares no code with the library."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline

from ssmr_ident.core.parameter import Estimate, ParameterSet

Law = Callable[[float, float], float]
"""Force of a spring beside its straight line [N], over stretch [m] and rate [m/s]."""


@dataclass(frozen=True)
class Chain:
    """Masses [kg] in a row, the first on the ground, springs [N/m] and dampers [N s/m] each before its mass."""

    masses: tuple[float, ...]
    stiffness: tuple[float, ...]
    damping: tuple[float, ...]
    laws: Mapping[int, Law] = field(default_factory=dict)

    def known(self, off: float = 1.0, std: float | None = None) -> ParameterSet:
        """What a lab would write of it, stiffness wrong by a factor."""
        names = [f"m{k + 1}" for k in range(len(self.masses))]
        estimates = {
            f"bodies.{n}.mass_kg": Estimate(m, 0.02 * m, "kg") for n, m in zip(names, self.masses, strict=True)
        }
        between = {}
        for k, (stiff, damp) in enumerate(zip(self.stiffness, self.damping, strict=True)):
            spring = f"s{k + 1}"
            between[spring] = (names[k - 1] if k else "ground", names[k])
            estimates[f"springs.{spring}.stiffness_N_m"] = Estimate(off * stiff, std, "N/m")
            estimates[f"springs.{spring}.damping_N_s_m"] = Estimate(2.0 * damp, None, "N s/m")
        return ParameterSet("chain", estimates, between=between, file="rig.yaml")

    def accelerations(self, q: np.ndarray, v: np.ndarray, force: np.ndarray) -> np.ndarray:
        stretch, rate = np.diff(q, prepend=0.0), np.diff(v, prepend=0.0)
        pull = np.array(self.stiffness) * stretch + np.array(self.damping) * rate
        for k, law in self.laws.items():
            pull[k] += law(float(stretch[k]), float(rate[k]))
        net = force - pull
        net[:-1] += pull[1:]
        return net / np.array(self.masses)

    def motion(self, time: np.ndarray, push: np.ndarray, into: int, start: np.ndarray) -> np.ndarray:
        """(n, 3, bodies): coordinates, rates, accelerations; the push [N] is smooth between the samples."""
        n = len(self.masses)
        along = np.zeros(n)
        along[into] = 1.0

        between = make_interp_spline(time, push, k=5)

        def change(t: float, s: np.ndarray) -> np.ndarray:
            return np.r_[s[n:], self.accelerations(s[:n], s[n:], along * between(t))]

        found = solve_ivp(
            change, (0.0, time[-1]), start, t_eval=time, rtol=1e-7, atol=1e-10, max_step=2.0 * (time[1] - time[0])
        )
        q, v = found.y[:n].T, found.y[n:].T
        rows = [self.accelerations(q[k], v[k], along * push[k]) for k in range(len(time))]
        return np.stack([q, v, np.array(rows)], axis=1)


def write_session(folder: Path, known: ParameterSet, entries: list[str], baseline: str = "network") -> Path:
    """session.yaml and rig.yaml; ``entries`` are lines of YAML."""
    from ssmr_ident.session import write_parameters

    write_parameters(folder / "rig.yaml", known)
    lines = "\n".join(f"- {entry}" for entry in entries)
    text = f"schema: ssmr-ident/session/1\nname: made\nrobot: rig.yaml\nbaseline: {baseline}\nrecordings:\n{lines}\n"
    (folder / "session.yaml").write_text(text)
    return folder


def write_log(file: Path, time: np.ndarray, columns: Mapping[str, np.ndarray]) -> None:
    """CSV with a heading and its unit for each column."""
    head = ",".join(["time [s]", *columns])
    np.savetxt(file, np.column_stack([time, *columns.values()]), "%.9g", ",", header=head, comments="")


Runs = list[tuple[np.ndarray, np.ndarray, np.ndarray]]
"""Times, force [N] and accelerations of all bodies, (n, bodies)."""


def written(folder: Path, known: ParameterSet, runs: Runs, into: int) -> Path:
    """A session of forced runs, the last of several held out."""
    entries = []
    for number, (time, push, a) in enumerate(runs):
        columns = {"force [N]": push} | {f"a{k + 1} [m/s^2]": a[:, k] for k in range(a.shape[1])}
        write_log(folder / f"run-{number}.csv", time, columns)
        names = ["acceleration", *(f"acceleration_{k + 1}" for k in range(1, a.shape[1]))]
        channels = [f"{n}: {{column: a{k + 1}, body: m{k + 1}}}" for k, n in enumerate(names)]
        channels.append(f"force: {{column: force, body: m{into + 1}}}")
        role = ", role: heldout" if number and number == len(runs) - 1 else ""
        entries.append(f"{{file: run-{number}.csv, experiment: forced{role}, channels: {{{', '.join(channels)}}}}}")
    return write_session(folder, known, entries)


def pushed(
    chain: Chain, random: np.random.Generator, size: float, seconds: float, rate: float
) -> tuple[np.ndarray, np.ndarray]:
    """Times and a band of noise [N] up to about twice the highest frequency of a chain."""
    time = np.arange(round(seconds * rate)) / rate
    fastest = np.sqrt(max(np.array(chain.stiffness) / np.array(chain.masses))) / (2.0 * np.pi)
    push = np.convolve(random.standard_normal(len(time)), np.hanning(max(5, int(0.9 * rate / fastest))), "same")
    return time, push * size / push.std() * np.minimum(1.0, np.minimum(time, time[-1] - time) / 0.1)


def noisy(a: np.ndarray, share: float, random: np.random.Generator) -> np.ndarray:
    """Columns with white noise, as a share of their size."""
    return a + share * a.std(axis=0) * random.standard_normal(a.shape)
