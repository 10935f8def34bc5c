"""A session folder made by the simulator from identified parameters, in the lab's own formats."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments import FREE_RESPONSE, PULL, VERTICAL_COMPRESSION, WHEEL_DRAG, Conditions
from ssmr_ident.session import write_parameters
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.simulate.run import simulate_to_file

_LOGS: tuple[tuple[str, Request, str], ...] = (
    ("roll.lvm", Request(FREE_RESPONSE, Conditions(motion="roll", push_N=20.0)), "motion: roll"),
    ("pitch.lvm", Request(FREE_RESPONSE, Conditions(motion="pitch", push_N=20.0)), "motion: pitch"),
    ("yaw.lvm", Request(FREE_RESPONSE, Conditions(motion="yaw", push_N=20.0)), "motion: yaw"),
    (
        "pull-lateral.txt",
        Request(PULL, Conditions(direction="lateral"), duration_s=16.0),
        "direction: lateral, speed_mm_s: 1.0, height_m: 0.05, cable: steel",
    ),
    (
        "pull-longitudinal.txt",
        Request(PULL, Conditions(direction="longitudinal"), duration_s=32.0),
        "direction: longitudinal, speed_mm_s: 1.0, height_m: 0.05, cable: steel",
    ),
    (
        "drag.txt",
        Request(WHEEL_DRAG, Conditions(free_normal=False), duration_s=8.0),
        "speed_mm_s: 1.0, free_normal: false",
    ),
    (
        "compression.txt",
        Request(VERTICAL_COMPRESSION, Conditions(speed_mm_s=0.1), duration_s=25.0),
        "speed_mm_s: 0.1",
    ),
)


def write_simulated_session(parameters: ParameterSet, folder: Path) -> None:
    """Write seven logs with the noise of an ordinary sensor, ``session.yaml`` and ``robot.yaml``."""
    noise = {"noise.white_m_s2": Estimate(0.02, None, "m/s^2"), "noise.load_N": Estimate(0.3, None, "N")}
    write_parameters(folder / "robot.yaml", parameters.updated(noise))
    lines = ["# Made by the simulator from the identified parameters.", "schema: ssmr-ident/session/1"]
    lines += ["name: simulated", "robot: robot.yaml", "recordings:"]
    for name, request, facts in _LOGS:
        simulate_to_file(str(folder / "robot.yaml"), replace(request, noise=True), folder / name)
        lines.append(f"  - {{file: {name}, experiment: {request.experiment.name}, {facts}}}")
    write_text(folder / "session.yaml", "\n".join(lines) + "\n")
