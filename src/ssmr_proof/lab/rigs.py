"""Forced runs of the rig: band-limited noise at several levels, and sweeps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import chirp

from ssmr_ident.core.recording import Channel
from ssmr_proof.drawn.cases import Case
from ssmr_proof.lab.logs import Log
from ssmr_proof.lab.robots import DrawnRig
from ssmr_proof.plant.rig_bench import STEP, RigPlant, drive
from ssmr_proof.plant.sensing import Chain
from ssmr_proof.plant.spring_laws import law_vector

RATE = 1000.0  # Hz
STRIDE = round(1.0 / (RATE * STEP))
FORCE = 4.5  # N, root mean square at level 1
BAND = (1.0, 60.0)  # Hz


@dataclass(frozen=True)
class Run:
    """Noise or a sweep at a level of FORCE."""

    kind: str
    level: float
    heldout: bool = False


RUNS = (
    Run("noise", 0.3), Run("noise", 1.0), Run("noise", 3.0), Run("sweep", 1.0), Run("sweep", 2.5),
    Run("noise", 0.6, True), Run("noise", 2.2, True), Run("sweep", 1.6, True),
)  # fmt: skip


def forces(run: Run, duration: float, random: np.random.Generator) -> np.ndarray:
    """The force at multiples of STEP, (n,) float [N]; from rest and back to rest."""
    n = round(duration / STEP)
    t = np.arange(n) * STEP
    if run.kind == "noise":
        frequency = np.fft.rfftfreq(n, STEP)
        inside = (frequency > BAND[0]) & (frequency < BAND[1])
        spectrum = np.where(inside, random.normal(size=len(frequency)) + 1j * random.normal(size=len(frequency)), 0.0)
        signal = np.fft.irfft(spectrum, n)
        signal *= run.level * FORCE / signal.std()
    else:
        low, high = random.uniform(1.0, 2.0), random.uniform(20.0, 30.0)
        signal = 0.55 * FORCE * run.level * chirp(t, low, duration, high, phi=-90.0)
    edge = np.clip(np.minimum(t, duration - t) / 0.1, 0.0, 1.0)
    result: np.ndarray = signal * np.sin(0.5 * np.pi * edge) ** 2
    return result


def rigs(
    case: Case, drawn: DrawnRig, random: np.random.Generator, runs: tuple[Run, ...] = RUNS, duration: float = 8.0
) -> list[Log]:
    """All recordings of a case of this family."""
    change = case.change
    share, hertz, ratio = change.absorber
    plant = RigPlant(
        drawn.mass, drawn.stiffness, drawn.damping, law_vector(**change.laws), (share * drawn.mass, hertz, ratio)
    )
    sensed = change.bandwidth_hz is not None or change.range is not None
    position = not sensed and random.uniform() < 0.3
    driven = [forces(run, duration, random) for run in runs]
    motions = [drive(plant, force)[:, 0 if position else 1] for force in driven]
    reference = next(motion for run, motion in zip(runs, motions, strict=True) if run.level == 1.0)
    white = float(random.uniform(0.02, 0.05) * reference.std()) * (3.0 if case.trap == "noise" else 1.0)
    hum = float(random.uniform(0.2, 0.5) * reference.std()) if case.trap == "hum" else 0.0
    bandwidth = np.inf if change.bandwidth_hz is None else change.bandwidth_hz
    chain = Chain(white, hum, bandwidth)
    if change.range is not None:
        chain = replace(chain, range=change.range * max(float(np.abs(motion).max()) for motion in motions[:3]))
    name, label, unit = ("position", "x", "m") if position else ("acceleration", "a", "m/s^2")
    logs = []
    for count, (run, force, motion) in enumerate(zip(runs, driven, motions, strict=True), start=1):
        clean = chain.clean(motion, 1.0 / STEP, STRIDE)
        logged = chain.noisy(clean, RATE, random)
        measured_force = force[::STRIDE] + 0.006 * FORCE * random.standard_normal(len(clean))
        time = np.arange(len(clean)) / RATE
        channels = (Channel("force", measured_force, "N", "F"), Channel(name, logged, unit, label))
        entry = {"experiment": "forced", "channels": {"force": "F", name: label}}
        logs.append(
            Log(f"run-{count}", entry, time, channels, clean[:, None], logged[:, None], (name,), 50.0, run.heldout)
        )
    return logs
