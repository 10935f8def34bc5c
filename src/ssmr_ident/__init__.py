"""System identification for accelerometer and force logs."""

__version__ = "0.1.0"
