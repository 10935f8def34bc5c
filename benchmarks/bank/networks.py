"""Random sessions of two or three bodies in a row on springs, driven by measured noise, a law at one of the springs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.signal import butter, sosfiltfilt

from bank.laws import laws
from bank.network_plant import run_network
from bank.rig_physics import LISTED, Scale
from bank.truth import BankSession, Made, Truth, recording
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.rig import Rig
from ssmr_ident.session import Entry, Session

RUNS = ((0.5, "target"), (1.0, "target"), (2.0, "target"), (1.4, "heldout"))
"""Level of the force of each recording, and its role."""

SPRINGS = (
    "nonlinear_stiffness",
    "dry_friction",
    "hysteresis",
    "quadratic_damping",
    "viscoelastic_relaxation",
    "free_play",
)
PERIODS, RATE = 60.0, 14.0
"""Of the lowest mode that a recording lasts; samples a period of the highest."""


def draw_network(kind: str, seed: int, effect: str | None = None, size: float | None = None) -> BankSession:
    """Three recordings to fit and one held out; accelerations of all bodies, force at one of them.

    Parameters
    ----------
    kind : str
        ``none`` or ``one``.
    seed : int
    effect : str, optional
        Of ``SPRINGS``.
    size : float, optional
        0 … 1; drawn evenly between 0.3 and 1 otherwise.
    """
    random = np.random.default_rng([seed, 19])
    n = int(random.choice([2, 3]))
    mass = random.uniform(0.4, 3.0, n)
    spring = mass.mean() * (2.0 * np.pi * random.uniform(6.0, 25.0)) ** 2 * random.uniform(0.6, 2.0, n)
    damper = 2.0 * random.uniform(0.005, 0.03, n) * np.sqrt(spring * mass)
    stretch = np.eye(n) - np.eye(n, k=-1)
    stiffness, damping = (stretch.T * spring) @ stretch, (stretch.T * damper) @ stretch
    omega = np.sqrt(np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(mass, mass))))
    low, high = omega[[0, -1]] / (2.0 * np.pi)
    rate, seconds, into = round(RATE * high, 1), PERIODS / low, int(random.integers(n))
    count = round(rate * seconds)
    band = butter(2, [0.4 * low, 1.4 * high], "bandpass", fs=rate, output="sos")
    taper = np.minimum(1.0, np.minimum(np.arange(count), np.arange(count)[::-1]) * low / rate)
    level = 0.02 * spring[0] * 1e-3 * 10.0
    drives = []
    for share, _ in RUNS:
        noise = sosfiltfilt(band, random.standard_normal(count)) * taper
        drives.append(share * level * noise / noise.std())
    at, step = int(random.integers(n)), 0.02 / (2.0 * np.pi * high)

    def run(drive: np.ndarray, rows: np.ndarray) -> np.ndarray:
        return run_network(mass, damping, stiffness, stretch[at], rows, drive, into, rate, step)

    strongest = run(drives[2], laws())
    x, v = (strongest[:, order] @ stretch[at] for order in (0, 1))
    own = Rig(float(spring[at] / (v.std() / x.std()) ** 2), float(damper[at]), float(spring[at]))
    chosen, size = (), 0.0 if kind == "none" else float(random.uniform(0.3, 1.0)) if size is None else size
    if kind == "one":
        name = effect or str(random.choice(SPRINGS))
        chosen = (LISTED[name](size, Scale(own, float(x.std()), float(v.std()), seconds), random),)
    rows = laws(*(row for physics in chosen for row in physics.rows))
    runs = [run(drive, rows)[:, 2] for drive in drives]
    names = [f"m{k + 1}" for k in range(n)]
    known = _known(names, mass, spring, damper, random)
    quantities = ["acceleration", *(f"acceleration_{k + 1}" for k in range(1, n))]
    bodies = dict(zip(quantities, names, strict=True)) | {"force": names[into]}
    made = []
    for index, ((_, role), drive, clean) in enumerate(zip(RUNS, drives, runs, strict=True)):
        file, white = f"run-{index + 1}.csv", 0.008 * runs[1].std(axis=0)
        noisy = clean + white * random.standard_normal(clean.shape)
        logged = {q: (noisy[:, k], "m/s^2") for k, q in enumerate(quantities)}
        logged["force"] = (drive + 0.002 * level * random.standard_normal(count), "N")
        entry = replace(Entry(file, "forced", role=role), bodies=bodies)
        made.append(Made(entry, recording(file, rate, **logged), dict(zip(quantities, clean.T, strict=True))))
    session = Session(f"bank-{seed}", Path("bank"), "rig.yaml", "network", tuple(one.entry for one in made))
    truth = Truth(
        "missing_physics" if chosen else "nothing_missing",
        {physics.id: physics.parameters for physics in chosen},
        "",
        {f"springs.s{k + 1}.stiffness_N_m": float(value) for k, value in enumerate(spring)},
        {one.entry.file: one.noise_floor for one in made},
        f"s{at + 1}" if chosen else "",
    )
    return BankSession("network", kind, seed, size, Campaign(session, known, tuple(m.measurement for m in made)), truth)


def _known(
    names: list[str], mass: np.ndarray, spring: np.ndarray, damper: np.ndarray, random: np.random.Generator
) -> ParameterSet:
    """Masses to 2 %, stiffnesses to 15 %, dampings to a half."""
    found, between = {}, {}
    for name, true in zip(names, mass.tolist(), strict=True):
        told = true * (1.0 + 0.02 * random.standard_normal())
        found[f"bodies.{name}.mass_kg"] = Estimate(told, 0.02 * told, "kg")
    for k, (stiff, damp) in enumerate(zip(spring.tolist(), damper.tolist(), strict=True)):
        between[f"s{k + 1}"] = (names[k - 1] if k else "ground", names[k])
        told = stiff * float(np.exp(0.15 * random.standard_normal()))
        found[f"springs.s{k + 1}.stiffness_N_m"] = Estimate(told, 0.15 * told, "N/m")
        found[f"springs.s{k + 1}.damping_N_s_m"] = Estimate(damp * random.uniform(0.5, 1.5), None, "N s/m")
    return ParameterSet("network", found, between=between)
