"""Wind tunnel: the laws integrated over a scenario."""

from ssmr_ident.simulate.scenarios import Scenario
from ssmr_ident.simulate.simulation import Simulation, simulate

__all__ = ["Scenario", "Simulation", "simulate"]
