"""A robot from the values of its parameters, built once for all recordings that ask for it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recent import Recent, Same
from ssmr_ident.physics.robot import Robot, robot_from_parameters

HEIGHT = "height_m"
"""Height of the centre of mass; the contact points' common z in the file."""

SHIFTS = ("contact_shift_x_m", "contact_shift_y_m")
"""How far the contact points lie from where the file has them, all alike: the centre of mass along x and y."""

SENSOR = tuple(f"accelerometer.position_m.{axis}" for axis in "xyz")
"""Place of the accelerometer, coordinate by coordinate."""

GAINS = tuple(f"accelerometer.gain.{axis}" for axis in "xyz")
"""What each axis reads of a true acceleration."""

_TENSOR = tuple(
    (row, column, f"inertia_kg_m2.{axes}")
    for row, column, axes in ((0, 0, "xx"), (1, 1, "yy"), (2, 2, "zz"), (0, 2, "xz"), (0, 1, "xy"), (1, 2, "yz"))
)
STIFFNESS = tuple(f"tire.stiffness_{axis}_N_m" for axis in "xyz")
DAMPING = tuple(f"tire.damping_{axis}_N_s_m" for axis in "xyz")

_MADE: Recent[Robot] = Recent()
"""Recordings of a session ask for the same robots in turn, and what is worked out of a robot is kept beside it."""


def _by_value(thing: object) -> Hashable:
    """What is equal for equal arrays and numbers, however often they were made."""
    if is_dataclass(thing):
        return tuple(_by_value(getattr(thing, field.name)) for field in fields(thing))
    return (thing.shape, thing.tobytes()) if isinstance(thing, np.ndarray) else thing


@dataclass(frozen=True)
class RobotBuilder:
    """From parameter values to a robot.

    Parameters
    ----------
    nominal : Robot
        As the file has it.
    """

    nominal: Robot

    @staticmethod
    def of(parameters: ParameterSet) -> RobotBuilder:
        return RobotBuilder(robot_from_parameters(parameters))

    @staticmethod
    def once(nominal: Robot) -> RobotBuilder:
        """One for all that ask for an equal robot."""
        return _BUILDERS.of(_by_value(nominal), lambda: RobotBuilder(nominal))

    @property
    def facts(self) -> dict[str, float]:
        """How heavy and how tall the file's robot is, where a fit moves neither."""
        return {"mass_kg": self.nominal.mass, HEIGHT: self.nominal.height}

    def read(self, values: Mapping[str, float]) -> tuple[Robot, np.ndarray]:
        """A robot whose axes read what they nominally do, and by what they differ from that, (3,); worked out once for
        each mapping, which all recordings of a fit ask for."""
        return self._read.of(Same(values), lambda: self._apart(values))

    def _apart(self, values: Mapping[str, float]) -> tuple[Robot, np.ndarray]:
        # what axes read of a motion does not change it: three columns of a slope are one simulation
        robot = self({name: value for name, value in values.items() if name not in GAINS})
        return robot, self.gains(values) / robot.accelerometer.gain

    def __call__(self, values: Mapping[str, float]) -> Robot:
        return _MADE.of((self._print, tuple(values), tuple(values.values())), lambda: self._made(values))

    def gains(self, values: Mapping[str, float]) -> np.ndarray:
        """What each axis reads of a true acceleration, (3,)."""
        own = self.nominal.accelerometer.gain
        return np.array([values.get(name, gain) for name, gain in zip(GAINS, own, strict=True)])

    @cached_property
    def _read(self) -> Recent[tuple[Robot, np.ndarray]]:
        return Recent()

    @cached_property
    def _print(self) -> object:
        """The same for equal robots, and quicker to look up than all of their numbers."""
        return _PRINTS.of(_by_value(self.nominal), object)

    def _made(self, values: Mapping[str, float]) -> Robot:
        robot = self.nominal
        mu_static = values.get("tire.mu_static", robot.mu_static)
        inertia = robot.inertia.copy()
        for row, column, name in _TENSOR:
            if name in values:
                inertia[row, column] = inertia[column, row] = values[name]
        points = robot.contact_points.copy()
        for index, name in enumerate(SHIFTS):
            points[:, index] += values.get(name, 0.0)
        place = robot.accelerometer.position
        if any(name in values for name in SENSOR):
            place = np.array([values.get(name, place[index]) for index, name in enumerate(SENSOR)])
        if HEIGHT in values:
            points[:, 2] -= values[HEIGHT] - robot.height
        return replace(
            robot,
            mass=values.get("mass_kg", robot.mass),
            inertia=inertia,
            contact_points=points,
            stiffness=np.array([values.get(name, robot.stiffness[i]) for i, name in enumerate(STIFFNESS)]),
            damping=np.array([values.get(name, robot.damping[i]) for i, name in enumerate(DAMPING)]),
            mu_static=mu_static,
            # one coefficient in the file stays one, unless a fit gives both
            mu_kinetic=values.get(
                "tire.mu_kinetic", mu_static if robot.mu_kinetic == robot.mu_static else robot.mu_kinetic
            ),
            cable_stiffness=values.get("cable.stiffness_N_m", robot.cable_stiffness),
            accelerometer=replace(
                robot.accelerometer,
                position=place,
                gain=self.gains(values),
                bandwidth_hz=values.get("accelerometer.bandwidth_hz", robot.accelerometer.bandwidth_hz),
            ),
        )


_BUILDERS: Recent[RobotBuilder] = Recent()
_PRINTS: Recent[object] = Recent()
