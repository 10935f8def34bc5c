"""The engines that can be measured: functions with the arguments and the answer of ``diagnose(campaign, seed=...)``."""

from __future__ import annotations

import importlib
from typing import Protocol

from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.experiments.campaign import Campaign

ENGINES = {
    "diagnose": "ssmr_ident.workflows.diagnose:diagnose",  # what `ident diagnose` runs
    "robots": "ssmr_ident.doctor.robots.run:diagnose",  # what has been logged of a robot, by the simulator alone
    "decays": "ssmr_ident.doctor.decays.run:diagnose",  # free responses of a robot
}


class Engine(Protocol):
    def __call__(self, campaign: Campaign, *, seed: int) -> Diagnosis: ...


def engine_named(name: str) -> Engine:
    """By its name in the table, or any other as ``module:function``."""
    module, _, function = ENGINES.get(name, name).partition(":")
    found: Engine = getattr(importlib.import_module(module), function)
    return found
