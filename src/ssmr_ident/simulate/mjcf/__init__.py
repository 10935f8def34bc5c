"""The robot as a MuJoCo model; nothing here needs MuJoCo."""

from ssmr_ident.simulate.mjcf.build import AXES, WHEELS, Build, Cable, Mast
from ssmr_ident.simulate.mjcf.robot import mjcf

__all__ = ["AXES", "WHEELS", "Build", "Cable", "Mast", "mjcf"]
