"""Run an MJCF model and log it in the same quantities as the simulator."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_ident.physics.robot import Robot
from ssmr_ident.simulate.mjcf.bodies import start
from ssmr_ident.simulate.mjcf.build import AXES, WHEELS, Build, Cable, Mast
from ssmr_ident.simulate.mjcf.robot import mjcf


@dataclass(frozen=True, eq=False)
class MujocoRun(Shown):
    """What the engine gave, under the simulator's names and in SI.

    Parameters
    ----------
    time : (n,) float [s]
    channels : mapping of str to (n,) float
        ``x``, ``y``, ``z``, ``roll``, ``pitch``, ``yaw``; ``ax``, ``ay``, ``az`` (specific force at the accelerometer,
        no low-pass); ``wx``, ``wy``, ``wz``; ``touch_1`` to ``touch_4``: normal forces of the contacts; with springs
        ``load_1`` … and ``tire_x_1`` …, ``tire_y_1`` …: forces of the tires on the chassis; ``force`` with a cable.
    xml : str
        The model.
    """

    time: np.ndarray
    channels: dict[str, np.ndarray]
    xml: str

    def __getitem__(self, name: str) -> np.ndarray:
        return self.channels[name]

    def __str__(self) -> str:
        lines = [f"mujoco: {len(self.time)} samples, {self.time[-1]:g} s"]
        lines += [f"  {name:<10} {c.min():>11.4g} … {c.max():.4g}" for name, c in self.channels.items()]
        return "\n".join(lines)


def engine() -> ModuleType:
    """The module ``mujoco``.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        import mujoco
    except ModuleNotFoundError as error:
        raise InputError("mujoco", "is not installed", "pip install 'ssmr_ident[proof]'") from error
    return mujoco


def run_mujoco(
    robot: Robot,
    duration: float,
    build: Build,
    *,
    sample_rate: float = 1000.0,
    offset: dict[str, float] | None = None,
    mast: Mast | None = None,
    cable: Cable | None = None,
    wheel_rates: np.ndarray | None = None,
) -> MujocoRun:
    """Integrate the robot in MuJoCo, on one thread.

    Parameters
    ----------
    robot : Robot
    duration : float [s]
    build : Build
    sample_rate : float [Hz]
        A sample must be a whole number of ``build.step``.
    offset : mapping, optional
        Start away from rest, as in ``Scenario``.
    mast, cable : optional
    wheel_rates : (2,) float [rad/s], optional
        Wanted rates of the left and right wheels; the build must be driven.

    Raises
    ------
    InputError
        MuJoCo is missing, or a sample is no whole number of steps.
    """
    mujoco = engine()
    stride = round(1.0 / (sample_rate * build.step))
    if abs(stride * sample_rate * build.step - 1.0) > 1e-9:
        raise InputError("mujoco: sample_rate", f"{sample_rate:g} Hz is no whole number of steps of {build.step:g} s")
    xml = mjcf(robot, build, mast, cable)
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    data.qpos[:] = start(robot, build, offset or {}, mast is not None)
    if cable is not None:
        data.actuator("cable").ctrl[0] = cable.speed
    if wheel_rates is not None:
        for name in WHEELS:
            data.actuator(name).ctrl[0] = wheel_rates[0 if name.endswith("left") else 1]
    samples = round(duration * sample_rate)
    log = np.empty((samples, model.nsensordata))
    mujoco.mj_step(model, data)  # the sensors show the state before a step
    for row in range(samples):
        log[row] = data.sensordata
        mujoco.mj_step(model, data, stride)
    return MujocoRun(np.arange(samples) / sample_rate, _channels(robot, model, log), xml)


def _channels(robot: Robot, model: object, log: np.ndarray) -> dict[str, np.ndarray]:
    def sensor(name: str) -> np.ndarray:
        entry = model.sensor(name)  # type: ignore[attr-defined]
        return log[:, entry.adr[0] : entry.adr[0] + entry.dim[0]]

    w, x, y, z = sensor("attitude").T
    channels = {axis: sensor("position")[:, i] for i, axis in enumerate(AXES)}
    channels["roll"] = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    channels["pitch"] = np.arcsin(2.0 * (w * y - z * x))
    channels["yaw"] = np.unwrap(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    channels |= {f"a{axis}": sensor("acceleration")[:, i] for i, axis in enumerate(AXES)}
    channels |= {f"w{axis}": sensor("rate")[:, i] for i, axis in enumerate(AXES)}
    names = {model.sensor(i).name for i in range(model.nsensor)}  # type: ignore[attr-defined]
    for number, name in enumerate(WHEELS, 1):
        channels[f"touch_{number}"] = sensor(f"touch_{name}")[:, 0]
        for i, axis in enumerate(AXES):
            if f"tire_{name}_{axis}" in names:
                stretch, rate = sensor(f"tire_{name}_{axis}")[:, 0], sensor(f"tire_rate_{name}_{axis}")[:, 0]
                force = "load" if axis == "z" else f"tire_{axis}"
                channels[f"{force}_{number}"] = robot.stiffness[i] * stretch + robot.damping[i] * rate
    if "cable" in names:
        channels["force"] = -sensor("cable")[:, 0]
    return channels
