"""Which baseline can be simulated in which experiment: the one table of ``ident simulate``."""

from __future__ import annotations

from collections.abc import Callable

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.experiments import (
    BASE_MOTION,
    FORCED,
    FREE_RESPONSE,
    PULL,
    STRAIGHT,
    SWIVEL,
    VERTICAL_COMPRESSION,
    WHEEL_DRAG,
    Experiment,
)
from ssmr_ident.physics.network import NETWORK, bodies_of
from ssmr_ident.workflows.simulate import network, rig, robot
from ssmr_ident.workflows.simulate.request import Request

Cell = Callable[[ParameterSet, Request], Recording]

_WHOLE: dict[str, Cell] = {"rigid6": robot.whole, "decoupled": robot.whole}
_WHEEL: dict[str, Cell] = {"rigid6": robot.one_wheel, "decoupled": robot.one_wheel}
TABLE: dict[Experiment, dict[str, Cell]] = {
    FREE_RESPONSE: {
        "rigid6": robot.whole,
        "decoupled": robot.turning_purely,
        "sdof": rig.let_go,
        NETWORK: network.let_go,
    },
    SWIVEL: _WHOLE,
    STRAIGHT: _WHOLE,
    PULL: {**_WHOLE, "drag": rig.pulled_block},
    WHEEL_DRAG: {**_WHEEL, "drag": rig.pulled_block},
    VERTICAL_COMPRESSION: _WHEEL,
    FORCED: {"sdof": rig.driven, NETWORK: network.driven},
    BASE_MOTION: {"sdof": rig.shaken, NETWORK: network.shaken},
}
"""By experiment and baseline; what is not here makes no sense."""

WHAT = {
    "rigid6": "a robot",
    "decoupled": "a robot of pure rotations",
    "sdof": "a rig with one mass",
    NETWORK: "a network of bodies",
    "drag": "a pulled block",
}


def simulated(parameters: ParameterSet, request: Request) -> Recording:
    """What would be logged.

    Raises
    ------
    InputError
        An experiment that this baseline knows nothing of, or a parameter that is missing.
    """
    baseline = request.baseline or baseline_of(parameters)
    if baseline not in WHAT:
        raise InputError("--baseline", f"is {baseline!r}", did_you_mean(baseline, WHAT))
    cell = TABLE[request.experiment].get(baseline)
    if cell is None:
        where = f"{parameters.file or parameters.name}: --experiment {request.experiment.name}"
        those = ", ".join(kind.name for kind, cells in TABLE.items() if baseline in cells)
        raise InputError(where, f"is nothing for {WHAT[baseline]} ({baseline})", f"Ask for {those}")
    return cell(parameters, request)


def baseline_of(parameters: ParameterSet) -> str:
    """What a parameter file describes, by its keys.

    Raises
    ------
    InputError
        Neither a robot, nor a rig, nor a network, nor a block.
    """
    if any(key.startswith(("contact_points_m", "tire.")) for key in parameters):
        return "rigid6"
    if bodies_of(parameters):
        return NETWORK
    if any(key in parameters for key in ("stiffness_N_m", "stiffness_N_m_rad", "damping_N_s_m", "damping_N_m_s_rad")):
        return "sdof"
    if any(key in parameters for key in ("mu_static", "mu_kinetic")):
        return "drag"
    mend = (
        "A robot has contact_points_m, a rig stiffness_N_m and damping_N_s_m, a network bodies and springs, a block "
        "mu_static and mu_kinetic"
    )
    raise InputError(parameters.file or parameters.name, "describes nothing that can be simulated", mend)
