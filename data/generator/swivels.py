"""Swivels: the robot turns on the spot for 20 s, on three floors, with and without frame and laptop."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from generator import truth
from generator.writing import write_robot, write_session
from ssmr_ident.experiments import Scenario
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.physics.sensor import Noise
from ssmr_ident.readers.writers import write_labview_xlsx, write_lvm
from ssmr_ident.simulate import Simulation, simulate
from ssmr_ident.simulate.measure import Converter, accelerometer_log

SPEEDS = (10, 20, 30, 45, 60)  # deg/s; the thesis' wheels lift above 64
REPEATED = 30  # deg/s, a second time where the frame is on
DURATION = 20.0  # s
SETTLING = 2.0  # s before the log begins
FRAMES = {"frame": "frame", "platform": "noFrame"}  # as the thesis' file names say it


def run(robot: Robot, speed: float, random: np.random.Generator) -> Simulation:
    """One swivel in its steady course, cut to the logged 20 s; a start a hair off rest tells repeats apart."""
    scenario = Scenario(
        "swivel",
        DURATION + SETTLING,
        offset={"x": random.normal(0.0, 1e-4), "y": random.normal(0.0, 1e-4), "yaw": random.normal(0.0, 1e-3)},
        wheel_rates=np.atleast_2d(wheel_rates(robot, 0.0, np.deg2rad(speed))),
    )
    whole = simulate(robot, scenario, step=truth.INTEGRATION_STEP)
    skip = round(SETTLING * 1000)
    return Simulation(whole.time[: len(whole.time) - skip], whole.values[skip:], whole.names, scenario, whole.step)


def make(folder: Path, seed: int, frame: str) -> None:
    """Write data/raw/swivel-frame or data/raw/swivel-platform."""
    folder.mkdir(parents=True, exist_ok=True)
    noise = Noise(truth.WHITE_M_S2, truth.HUM_M_S2)
    everything = []
    for part, floor in enumerate(truth.FLOORS):
        parameters = truth.on_flat_relays(truth.true_robot(frame, floor))
        robot = robot_from_parameters(parameters)
        runs = [(speed, 1) for speed in SPEEDS] + ([(REPEATED, 2)] if frame == "frame" else [])
        entries = []
        for speed, trial in runs:
            random = np.random.default_rng([seed, 3 + list(FRAMES).index(frame), part, speed, trial])
            log = accelerometer_log(run(robot, speed, random), robot.accelerometer, noise, random, Converter())
            stem = f"v0-w{speed}-t20-{FRAMES[frame]}-{floor}" + ("" if trial == 1 else f"-{trial}")
            # a workbook is four times a text log once that is packed: the thesis' form for the thesis' robot only
            if frame == "frame" and trial == 1:
                file = f"{stem}.xlsx"
                write_labview_xlsx(folder / file, log, header="segment")
            else:
                file = f"{stem}.lvm"
                write_lvm(folder / file, log)
            entries.append(
                {
                    **{"file": file, "experiment": "swivel", "yaw_rate_deg_s": speed},
                    **{"floor": floor, "frame": frame, "trial": trial},
                }
            )
        write_session(folder / f"{floor}.yaml", f"swivels-{frame}-{floor}", f"robot-{floor}.yaml", entries)
        write_robot(folder / f"robot-{floor}.yaml", truth.lab_robot(frame, floor))
        write_robot(folder / f"truth-{floor}.yaml", parameters)
        everything += entries
    write_session(folder / "session.yaml", f"swivels-{frame}", "robot.yaml", everything)
    write_robot(folder / "robot.yaml", truth.lab_robot(frame))
