"""Random sessions of a rig: driven by measured noise and sweeps, or let go."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.signal import butter, chirp, sosfiltfilt

from bank.disturbances import Disturbance
from bank.laws import laws
from bank.rig_physics import LISTED, OTHER, UNLISTED, Physics, Scale
from bank.rig_plant import run_rig
from bank.truth import BankSession, Made, Truth, recording
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.rig import Rig
from ssmr_ident.session import Entry, Session

FORCED = (
    ("noise", 0.25, "target"), ("noise", 1.0, "target"), ("noise", 3.0, "target"), ("sweep", 1.0, "target"),
    ("sweep", 2.5, "target"), ("noise", 0.6, "heldout"), ("noise", 2.2, "heldout"), ("sweep", 1.6, "heldout"),
)  # fmt: skip
LET_GO = ((1.0, "target"), (0.6, "target"), (0.35, "target"), (0.8, "target"), (0.75, "heldout"), (0.45, "heldout"))
QUANTITIES = {"acceleration": (2, "m/s^2"), "velocity": (1, "m/s"), "position": (0, "m")}
NOISE_FORCE, SWEEP_FORCE = 4.5, 2.44  # N at level 1


def draw_rig(random: np.random.Generator) -> tuple[Rig, ParameterSet]:
    """A rig, and what its user knows of it: mass to 2 %, stiffness to 10 %, damping to 35 %."""
    rig = Rig(random.uniform(6.0, 9.5), random.uniform(20.0, 75.0), random.uniform(13e3, 23e3))
    known = {}
    for key, true, share, unit in (
        ("mass_kg", rig.mass, 0.02, "kg"),
        ("stiffness_N_m", rig.stiffness, 0.10, "N/m"),
        ("damping_N_s_m", rig.damping, 0.35, "N s/m"),
    ):
        told = true / max(0.3, 1.0 + share * random.standard_normal())
        known[key] = Estimate(told, share * told, unit)
    known["accelerometer.range_m_s2"] = Estimate(16.66, None, "m/s^2", fixed=True)
    known["accelerometer.bandwidth_hz"] = Estimate(500.0, None, "Hz", fixed=True)
    return rig, ParameterSet("rig", known)


def forces(
    plan: Sequence[tuple[str, float, str]], rate: float, seconds: float, random: np.random.Generator
) -> list[np.ndarray]:
    """Band-limited noise of 2 to 28 Hz, or a sine from 4.5 to 20 Hz, per line of the plan."""
    n = round(rate * seconds)
    time = np.arange(n) / rate
    made = []
    for shape, level, _ in plan:
        if shape == "noise":
            band = butter(3, [2.0, 28.0], "bandpass", fs=rate, output="sos")
            drive = sosfiltfilt(band, random.standard_normal(n))
            made.append(NOISE_FORCE * level * drive / drive.std())
        else:
            made.append(SWEEP_FORCE * level * chirp(time, 4.5, seconds, 20.0, "linear", -90.0))
    return made


def draw_forced(kind: str, seed: int, effect: str | None, size: float | None, short: bool) -> BankSession:
    """Five recordings to fit and three held out; ``short`` ones last a second and a half."""
    random = np.random.default_rng([seed, 15])
    rig, known = draw_rig(random)
    rate = float(random.choice([500.0, 1000.0, 1000.0, 2000.0] if not short else [500.0]))
    seconds = 2.0 if short else float(random.choice([2.0, 4.0, 8.0]) if kind == "none" else random.choice([4.0, 8.0]))
    drives = forces(FORCED, rate, seconds, random)
    quantity = str(random.choice(["acceleration", "acceleration", "position", "velocity"]))
    if effect is not None and effect.startswith("sensor"):  # an accelerometer's
        quantity = "acceleration"
    strongest = run_rig(rig, drives[2], rate, laws())
    at = Scale(rig, float(strongest[:, 0].std()), float(strongest[:, 1].std()), seconds)
    column, unit = QUANTITIES[quantity]
    asked = size
    for _ in range(20):  # a spring that softens may let the mass go: drawn again
        chosen, size = choose(kind, effect, asked, at, random, quantity)
        rows = laws(*(row for physics in chosen for row in physics.rows))
        slow = next((p.parameters["bandwidth_hz"] for p in chosen if p.id == "sensor_bandwidth"), math.inf)
        bandwidth = slow if math.isfinite(slow) else (500.0 if rate > 1000.0 else math.inf)
        runs = [run_rig(rig, drive, rate, rows, bandwidth_hz=bandwidth)[:, column] for drive in drives]
        if all(np.isfinite(run).all() for run in runs):
            break
    chosen, limit = clipped(chosen, runs)
    sensor = motion_sensor(quantity, strongest[:, column].std(), random)
    load_cell = Disturbance(white=random.uniform(0.015, 0.03), quantum=1e-3)
    made = []
    for index, ((_, _, role), drive, clean) in enumerate(zip(FORCED, drives, runs, strict=True)):
        clean = np.clip(clean, -limit, limit)
        logged = {
            "force": (load_cell.add(drive, rate, random), "N"),
            quantity: (sensor.add(clean, rate, random), unit),
        }
        file = f"run-{index + 1}.csv"
        entry = Entry(file, "forced", role=role)
        made.append(Made(entry, recording(file, rate, **logged), {quantity: clean}))
    return session("forced", kind, seed, size, known, made, chosen, rig)


def draw_let_go(kind: str, seed: int, effect: str | None, size: float | None, short: bool) -> BankSession:
    """A rig pulled aside and let go: four recordings to fit and two held out."""
    random = np.random.default_rng([seed, 16])
    rig, known = draw_rig(random)
    rate = float(random.choice([500.0, 1000.0])) if not short else 500.0
    seconds = min(6.0, 6.0 * 2.0 * rig.mass / rig.damping) if not short else 1.5
    quiet = np.zeros(round(rate * seconds))
    quantity = str(random.choice(["acceleration", "position"]))
    if effect is not None and effect.startswith("sensor"):  # an accelerometer's
        quantity = "acceleration"
    pulled = random.uniform(1e-3, 3e-3)
    # a decay is large for a short time only: its scale is a third of the start
    at = Scale(rig, pulled / 3.0, pulled / 3.0 * math.sqrt(rig.stiffness / rig.mass), seconds)
    chosen, size = choose(kind, effect, size, at, random, quantity)
    rows = laws(*(row for physics in chosen for row in physics.rows))
    slow = next((p.parameters["bandwidth_hz"] for p in chosen if p.id == "sensor_bandwidth"), math.inf)
    column, unit = QUANTITIES[quantity]
    runs = []
    for share, _ in LET_GO:
        start = float(share * pulled * random.uniform(0.9, 1.1) * random.choice([-1.0, 1.0]))
        runs.append(run_rig(rig, quiet, rate, rows, (start, 0.0), slow)[:, column])
    chosen, limit = clipped(chosen, runs)
    sensor = motion_sensor(quantity, runs[0].std(), random)
    made = []
    for index, ((_, role), clean) in enumerate(zip(LET_GO, runs, strict=True)):
        clean = np.clip(clean, -limit, limit)
        file = f"swing-{index + 1}.csv"
        logged = {quantity: (sensor.add(clean, rate, random), unit)}
        made.append(Made(Entry(file, "free_response", role=role), recording(file, rate, **logged), {quantity: clean}))
    return session("rig_decay", kind, seed, size, known, made, chosen, rig)


def motion_sensor(quantity: str, strongest: float, random: np.random.Generator) -> Disturbance:
    """Noise of 0.5 to 2 % of the strongest recording's rms, now and then coloured, with a little mains."""
    white = float(random.uniform(0.005, 0.02) * strongest)
    coloured = float(random.choice([0.0, random.uniform(0.1, 0.6)]))
    hum = float(random.uniform(0.0, 0.5) * white) if quantity == "acceleration" else 0.0
    return Disturbance(white, coloured, random.uniform(5.0, 60.0), hum, 0.5 * white, 0.1 * white)


def choose(
    kind: str, effect: str | None, size: float | None, at: Scale, random: np.random.Generator, quantity: str
) -> tuple[tuple[Physics, ...], float]:
    """Physics of a kind; where no size is asked for it is drawn evenly."""
    size = float(random.uniform()) if size is None else size
    listed = [name for name in LISTED if quantity == "acceleration" or not name.startswith("sensor")]
    if kind == "none":
        return (), 0.0
    if kind == "one":
        name = effect or str(random.choice(listed))
        return (LISTED[name](size, at, random),), size
    if kind == "two":
        names = random.choice([name for name in listed if not name.startswith("sensor")], 2, replace=False)
        return tuple(LISTED[name](max(size, 0.4), at, random) for name in names), size
    makers = OTHER if kind == "other" else UNLISTED
    return (makers[int(random.integers(len(makers)))](size, at, random),), size


def clipped(chosen: tuple[Physics, ...], runs: list[np.ndarray]) -> tuple[tuple[Physics, ...], float]:
    """The sensor's range from its share of the largest acceleration; infinite where nothing clips."""
    for physics in chosen:
        if physics.id == "sensor_saturation":
            limit = float(physics.parameters["share_of_peak"] * max(np.abs(run).max() for run in runs))
            return (Physics(physics.id, {"range_m_s2": limit}, ()),), limit
    return chosen, math.inf


def session(
    family: str, kind: str, seed: int, size: float, known: ParameterSet, made: list[Made],
    chosen: tuple[Physics, ...], rig: Rig,
) -> BankSession:  # fmt: skip
    """Everything put together."""
    entries = tuple(one.entry for one in made)
    campaign = Campaign(
        Session(f"bank-{seed}", Path("bank"), "rig.yaml", "sdof", entries),
        known,
        tuple(one.measurement for one in made),
    )
    truth = Truth(
        "missing_physics" if chosen else "nothing_missing",
        {physics.id: physics.parameters for physics in chosen},
        "; ".join(physics.formula for physics in chosen if physics.formula),
        {"mass_kg": rig.mass, "damping_N_s_m": rig.damping, "stiffness_N_m": rig.stiffness},
        {one.entry.file: one.noise_floor for one in made},
    )
    return BankSession(family, kind, seed, size, campaign, truth)
