"""Free responses: the robot is pulled or turned by hand, held, and let go."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from generator import truth
from generator.writing import write_robot, write_session
from ssmr_ident.experiments import Scenario
from ssmr_ident.physics.linear import COORDINATES, linear_robot
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.physics.sensor import Noise
from ssmr_ident.readers.writers import write_labview_xlsx
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.measure import Converter, accelerometer_log

TRIALS = 8  # Table 5.2
SAMPLES = 4096  # thesis section 1: 2^12 samples, of which the first 2^11 are analysed
MOTIONS = ("roll", "pitch", "yaw")


def static_offset(robot: Robot, force: np.ndarray, point: np.ndarray, moment: np.ndarray) -> dict[str, float]:
    """Where the robot comes to rest on sticking tires under a force, from rest without it.

    Parameters
    ----------
    force : (3,) float [N]
    point : (3,) float [m]
        Where it acts, from the CoM.
    moment : (3,) float [N m]
        Besides.
    """
    wrench = np.concatenate([force, np.cross(point, force) + moment])
    return dict(zip(COORDINATES, np.linalg.solve(linear_robot(robot).stiffness, wrench), strict=True))


def release(motion: str, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Force [N], its point [m] from the CoM, and moment [N m] before letting go; no two trials alike.

    roll: the frame is pulled sideways about 0.6 m above the CoM, near the plane in which yaw is not excited.
    pitch: the laptop's shelf is pulled forward or backward, 0.15 m to 0.25 m above the CoM.
    yaw: two hands turn the platform, with a little roll between them.
    """
    sign = random.choice([-1.0, 1.0])
    if motion == "roll":
        point = np.array([random.normal(0.04, 0.015), 0.0, random.normal(0.6, 0.03)])
        return sign * np.array([0.0, random.uniform(18.0, 26.0), 0.0]), point, np.zeros(3)
    if motion == "pitch":
        point = np.array([0.0, random.normal(0.0, 0.02), random.uniform(0.15, 0.25)])
        return sign * np.array([random.uniform(20.0, 30.0), 0.0, 0.0]), point, np.zeros(3)
    return np.zeros(3), np.zeros(3), sign * np.array([random.normal(0.0, 1.0), 0.0, random.uniform(5.0, 8.0)])


def make(folder: Path, seed: int) -> None:
    """Write data/raw/free_response."""
    folder.mkdir(parents=True, exist_ok=True)
    parameters = truth.true_robot("frame")
    robot = robot_from_parameters(parameters)
    noise = Noise(truth.WHITE_M_S2, truth.HUM_M_S2)
    entries = []
    for index, motion in enumerate(MOTIONS):
        for trial in range(1, TRIALS + 1):
            random = np.random.default_rng([seed, 1, index, trial])
            offset = static_offset(robot, *release(motion, random))
            scenario = Scenario("free_response", SAMPLES / 1000.0, offset=offset)
            simulation = simulate(robot, scenario, step=truth.INTEGRATION_STEP)
            if simulation["sliding"].any():
                raise RuntimeError(f"{motion} {trial}: a contact slides; pull less")
            log = accelerometer_log(simulation, robot.accelerometer, noise, random, Converter())
            file = f"{motion}-{trial}.xlsx"
            write_labview_xlsx(folder / file, log, header="segment")
            entries.append({"file": file, "experiment": "free_response", "motion": motion, "trial": trial})
    write_session(folder / "session.yaml", "extended-robot-free-response", "robot.yaml", entries)
    write_session(
        folder / "decoupled.yaml",
        "extended-robot-free-response-decoupled",
        "robot.yaml",
        entries,
        baseline="decoupled",
        comment="The same logs against the thesis' pure rotations (5.3), which leave the body's translation out.",
    )
    write_robot(folder / "robot.yaml", truth.lab_robot("frame", "concrete"))
    write_robot(folder / "truth.yaml", parameters)
