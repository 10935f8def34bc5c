"""The robot in the engine: set down, pushed and let go, or pulled by a cable."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_proof.mujoco_run import engine
from ssmr_proof.plant.grip import FRICTIONS, LOAD_EXPONENT, MU, MU_SHARE, NOMINAL_LOAD, SLIP_SPEED, cable, tires
from ssmr_proof.plant.robot_model import Frame, Turned, robot_xml
from ssmr_proof.plant.spring_laws import HIDDEN, law_vector

SETTLING = 25.0  # 1/s; brake on all motion while the robot is set down and pushed, some 1.4 times its slowest mode
DECAY_STEP = 2e-4  # s
PULL_STEP = 5e-4  # s


@dataclass(frozen=True, eq=False)
class Plant:
    """A robot with whatever physics it has.

    Parameters
    ----------
    robot : Robot
        Its true numbers.
    laws : (len(LAWS),) float
        Beside every tire's spring and damper.
    frame : Frame or None
    turned : Turned or None
        Of the accelerometer.
    kinetic_share, slip_speed : float [1], [m/s]
        Of friction that falls with the sliding speed; 1 for Coulomb's law.
    load_exponent : float
        Of friction that falls with the load; 0 for Coulomb's law.
    cable_stiffness : float [N/m]
        Of the cable as it is.
    """

    robot: Robot
    laws: np.ndarray = field(default_factory=law_vector)
    frame: Frame | None = None
    turned: Turned | None = None
    kinetic_share: float = 1.0
    slip_speed: float = 1.0
    load_exponent: float = 0.0
    cable_stiffness: float = 1e6


@dataclass(frozen=True)
class Push:
    """How a decay begins: a steady force and moment on the platform, then let go.

    Parameters
    ----------
    force : (float, float, float) [N]
    moment : (float, float, float) [N m]
        About the centre of mass.
    """

    force: tuple[float, float, float]
    moment: tuple[float, float, float]


class Bench:
    """One plant in the engine. Setting it down is done once; every recording starts from there."""

    def __init__(self, plant: Plant, step: float, hook: np.ndarray | None = None) -> None:
        self.mujoco = engine()
        self.plant, self.step = plant, step
        xml = robot_xml(plant.robot, step, plant.frame, plant.turned, hook)
        self.model = self.mujoco.MjModel.from_xml_string(xml)
        self.data = self.mujoco.MjData(self.model)
        self.friction = np.zeros(FRICTIONS)
        self.friction[[MU, MU_SHARE, SLIP_SPEED, LOAD_EXPONENT, NOMINAL_LOAD]] = (
            plant.robot.mu_static, plant.kinetic_share, plant.slip_speed, plant.load_exponent,
            plant.robot.mass * GRAVITY / 4.0,
        )  # fmt: skip
        self.gripping = np.ones(4)
        self.anchor, self.slip, self.hidden = np.zeros((4, 2)), np.zeros(4), np.zeros((12, HIDDEN))
        self._set_down()

    def decay(self, push: Push, duration: float, held: float = 0.4) -> tuple[np.ndarray, np.ndarray]:
        """Push, hold, let go.

        Parameters
        ----------
        push : Push
        duration : float [s]
            From the release on.
        held : float [s]
            How long it is pushed; the force grows over the first half.

        Returns
        -------
        (n, 3) float [m/s^2], (n,) float [N]
            Specific force at the accelerometer along its axes, and the smallest load, at every step.
        """
        self._restart()
        steps = round(held / self.step)
        wrench = np.concatenate([push.force, push.moment])
        body = self.model.body("platform").id
        for n in range(steps):
            self.data.xfrc_applied[body] = wrench * min(1.0, 2.0 * n / steps)
            self._one(0.0, braked=True)
        self.hidden[:, 2] = self._stretch()  # held for long before: what creeps has crept
        self.data.xfrc_applied[body] = 0.0
        n = round(duration / self.step)
        log, loads = np.empty((n, 3)), np.empty(n)
        sensed = self.data.sensordata
        for row in range(n):
            loads[row] = self._one(row * self.step)
            log[row] = sensed
        self._check(log)
        return log, loads

    def pull(
        self, lateral: bool, speed: float, duration: float, gripping: tuple[int, ...], slack: float, sample_rate: float
    ) -> np.ndarray:
        """Tension of the cable while the machine's head moves steadily; (n,) float [N] at the samples."""
        self._restart()
        self.gripping[:] = [float(wheel in gripping) for wheel in (1, 2, 3, 4)]
        index, sign = (13, 1.0) if lateral else (12, -1.0)
        length, velocity = self.data.actuator_length, self.data.actuator_velocity
        stiffness = self.plant.cable_stiffness
        damping = 4.0 * float(np.sqrt(self.plant.robot.mass * stiffness))  # a cable that does not ring
        begin = sign * float(length[index])
        stride = round(1.0 / (sample_rate * self.step))
        log = np.empty(round(duration * sample_rate))
        for n in range((len(log) - 1) * stride + 1):
            t = n * self.step
            self.mujoco.mj_step1(self.model, self.data)
            head = begin + speed * t - slack
            tension = cable(sign * length[index], sign * velocity[index], head, speed, stiffness, damping)
            self.data.ctrl[index] = sign * tension
            self._tires(t)
            self.mujoco.mj_step2(self.model, self.data)
            if n % stride == 0:
                log[n // stride] = tension
        self._check(log)
        return log

    def _set_down(self) -> None:
        """Let the robot sink onto its tires, then take off what the tires hold sideways and in their laws."""
        self.data.qpos[2] = self.plant.robot.height - self.plant.robot.mass * GRAVITY / (
            4.0 * self.plant.robot.stiffness[2]
        )
        for seconds in (0.6, *[0.2] * 4):  # what creeps under the load creeps on after each
            for _ in range(round(seconds / self.step)):
                self._one(0.0, braked=True)
            self._unstressed()
        self.data.qvel[:] = 0.0
        self.rest = self.data.qpos.copy(), self.anchor.copy(), self.hidden.copy()

    def _unstressed(self) -> None:
        length = self.data.actuator_length[:12].reshape(4, 3)
        self.anchor[:] = length[:, :2]
        self.hidden[:] = 0.0
        self.hidden[:, 2] = self.hidden[:, 3] = self._stretch()

    def _stretch(self) -> np.ndarray:
        length = self.data.actuator_length[:12].reshape(4, 3)
        return np.column_stack([length[:, :2] - self.anchor, -length[:, 2]]).ravel()

    def _restart(self) -> None:
        self.mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:], self.anchor[:], self.hidden[:] = self.rest
        self.slip[:] = 0.0
        self.gripping[:] = 1.0
        self.mujoco.mj_forward(self.model, self.data)

    def _one(self, t: float, braked: bool = False) -> float:
        self.mujoco.mj_step1(self.model, self.data)
        lightest = self._tires(t)
        self.mujoco.mj_step2(self.model, self.data)
        if braked:
            self.data.qvel *= 1.0 - SETTLING * self.step
        return lightest

    def _tires(self, t: float) -> float:
        data, robot = self.data, self.plant.robot
        result: float = tires(
            data.actuator_length, data.actuator_velocity, data.ctrl, self.anchor, self.slip, self.hidden,
            robot.stiffness, robot.damping, self.plant.laws, self.friction, self.gripping, t, self.step,
        )  # fmt: skip
        return result

    def _check(self, log: np.ndarray) -> None:
        if not np.isfinite(log).all() or any(warning.number for warning in self.data.warning):
            raise SimulationError(f"the plant left the finite numbers with laws {self.plant.laws.tolist()}")
