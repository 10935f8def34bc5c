"""A pendulum driven far, with friction in its bearing: neither law alone follows it, and a cubic is no sine."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.session import Entry, Session
from ssmr_ident.workflows.diagnose import diagnose

RATE, SECONDS = 100.0, 9.0
INERTIA, WEIGHT, DAMPING, FRICTION = 0.02, 0.64, 0.012, 0.05


def swing(size: float, seed: int) -> Recording:
    random = np.random.default_rng(seed)
    phase, time = random.uniform(0.0, 2.0 * math.pi, 9), np.arange(round(RATE * SECONDS)) / RATE
    lines = np.linspace(0.3, 1.9, 9)

    def moment(t: float | np.ndarray) -> np.ndarray:
        whole = np.sin(2.0 * math.pi * np.multiply.outer(t, lines) + phase).sum(axis=-1)
        return np.asarray(size * whole * np.minimum(t, 1.0))

    def rates(t: float, s: np.ndarray) -> list[float]:
        held = WEIGHT * math.sin(s[0]) + DAMPING * s[1] + FRICTION * math.tanh(s[1] / 0.01)
        return [s[1], (float(moment(t)) - held) / INERTIA]

    angle = solve_ivp(rates, (0.0, time[-1]), [0.0, 0.0], "LSODA", t_eval=time, rtol=1e-9, atol=1e-11).y[0]
    channels = (
        Channel("torque", moment(time), "N m"),
        Channel("angle", angle + 2e-4 * random.standard_normal(len(time)), "rad"),
    )
    return Recording(time, channels, Provenance(f"swing-{seed}.csv", "", "test"))


@pytest.mark.slow
def test_a_sine_and_friction() -> None:
    runs = [swing(size, seed) for seed, size in enumerate((0.1, 0.13, 0.12))]
    assert 1.5 < max(float(np.abs(r["angle"]).max()) for r in runs) < math.pi
    measurements = [Measurement(Entry(r.provenance.file, "forced", role="target"), r) for r in runs]
    measurements[-1] = replace(measurements[-1], entry=replace(measurements[-1].entry, role="heldout"))
    known = ParameterSet(
        "rig",
        {
            "inertia_kg_m2": Estimate(INERTIA, 0.03 * INERTIA, "kg m^2"),
            "stiffness_N_m_rad": Estimate(WEIGHT, None, "N m/rad"),
            "damping_N_m_s_rad": Estimate(0.03, None, "N m s/rad"),
        },
    )
    session = Session("rig", Path(), "rig.yaml", "sdof", tuple(m.entry for m in measurements))
    found = diagnose(Campaign(session, known, tuple(measurements)))
    effects = {e.id: e.parameters for e in found.effects}
    assert set(effects) == {"nonlinear_stiffness", "dry_friction"}
    assert effects["dry_friction"]["F_c_N_m"].value == pytest.approx(FRICTION, rel=0.05)
    sine = effects["nonlinear_stiffness"]
    assert sine["sine_share"].value == pytest.approx(1.0, abs=0.05)
    assert sine["k3_N_m_rad3"].value == pytest.approx(-WEIGHT / 6.0, rel=0.05)
    assert found.heldout.after < 2.0 * found.heldout.noise_floor
