"""Shaken rigs that an integrator of their own moves, so that their truth shares no code with the simulator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.signal import butter, sosfilt

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.session import Entry, Session

RATE, SECONDS, LEVELS = 500.0, 6.0, (1.0, 3.0, 6.0)
MASS, DAMPING, STIFFNESS = 6.0, 40.0, 15000.0
NOISE = 2e-5
"""m; a third of a percent of the motion, as an encoder or a laser gives it. With ten times less, the error of splitting
and of the force between its samples shows beside the noise."""


def rig(law, seed: int = 7, limit: float | None = None, sensor_hz: float | None = None) -> Campaign:
    """Three shaken runs of m x'' + d x' + k x + law(x, v) = F by classical Runge-Kutta, ten steps a sample.

    Their position is logged, or their acceleration by a sensor that reads no more than ``limit`` of the largest, and is
    a second-order Butterworth of ``sensor_hz``.
    """
    rng = np.random.default_rng(seed)
    tones = np.linspace(2.0, 14.0, 40)[:, None]
    phases = rng.uniform(0.0, 2.0 * np.pi, (40, len(LEVELS)))
    step, count = 0.1 / RATE, int(RATE * SECONDS)
    halves = 0.5 * step * np.arange(20 * count + 1)
    force = np.stack(
        [a * np.cos(2 * np.pi * tones * halves + phases[:, [k]]).sum(axis=0) for k, a in enumerate(LEVELS)], axis=1
    )

    def rate(f, x, v):
        return (f - DAMPING * v - STIFFNESS * x - law(x, v)) / MASS

    x, v, path = np.zeros(len(LEVELS)), np.zeros(len(LEVELS)), []
    for n in range(10 * count):
        f0, f1, f2 = force[2 * n], force[2 * n + 1], force[2 * n + 2]
        a1 = rate(f0, x, v)
        path.append(x if limit is None else a1)
        v2 = v + 0.5 * step * a1
        a2 = rate(f1, x + 0.5 * step * v, v2)
        v3 = v + 0.5 * step * a2
        a3 = rate(f1, x + 0.5 * step * v2, v3)
        v4 = v + step * a3
        a4 = rate(f2, x + step * v3, v4)
        x = x + step / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    fine, noise, channel, unit = np.array(path), NOISE, "position", "m"
    if sensor_hz is not None:
        fine = sosfilt(butter(2, sensor_hz, fs=10.0 * RATE, output="sos"), fine, axis=0)
    seen = fine[::10]
    if limit is not None:
        noise, channel, unit = 3e-3 * float(np.std(seen)), "acceleration", "m/s^2"
        seen = np.clip(seen, -limit * seen.max(), limit * seen.max())
    seen = seen + noise * rng.standard_normal(seen.shape)
    time = np.arange(count) / RATE
    measurements = []
    for k in range(len(LEVELS)):
        channels = (Channel("force", force[::20, k][:count], "N"), Channel(channel, seen[:, k], unit))
        entry = Entry(f"run-{k}.csv", "forced")
        measurements.append(Measurement(entry, Recording(time, channels, Provenance("drawn", "", "test"))))
    known = ParameterSet(
        "rig",
        {
            "mass_kg": Estimate(6.05, 0.12, "kg"),
            "damping_N_s_m": Estimate(45.0, 15.0, "N s/m"),
            "stiffness_N_m": Estimate(14600.0, 1500.0, "N/m"),
        },
    )
    if sensor_hz is not None:
        known = known.updated({"accelerometer.bandwidth_hz": Estimate(200.0, 5.0, "Hz")})
    session = Session("drawn", Path(), "rig", "sdof", tuple(m.entry for m in measurements))
    return Campaign(session, known, tuple(measurements))
