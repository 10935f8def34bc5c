"""A network that is driven at a body, let go, or shaken by its foot."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter, lfilter_zi

from ssmr_ident.core.errors import InputError, SimulationError, did_you_mean
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.estimate.foot import foot_motion
from ssmr_ident.estimate.from_file import laws_of
from ssmr_ident.estimate.network import bare
from ssmr_ident.estimate.node import Member
from ssmr_ident.estimate.pieces import STEPS, Piece
from ssmr_ident.estimate.simulated import Compiled, simulate
from ssmr_ident.estimate.values import Problem
from ssmr_ident.experiments.experiment import BASES
from ssmr_ident.experiments.quantities import UNITS
from ssmr_ident.physics.network import Network, network_from_parameters
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.signals.grid import band_limited
from ssmr_ident.workflows.simulate.logged import logged
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.simulate.rig import ROTARY, STRAIGHT, drive_of

Array = np.ndarray

FINER = 4
"""Steps a sample at least, between which a drive is straight."""

PART = 20_000
"""Steps that are run at once."""


def driven(parameters: ParameterSet, request: Request) -> Recording:
    """Under a measured force, or torque, at one body."""
    network = network_from_parameters(parameters)
    body = _body(network, request, 0)
    name = "torque" if network.layout.rotary else "force"
    time, rate, force = drive_of(request, "force", (name,))[:3]
    motion = _motion(network, parameters, force, rate, into=body)
    return logged(request, time, **{name: (force, UNITS[name])}, **_channels(network, motion))


def let_go(parameters: ParameterSet, request: Request) -> Recording:
    """Pushed at one body, and let go at rest: the start is the static shape of that push."""
    network, conditions = network_from_parameters(parameters), request.conditions
    layout = network.layout
    body = _body(network, request, len(layout.bodies) - 1)
    if not layout.grounded:
        raise InputError("--experiment", "a network that no spring holds to the ground has nothing to be let go from",
                         "Drive it: forced")  # fmt: skip
    push = np.zeros(len(layout.bodies))
    push[body] = 1.0
    shape = np.linalg.solve(layout.matrices(network.values)[2], push)
    if conditions.push_N:
        if layout.rotary:
            raise InputError("--push-N", "deflects no rotary network", "Say where it is let go: --amplitude-deg")
        shape = conditions.push_N * shape
    else:
        amplitude = math.radians(conditions.amplitude_deg) if layout.rotary else conditions.amplitude_mm * 1e-3
        shape = amplitude * shape / shape[body]
    count = round(request.duration * request.rate)
    motion = _motion(network, parameters, np.zeros(count), request.rate, start=shape)
    return logged(request, np.arange(count) / request.rate, **_channels(network, motion))


def shaken(parameters: ParameterSet, request: Request) -> Recording:
    """On a foot whose motion was measured: what the bodies do is absolute."""
    network = network_from_parameters(parameters)
    if network.layout.rotary or not network.layout.grounded:
        raise InputError("--experiment", "base_motion shakes along a line what springs join to the ground",
                         "Drive it: forced")  # fmt: skip
    time, rate, base, name = drive_of(request, "base", BASES[::-1])
    foot = foot_motion(base, name, {"acceleration": 2}, rate, request.base)
    motion = _motion(network, parameters, foot[:, 2], rate, based=True)
    motion[:, :2] += foot[:, :2, None]  # the accelerations are absolute already
    found = _channels(network, motion)
    if name == "base_acceleration":  # where the foot itself is, is not known
        found = {key: value for key, value in found.items() if key.endswith("acceleration")}
    return logged(request, time, **{name: (base, UNITS[name])}, **found)


def _body(network: Network, request: Request, usual: int) -> int:
    """Number of the body that ``--at`` names."""
    bodies, name = network.layout.bodies, request.conditions.at
    if name and name not in bodies:
        raise InputError("--at", f"is {name!r}, which is no body", did_you_mean(name, bodies))
    return bodies.index(name) if name else usual


def _motion(
    network: Network, parameters: ParameterSet, drive: Array, rate: float, start: Array | None = None, into: int = 0,
    based: bool = False,
) -> Array:  # fmt: skip
    """Coordinates and rates, relative to a foot that is shaken, and accelerations, (n, 3, bodies) float."""
    bodies, members = len(network.layout.bodies), laws_of(parameters)
    fastest = float(max(network.modes()[0], default=0.0))
    every = max(FINER, math.ceil(STEPS * fastest / rate) if members else 0)
    fine = band_limited(drive, every)
    states = np.zeros(2 * bodies)
    states[:bodies] = 0.0 if start is None else start
    run = Run(network, every * rate, into, based)
    found = run.along(fine, states, ())
    if members:  # how far the linear network goes is the scale on which a law's own velocity is found
        found = run.along(fine, states, members, float(np.std(found[:, 0])))
    slow = low_pass_coefficients(parameters.number("accelerometer.bandwidth_hz", math.inf), 1 / (rate * every))
    if slow[0] != 1.0:
        over, under = slow[:3], np.array([1.0, *slow[3:]])
        begun = np.outer(lfilter_zi(over, under), found[0, 2])
        found[:, 2] = lfilter(over, under, found[:, 2], axis=0, zi=begun)[0]
    return np.array(found[::every])


@dataclass(frozen=True, eq=False)
class Run:
    """A network at a step of 1/rate [s], driven at body ``into`` or by its foot."""

    network: Network
    rate: float
    into: int
    based: bool

    def along(self, drive: Array, start: Array, members: tuple[Member, ...], size: float = 1.0) -> Array:
        """(n, 3, bodies) float, part by part so that long runs need no more memory than short ones.

        Parameters
        ----------
        drive : (n,) float [N], or [m/s^2] of the foot
        start : (2·bodies,) float
        members : tuple of Member
            Laws at one spring.
        size : float [m]
            Of the motion.
        """
        bodies, node = len(self.network.layout.bodies), replace(bare(self.network), members=members)
        point = np.array([c.mean for c in node.coordinates])
        hertz = float(max(self.network.modes()[0], default=self.rate / STEPS))
        state, found = np.concatenate([start, np.zeros(node.states - len(start))])[None], []
        for first in range(0, len(drive), PART):
            count = min(PART, len(drive) - first)
            shape = count, 3 * bodies
            piece = Piece(
                "", 0, ("",) * 3 * bodies, np.repeat(np.arange(3), bodies), (first + np.arange(count)) / self.rate,
                np.zeros(shape), np.ones(shape, dtype=bool), drive[first : first + PART + 1], self.based, True,
                1.0 / self.rate, 1, np.ones(3 * bodies), bodies=tuple(range(bodies)) * 3, into=self.into,
            )  # fmt: skip
            problem = Problem((piece,), node.baseline, (), hertz, size, layout=node.layout)
            model = Compiled.of(problem, node, point, [piece])
            (moved,) = simulate(model, [state], [np.array([0, count])], [0.0])
            if not np.isfinite(moved.y).all():
                raise SimulationError(f"the network left the finite numbers before {piece.time[-1]:.4g} s")
            found.append(moved.y)
            state = moved.ends
        return np.vstack(found).reshape(-1, 3, bodies)


def _channels(network: Network, motion: Array) -> dict[str, tuple[Array, str]]:
    """Columns ``BODY_QUANTITY``; an angular acceleration is nothing that loggers know."""
    names = ROTARY if network.layout.rotary else STRAIGHT
    return {
        f"{body}_{name}": (motion[:, order, k], UNITS[name])
        for k, body in enumerate(network.layout.bodies)
        for order, name in enumerate(names)
    }
