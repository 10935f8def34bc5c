"""A network that is driven at a body, let go, or shaken by its foot."""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import lfilter, lfilter_zi

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.estimate.foot import foot_motion
from ssmr_ident.estimate.network import bare
from ssmr_ident.estimate.node import stepped
from ssmr_ident.estimate.pieces import Seen
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


def driven(parameters: ParameterSet, request: Request) -> Recording:
    """Under a measured force, or torque, at one body."""
    network = _network(parameters)
    body = _body(network, request, 0)
    name = "torque" if network.layout.rotary else "force"
    time, rate, force = drive_of(request, "force", (name,))[:3]
    motion = _motion(network, parameters, force, rate, into=body)
    return logged(request, time, **{name: (force, UNITS[name])}, **_channels(network, motion))


def let_go(parameters: ParameterSet, request: Request) -> Recording:
    """Pushed at one body, and let go at rest: the start is the static shape of that push."""
    network, conditions = _network(parameters), request.conditions
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
    network = _network(parameters)
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
    bodies = len(network.layout.bodies)
    every = FINER
    seen = Seen(tuple(np.repeat(np.arange(3), bodies).tolist()), tuple(range(bodies)) * 3, based, into)
    (transition, now, later, _), (rows, by_drive, _) = stepped(bare(network), network.values, seen, 1 / (rate * every))
    fine = band_limited(drive, every)
    states = np.zeros((len(fine), 2 * bodies))
    if start is not None:
        states[0, :bodies] = start
    added = np.outer(fine[:-1], now) + np.outer(fine[1:], later)
    for k, own in enumerate(added):
        states[k + 1] = transition @ states[k] + own
    found = (states @ rows.T + np.outer(fine, by_drive)).reshape(-1, 3, bodies)
    slow = low_pass_coefficients(parameters.number("accelerometer.bandwidth_hz", math.inf), 1 / (rate * every))
    if slow[0] != 1.0:
        over, under = slow[:3], np.array([1.0, *slow[3:]])
        begun = np.outer(lfilter_zi(over, under), found[0, 2])
        found[:, 2] = lfilter(over, under, found[:, 2], axis=0, zi=begun)[0]
    return np.array(found[::every])


def _channels(network: Network, motion: Array) -> dict[str, tuple[Array, str]]:
    """Columns ``BODY_QUANTITY``; an angular acceleration is nothing that loggers know."""
    names = ROTARY if network.layout.rotary else STRAIGHT
    return {
        f"{body}_{name}": (motion[:, order, k], UNITS[name])
        for k, body in enumerate(network.layout.bodies)
        for order, name in enumerate(names)
    }


def _network(parameters: ParameterSet) -> Network:
    if parameters.effects:
        where = f"{parameters.file or parameters.name}: effects"
        raise InputError(where, "do not act in a simulated network", "Leave them out")
    return network_from_parameters(parameters)
