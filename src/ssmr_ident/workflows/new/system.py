"""What the logs of a folder were made on: a robot, a rig, or a block that is pulled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ssmr_ident.core.recording import Recording
from ssmr_ident.experiments.experiment import ACCELERATIONS, ROBOT
from ssmr_ident.physics.network import NETWORK
from ssmr_ident.workflows.new.names import hints_of

WHEELS = {"v_left", "v_right"}


@dataclass(frozen=True, eq=False)
class Log:
    """A log that was read.

    Parameters
    ----------
    file : str
    sample : int or None
        Its number in a file that holds several.
    recording : Recording
    """

    file: str
    sample: int | None
    recording: Recording

    @property
    def stem(self) -> str:
        return Path(self.file).stem


def system_of(logs: Sequence[Log], baseline: str, template: str, mass_given: bool) -> tuple[str, str]:
    """``robot``, ``rig`` or ``block``, and why.

    Parameters
    ----------
    logs : sequence of Log
    baseline : str
        As the user gave it; empty lets the logs decide.
    template : str
        A bundled robot, where one was named.
    mass_given : bool
        Whether a single mass or inertia was: no robot is told by one number.
    """
    if baseline:
        return {"sdof": "rig", NETWORK: "rig", "drag": "block"}.get(baseline, "robot"), "by --baseline"
    if template:
        return "robot", "by --robot"
    moves, forces = any(moving(log.recording) for log in logs), any(pulling(log.recording) for log in logs)
    if not mass_given:
        reason = next((reason for log in logs if (reason := _of_a_robot(log))), "")
        if reason:
            return "robot", reason
    if forces and not moves:
        return "block", "a head pulls, and nothing but its force and its own position was logged"
    return "rig", "a motion of one mass"


def moving(recording: Recording) -> bool:
    """Whether it holds the motion of a mass, more than the position of a head that goes one way."""
    from ssmr_ident.workflows.new.log import ALL_MOTIONS, goes_one_way, quantities_of

    named = quantities_of(recording).named
    motions = (set(ALL_MOTIONS) | set(ACCELERATIONS)) & set(named)
    return bool(motions - {"position"}) or ("position" in motions and not goes_one_way(named["position"]))


def pulling(recording: Recording) -> bool:
    """Whether it holds a force."""
    from ssmr_ident.workflows.new.log import quantities_of

    return bool({"force", "torque"} & set(quantities_of(recording).named))


def _of_a_robot(log: Log) -> str:
    """What of a log only a robot has; empty for nothing."""
    names = set(log.recording.names)
    hints = hints_of(log.stem)
    if names & WHEELS:
        return f"{log.file} is a log of wheels"
    if len(names & set(ACCELERATIONS)) >= 2:
        return f"{log.file} holds the axes of a body that moves in space"
    named = hints.experiment
    if hints.motion or hints.direction or hints.wheels or (named and (named.on_wheels or named.of_one_wheel)):
        robots = [kind for kind in (hints.motion, hints.direction, named and named.words, "wheels") if kind]
        return f"{log.file} speaks of {robots[0]}"
    return ""


BASELINE = {"robot": ROBOT[0], "rig": "sdof", "block": "drag"}
"""Of each system, unless another is asked for."""
