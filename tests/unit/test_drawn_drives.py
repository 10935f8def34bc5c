"""Drawn drives, by small steps with friction that holds exactly: the simulator agrees, the doctor names friction."""

from __future__ import annotations

import numpy as np
import pytest
from bank.drives import RATE, Drive, draw_drive, run_drive

from ssmr_ident.doctor.run import diagnose
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.voltage_drive import Controller, Course, VoltageDrive
from ssmr_ident.simulate.rig import simulate_rig


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.0, 0.25])
def test_the_simulator_follows_the_plant(share: float) -> None:
    drawn = Drive(0.008, 0.004, 0.5, True, 0.02, 2.5, 2e-6, 20.0, 0.01, share, 2.0)
    time = np.arange(400) / RATE
    goal = 0.8 * np.sin(2.0 * np.pi * 0.7 * time)
    plant = run_drive(drawn, goal, 4.0)
    course = Course(goal, np.ones(400), Controller(4.0, 2.0))
    effects = {
        "load_dependent_friction": {"F_c_N": 0.01, "c": share, "rounding_m_s": 1e-3},
        "nonlinear_stiffness": {"k3_N_m3": 0.0, "sine_share": 1.0},
    }
    motor = VoltageDrive(0.02, 2.5, 2e-6, 20.0)
    ours = simulate_rig(Rig(0.008, 0.004, 0.5, True), np.zeros(400), RATE, 0.0, 0.0, 16, effects=effects, motor=motor,
                        course=course)[:, 0]  # fmt: skip
    assert np.abs(ours - plant).max() < 3e-3 * np.ptp(plant)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seed"), [("none", 3), ("dry_friction", 4), ("load_dependent_friction", 2)])
def test_a_drives_friction_is_named(kind: str, seed: int) -> None:
    session = draw_drive(kind, seed)
    found = diagnose(session.campaign)
    named = tuple(effect.id for effect in found.effects)
    if kind != "load_dependent_friction":
        assert named == (() if kind == "none" else (kind,))
    else:  # what its formula leaves, a thousandth of the motion, may be called a softening of 0.3 %
        assert named in ((kind,), (kind, "nonlinear_stiffness"))
        stiffness = session.truth.parameters["stiffness_N_m_rad"]
        for beside in found.effects[1:]:
            assert max(abs(float(p.value)) for p in beside.parameters.values()) < 0.01 * stiffness  # of 1 rad
        share = found.effects[0].parameters["c"]
        assert float(share.value) == pytest.approx(session.size, abs=0.02)
