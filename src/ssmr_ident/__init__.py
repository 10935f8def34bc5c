"""System identification for accelerometer and force logs.

The front door: about a dozen names, imported when they are first used.

>>> import ssmr_ident
>>> robot = ssmr_ident.read_parameters("p3at-extended")
>>> robot.number("tire.stiffness_y_N_m")
18000.0
"""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"

# name: room and the name it has there; verbs are told apart from the rooms of the same name
_DOOR = {
    "read": ("readers", "read"),
    "read_parameters": ("session", "read_parameters"),
    "write_parameters": ("session", "write_parameters"),
    "load": ("experiments.campaign", "load"),
    "robot_from_parameters": ("physics.robot", "robot_from_parameters"),
    "CATALOGUE": ("physics.effects", "CATALOGUE"),
    "Scenario": ("experiments", "Scenario"),
    "simulate_robot": ("simulate.simulation", "simulate"),
    "simulate_rig": ("simulate.rig", "simulate_rig"),
    "fit_decay": ("identify.decays.fit", "fit_decay"),
    "fit_session": ("workflows.fit.run", "fit_session"),
    "compare_session": ("workflows.compare", "compare_session"),
    "diagnose_session": ("workflows.diagnose", "diagnose_session"),
    "read_results": ("workflows.batch.results", "read_results"),
    "plot": ("workflows.plot", "plot"),
}

__all__ = [*_DOOR, "__version__"]


def __getattr__(name: str) -> Any:
    if name not in _DOOR:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    room, there = _DOOR[name]
    value = getattr(importlib.import_module(f"{__name__}.{room}"), there)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
