"""Free responses as the thesis begins them: each motion shows its own line, that of the determinant of section 5."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.experiments.free_response import pressed
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.physics.statics import rest_loads
from ssmr_ident.session import read_parameters
from ssmr_ident.signals.peaks import find_peaks
from ssmr_ident.signals.spectra import amplitude_spectrum
from ssmr_ident.simulate.simulation import simulate

BIN = 1000.0 / 2048.0


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def line_of_the_determinant(robot: Robot, motion: str) -> float:
    """Slowest damped frequency [Hz] of the coupled (5.11) with its m, or of (5.3) for yaw."""
    axis = {"roll": 0, "pitch": 1, "yaw": 2}[motion]
    k, d = robot.stiffness, robot.damping
    a, c, h = 0.14, 0.18, robot.height
    inertia = robot.inertia[axis, axis]
    if motion == "yaw":
        roots = np.roots([inertia, 4 * (c * c * d[0] + a * a * d[1]), 4 * (c * c * k[0] + a * a * k[1])])
    else:
        side, arm = (1, c) if motion == "roll" else (0, a)
        moving = [robot.mass, 4 * d[side], 4 * k[side]]
        tilting = [
            inertia,
            4 * (h * h * d[side] + arm * arm * d[2]),
            4 * (h * h * k[side] + arm * arm * k[2]) - robot.mass * GRAVITY * h,
        ]
        between = [4 * h * d[side], 4 * h * k[side]]
        roots = np.roots(np.polysub(np.polymul(moving, tilting), np.polymul(between, between)))
    return float(np.min(np.abs(roots.imag[np.abs(roots.imag) > 1.0])) / (2 * np.pi))


@pytest.mark.parametrize(
    ("motion", "channel", "printed"), [("roll", "ay", 6.0425), ("pitch", "ax", 2.9297), ("yaw", "ay", 7.5073)]
)
def test_each_motion_shows_its_own_line(robot: Robot, motion: str, channel: str, printed: float) -> None:
    run = simulate(robot, pressed(robot, motion, 0.0003))
    assert not run["sliding"].any()
    line = find_peaks(amplitude_spectrum(run[channel][:2048], 1000.0)).frequency[0]
    assert line == pytest.approx(line_of_the_determinant(robot, motion), abs=0.75 * BIN)
    assert line == pytest.approx(printed, abs=2.0 * BIN)


@pytest.mark.parametrize("motion", ["roll", "pitch"])
def test_only_vertical_springs_are_pressed(robot: Robot, motion: str) -> None:
    start = simulate(robot, pressed(robot, motion, 0.0003), 1000.0)
    carried = [max(abs(start[f"force_{axis}_{wheel}"][0]) for wheel in (1, 2, 3, 4)) for axis in "xy"]
    loads = np.array([start[f"load_{wheel}"][0] for wheel in (1, 2, 3, 4)])
    assert max(carried) < 0.1
    assert np.ptp(loads - rest_loads(robot)) == pytest.approx(2 * 0.0003 * robot.stiffness[2], rel=0.05)
