"""Run a scenario on a robot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ssmr_ident.core.errors import SimulationError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.physics.slots import Effects
from ssmr_ident.simulate import layout as k
from ssmr_ident.simulate.body import body_of
from ssmr_ident.simulate.pulling import (
    CABLE_D,
    CABLE_K,
    HELD,
    HOOK_X,
    HOOK_Y,
    HOOK_Z,
    MOBILITY,
    PULL_X,
    PULL_Y,
    PULLED,
    PULLING,
)
from ssmr_ident.simulate.robot_kernel import run
from ssmr_ident.simulate.sensed import sensed
from ssmr_ident.simulate.step import choose_step
from ssmr_ident.simulate.together import Run

if TYPE_CHECKING:
    import pandas as pd

_UNITS = ["m/s^2"] * 3 + ["rad/s"] * 3 + ["m"] * 3 + ["rad"] * 3 + ["m/s"] * 2
_UNITS += ["N", "m", "rad/s", "rad/s", "1"] + ["N"] * 12
UNITS = dict(zip(k.OUTPUTS, _UNITS, strict=True))


@dataclass(frozen=True, eq=False)
class Simulation(Shown):
    """What the simulator gave: true quantities, before noise, clipping and volts.

    Parameters
    ----------
    time : (n,) float [s]
    values : (n, len(names)) float
        SI; ``ax``, ``ay``, ``az`` are specific forces at the accelerometer behind its low-pass.
    names : tuple of str
    scenario : Scenario
    step : float [s]
        Of the integration.
    """

    time: np.ndarray
    values: np.ndarray
    names: tuple[str, ...]
    scenario: Scenario
    step: float

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[:, self.names.index(name)]

    def recording(self, *names: str) -> Recording:
        """Chosen channels as a Recording, in SI units."""
        channels = tuple(Channel(name, self[name].copy(), UNITS[name], name) for name in names)
        return Recording(self.time, channels, Provenance(f"simulated {self.scenario.experiment}", "", "simulator"))

    def to_frame(self) -> pd.DataFrame:
        """Every channel over ``time_s``, SI; ``attrs["units"]`` names their units."""
        return self.recording(*self.names).to_frame()

    def __str__(self) -> str:
        lines = [f"{self.scenario.experiment}: {len(self.time)} samples, {self.time[-1]:g} s, step {self.step:g} s"]
        for name in ("ax", "ay", "az", "force"):
            lines.append(f"  {name:<6} {self[name].min():>10.4g} … {self[name].max():.4g} {UNITS[name]}")
        return "\n".join(lines)


def simulate(
    robot: Robot,
    scenario: Scenario,
    sample_rate: float = 1000.0,
    step: float | None = None,
    effects: Effects | None = None,
    release_drag: float = 0.0,
) -> Simulation:
    """Integrate a scenario.

    Parameters
    ----------
    robot : Robot
    scenario : Scenario
    sample_rate : float [Hz]
        Of the stored output.
    step : float or None [s]
        Upper limit of the integration step; it is shortened so that a sample is a whole number of steps. None lets
        the error estimate of ``choose_step`` decide.
    effects : mapping of effect id to mapping of parameter to value
        Physics beyond the baseline; parameters left out take their nominal values.
    release_drag : float
        Share of the kinetic friction that acts while a contact slides, where that is less than the static one: 0 is the
        thesis' (6.4), 1 is (6.4) with the term that the thesis drops. Where both are one number all of it acts.

    Raises
    ------
    SimulationError
        A state was no longer finite; says when, and with which effects and parameters.
    InputError
        An unknown effect or parameter.
    """
    one = prepared(robot, scenario, effects or {}, release_drag)
    body = one.body
    if step is None:
        step = choose_step(body.robot, scenario, body.e).step
    step, stride, samples = grid(scenario.duration, sample_rate, step)
    out = np.empty((samples, len(k.OUTPUTS)))
    failed = run(
        one.p,
        body.e,
        body.uneven,
        0.0,
        body.mast,
        one.pulling,
        one.head,
        len(one.head) - 1,
        scenario.head_step,
        scenario.wheel_rates,
        scenario.wheel_rate_step,
        one.start,
        step,
        (samples - 1) * stride,
        stride,
        low_pass_coefficients(body.robot.accelerometer.bandwidth_hz, step),
        out,
        True if one.beyond else None,
    )
    if failed >= 0:
        raise SimulationError(
            f"{scenario.experiment} left the finite numbers at t = {failed * step:.4g} s (step {step:g} s) with "
            f"effects {body.active or 'none'}; mass {body.robot.mass:g} kg, "
            f"tire stiffness {body.robot.stiffness.tolist()} N/m, damping {body.robot.damping.tolist()} N s/m. "
            "Check these values, or take a shorter step"
        )
    out[:, :3] *= body.robot.accelerometer.gain
    time = np.arange(samples) / sample_rate
    if body.read_otherwise:
        channels = {name: out[:, index] for index, name in enumerate(k.OUTPUTS)}
        out = np.column_stack(list(sensed(time, channels, body.active).values()))
    return Simulation(time, out, k.OUTPUTS, scenario, step)


def grid(duration: float, sample_rate: float, step: float) -> tuple[float, int, int]:
    """The step itself, steps from sample to sample, and samples, for an upper limit of the step [s]."""
    stride = max(1, math.ceil(1.0 / (sample_rate * step) - 1e-9))
    return 1.0 / (sample_rate * stride), stride, round(duration * sample_rate)


def prepared(robot: Robot, scenario: Scenario, effects: Effects, release_drag: float = 0.0) -> Run:
    """What the loop takes of a scenario.

    Raises
    ------
    InputError
        An unknown effect or parameter, or a mast heavier than the robot.
    """
    body = body_of(robot, effects)
    p = body.packed.copy()
    p[k.RELEASE_DRAG] = release_drag
    p[k.GRIPPING : k.GRIPPING + 4] = [float(i in scenario.wheels_gripping) for i in (1, 2, 3, 4)]
    head = scenario.head if len(scenario.head) else np.zeros(1)
    return Run(body, p, body.start(scenario), _pulling(body.robot, scenario, body.active), head)


def _pulling(robot: Robot, scenario: Scenario, active: Effects) -> np.ndarray:
    q = np.zeros(PULLING)
    if not scenario.pulled:
        return q
    stiffness = scenario.cable_stiffness or robot.cable_stiffness
    damping = scenario.cable_damping
    if damping is None:  # thesis section 4: 4 sqrt(m K)
        own = scenario.cable_stiffness is None
        damping = robot.cable_damping if own else 4.0 * math.sqrt(robot.mass * stiffness)
    for effect_id, values in active.items():
        change = CATALOGUE[effect_id].acts.get(Site.PULL)
        if change:
            softer = change(stiffness, **values)
            damping, stiffness = damping * math.sqrt(softer / stiffness), softer
    q[PULLED], q[CABLE_K], q[CABLE_D], q[HELD] = 1.0, stiffness, damping, float(scenario.held)
    q[[PULL_X, PULL_Y]] = scenario.along
    # the hook sits above the edge of the contact points, on the line through the centre of mass along which is pulled;
    # its height counts from the unloaded floor
    edges = (abs(robot.contact_points[:, 0].min()), robot.half_track)
    reach = min(edge / abs(share) for edge, share in zip(edges, scenario.along, strict=True) if share != 0.0)
    q[[HOOK_X, HOOK_Y]] = reach * scenario.along
    q[HOOK_Z] = scenario.height - robot.height
    along = np.array([q[PULL_X], q[PULL_Y], 0.0])
    turning = np.cross(q[[HOOK_X, HOOK_Y, HOOK_Z]], along)
    q[MOBILITY] = 1.0 / robot.mass + turning @ np.linalg.solve(robot.inertia, turning)
    return q
