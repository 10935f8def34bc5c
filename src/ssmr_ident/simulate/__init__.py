"""Wind tunnel: the laws integrated over a scenario."""

from ssmr_ident.simulate.simulation import Simulation, simulate

__all__ = ["Simulation", "simulate"]
