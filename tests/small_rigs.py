"""Small rigs simulated for tests: a mass on a spring, let go or shaken, with physics that a fit does not know of."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import JointFit, differentiate, evaluate
from ssmr_ident.identify.trials import Trial
from ssmr_ident.physics.rig import Rig
from ssmr_ident.session import Entry, Session
from ssmr_ident.signals.noise import AutoregressiveNoise
from ssmr_ident.simulate.rig import simulate_rig

RIG = Rig(8.0, 50.0, 20000.0)
"""8 Hz, damping ratio 6 %."""

RATE, NOISE = 250.0, 2e-5
ROUGH = ParameterSet(
    "rig",
    {
        "mass_kg": Estimate(8.0, None, "kg", fixed=True),
        "damping_N_s_m": Estimate(50.0, 25.0, "N s/m"),
        "stiffness_N_m": Estimate(20000.0, 4000.0, "N/m"),
    },
)


@dataclass(frozen=True)
class Run:
    """One recording: let go from a displacement [m], or shaken by noise of a force [N rms]."""

    release: float = 0.0
    force: float = 0.0


def campaign(effects: dict, runs: list[Run], seed: int, duration: float = 3.0, noise: float = NOISE) -> Campaign:
    """Position records of the rig."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(duration * RATE)) / RATE
    measurements = []
    for number, run in enumerate(runs):
        force = run.force * _band(rng.standard_normal(len(time)))
        motion = simulate_rig(RIG, force, RATE, run.release, effects=effects)[:, 0]
        seen = motion + noise * rng.standard_normal(len(time))
        channels = [Channel("position", seen, "m")]
        if run.force:
            channels.append(Channel("force", force, "N"))
        name = f"run-{number}.csv"
        entry = Entry(name, "forced" if run.force else "free_response", role="target")
        measurements.append(Measurement(entry, Recording(time, tuple(channels), Provenance(name, "", "test"))))
    last = measurements[-1]
    measurements.append(replace(last, entry=replace(last.entry, file="kept.csv", role="heldout")))
    session = Session("rig", Path(), "rig.yaml", "sdof", tuple(m.entry for m in measurements))
    return Campaign(session, ROUGH, tuple(measurements))


def prepared(made: Campaign, noise: float = NOISE) -> Setup:
    """Set up, with the noise that was put in."""
    setup = set_up(made, made.parameters)
    return replace(setup, fitted=tuple(quiet(trial, noise) for trial in setup.fitted))


def quiet(trial: Trial, noise: float = NOISE) -> Trial:
    return trial.with_noises(tuple(AutoregressiveNoise(np.ones(1), noise) for _ in trial.channels))


def fitted(setup: Setup, effects: dict | None = None, iterations: int = 12) -> JointFit:
    """The baseline at its best, maybe with effects held at given values, with slopes."""
    model = replace(setup.model, held=effects or {})
    point = np.zeros(len(model.physics))
    values, _ = model.split(point)
    begin = [trial.begin(values, effects or {}) for trial in setup.fitted]
    return differentiate(descend(evaluate(setup.fitted, model, point, begin), iterations))


def _band(white: np.ndarray) -> np.ndarray:
    """1 rms between 2 and 20 Hz, nothing at the ends."""
    frequency = np.fft.rfftfreq(len(white), 1.0 / RATE)
    shaped = np.fft.irfft(np.fft.rfft(white) * ((frequency > 2.0) & (frequency < 20.0)), len(white))
    return shaped / shaped.std() * np.hanning(len(white)) ** 0.25
