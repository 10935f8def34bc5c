"""A mass on a spring and a damper in the engine, driven by a force."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.core.kernel import kernel
from ssmr_proof.mujoco_run import engine
from ssmr_proof.plant.spring_laws import HIDDEN, advance, beside, law_vector

STEP = 1e-4  # s


@dataclass(frozen=True, eq=False)
class RigPlant:
    """A rig with whatever physics it has.

    Parameters
    ----------
    mass, stiffness, damping : float [kg], [N/m], [N s/m]
    laws : (len(LAWS),) float
        Beside the spring and the damper.
    absorber : (float, float, float) [kg], [Hz], [1]
        A second mass on a spring on the first: mass, natural frequency with the first held, damping ratio. A mass of
        0 for none; ``mass`` holds both.
    """

    mass: float
    stiffness: float
    damping: float
    laws: np.ndarray = field(default_factory=law_vector)
    absorber: tuple[float, float, float] = (0.0, 1.0, 0.0)


def rig_xml(rig: RigPlant) -> str:
    """The model: one slide joint with the engine's own spring and damper, and a motor."""
    second, hertz, ratio = rig.absorber
    omega = 2.0 * np.pi * hertz
    body = ""
    if second > 0.0:
        body = (
            f'<body name="second"><joint type="slide" axis="1 0 0" stiffness="{second * omega**2!r}" '
            f'damping="{2 * ratio * second * omega!r}"/><inertial pos="0 0 0" mass="{second!r}" '
            'diaginertia="1e-6 1e-6 1e-6"/></body>'
        )
    return f"""<mujoco model="rig">
  <option timestep="{STEP!r}" gravity="0 0 0" integrator="implicitfast">
    <flag contact="disable" constraint="disable" autoreset="disable"/>
  </option>
  <worldbody>
    <body name="mass">
      <joint name="way" type="slide" axis="1 0 0" stiffness="{rig.stiffness!r}" damping="{rig.damping!r}"/>
      <inertial pos="0 0 0" mass="{rig.mass - second!r}" diaginertia="1e-6 1e-6 1e-6"/>
      {body}
    </body>
  </worldbody>
  <actuator><motor joint="way"/></actuator>
</mujoco>
"""


def drive(rig: RigPlant, force: np.ndarray) -> np.ndarray:
    """Motion under a force given at every step, from rest.

    Parameters
    ----------
    rig : RigPlant
    force : (n,) float [N]
        At multiples of STEP.

    Returns
    -------
    (n, 2) float [m], [m/s^2]
        Position and acceleration.
    """
    mujoco = engine()
    model = mujoco.MjModel.from_xml_string(rig_xml(rig))
    data = mujoco.MjData(model)
    hidden, log = np.zeros(HIDDEN), np.empty((len(force), 2))
    place, speed, control, acceleration = data.qpos, data.qvel, data.ctrl, data.qacc
    for n in range(len(force)):
        mujoco.mj_step1(model, data)
        log[n, 0] = place[0]
        _control(place, speed, control, force, n, hidden, rig.stiffness, rig.damping, rig.laws)
        mujoco.mj_step2(model, data)
        log[n, 1] = acceleration[0]
    if not np.isfinite(log).all() or any(warning.number for warning in data.warning):
        raise SimulationError(f"the rig left the finite numbers with laws {rig.laws.tolist()}")
    return log


@kernel
def _control(
    place: np.ndarray,
    speed: np.ndarray,
    control: np.ndarray,
    force: np.ndarray,
    n: int,
    hidden: np.ndarray,
    stiffness: float,
    damping: float,
    laws: np.ndarray,
) -> None:
    s, v = place[0], speed[0]
    advance(s, hidden, STEP, True, laws)
    control[0] = force[n] - beside(s, v, n * STEP, hidden, stiffness, damping, 1.0, 1.0, True, laws)
