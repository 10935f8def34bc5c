"""The MJCF robot as plain numbers and words: nothing here runs the engine."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.physics.robot import Robot
from ssmr_ident.simulate.mjcf.bodies import chassis, hubs, wheel_inertia
from ssmr_ident.simulate.mjcf.build import Build
from ssmr_proof.mujoco_run import run_mujoco


def test_the_parts_add_up_to_the_robot(robot: Robot) -> None:
    build = Build(tires="strut", driven=True)
    mass, centre, inertia = chassis(robot, build)
    places, masses = [centre, *hubs(robot, build)], [mass] + 4 * [build.wheel_mass]
    own = [inertia] + 4 * [wheel_inertia(robot, build) * np.eye(3)]
    assert sum(masses) == pytest.approx(robot.mass, rel=1e-14)
    first = sum(m * p for m, p in zip(masses, places, strict=True))
    assert first == pytest.approx(np.zeros(3), abs=1e-14)
    total = sum(j + m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p, j in zip(masses, places, own, strict=True))
    assert total == pytest.approx(robot.inertia, abs=1e-14)


def test_what_cannot_be_built_says_so(robot: Robot) -> None:
    with pytest.raises(InputError, match="more than the robot"):
        chassis(robot, Build(wheel_mass=20.0))
    with pytest.raises(InputError, match="does not turn"):
        Build(tires="patch", driven=True)


def test_without_the_engine_one_line_says_what_to_install(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r"ssmr_ident\[proof\]"):
        run_mujoco(robot, 0.1, Build())


def test_a_sample_is_a_whole_number_of_steps(robot: Robot) -> None:
    pytest.importorskip("mujoco")
    with pytest.raises(InputError, match="whole number of steps"):
        run_mujoco(robot, 0.1, Build(step=3e-4))
