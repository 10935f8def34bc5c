"""Engines of the doctor that misbehave, for the benchmark that has to live with them."""

from __future__ import annotations

import os
import time
from typing import NoReturn

from ssmr_ident.experiments.campaign import Campaign


def breaks(campaign: Campaign, *, seed: int) -> NoReturn:
    raise ArithmeticError(f"no answer to {campaign.session.name}")


def dies(campaign: Campaign, *, seed: int) -> NoReturn:
    os._exit(7)


def computes_for_ever(campaign: Campaign, *, seed: int) -> NoReturn:
    while True:
        pass


def sleeps(campaign: Campaign, *, seed: int) -> None:
    time.sleep(3600.0)
