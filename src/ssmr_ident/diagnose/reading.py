"""What a drifting parameter says, in words."""

from __future__ import annotations

import numpy as np

from ssmr_ident.diagnose.evidence import Drift

Array = np.ndarray

CLEAR = 0.05
"""p-value, over all drifts that were looked at, below which one is read (Bonferroni)."""

LAWS = {
    ("damping", "amplitude", "1/A", 1): "damping grows as 1/amplitude: dry friction",
    ("damping", "amplitude", "A", 1): "damping grows with the amplitude: quadratic damping, or friction that sticks",
    ("damping", "amplitude", "A", -1): "damping falls with the amplitude: dry friction, or losses that saturate",
    ("damping", "amplitude", "1/A", -1): "damping vanishes in small motions: friction that sticks, or play",
    ("stiffness", "amplitude", "A^2", 1): "stiffness grows with the amplitude squared: hardening",
    ("stiffness", "amplitude", "A^2", -1): "stiffness falls with the amplitude squared: softening",
    ("stiffness", "amplitude", "1/A", -1): "stiffness is missing in small motions, as below a threshold: play",
    ("stiffness", "amplitude", "1/A", 1): "small motions are stiffer: friction that sticks, or hysteresis",
    ("stiffness", "travel", "A", 1): "stiffness grows with the travel: hardening",
    ("stiffness", "travel", "A", -1): "stiffness falls with the travel: softening, hysteresis or beginning slip",
    ("stiffness", "load", "A", 1): "stiffness grows with the load: hardening, or play that is taken up",
    ("stiffness", "load", "A", -1): "stiffness falls with the load: softening, hysteresis or beginning slip",
    ("stiffness", "pulling speed", "A", 1): "faster pulls are stiffer: viscoelastic relaxation",
    ("stiffness", "speed", "A", 1): "faster motions are stiffer: viscoelastic relaxation",
    ("mu", "pulling speed", "A", -1): "friction falls with the speed: Stribeck",
    ("mu", "load", "A", -1): "friction falls with the load",
}
SHAPES = {"1/A": lambda a: 1.0 / a, "A": lambda a: a, "A^2": lambda a: a**2}


def reading(drift: Drift, looks: int) -> str:
    """The law that a drift follows best; empty where it is not clear.

    Parameters
    ----------
    drift : Drift
    looks : int
        Number of drifts that were looked at.
    """
    if drift.p_value * looks >= CLEAR:
        return ""
    parameter, along, value = drift.parameter, drift.along, drift.value
    kind = next((kind for kind in ("stiffness", "damping") if kind in parameter), "mu")
    if along in ("side", "direction"):
        share = 200.0 * abs(value[1] - value[0]) / (value[1] + value[0])
        where = "the two sides" if along == "side" else "the two directions of motion"
        return f"{kind} differs by {share:.0f} % between {where}: an asymmetry"
    if along == "time":
        return f"{kind} changes in the course of a recording"
    shapes = sorted({shape for k, axis, shape, _ in LAWS if (k, axis) == (kind, along)})
    if not shapes:
        return f"{kind} changes with the {along}"
    fits = {shape: _slope(SHAPES[shape](drift.position), value, drift.std) for shape in shapes}
    shape = min(fits, key=lambda name: fits[name][1])
    sign = 1 if fits[shape][0] > 0 else -1
    return LAWS.get((kind, along, shape, sign), f"{kind} {'grows' if sign > 0 else 'falls'} with the {along}")


def _slope(x: Array, value: Array, std: Array) -> tuple[float, float]:
    """Slope of a weighted straight line, and the chi-square that it leaves."""
    design = np.column_stack([np.ones(len(x)), x / np.max(np.abs(x))]) / std[:, None]
    solution, *_ = np.linalg.lstsq(design, value / std, rcond=None)
    return float(solution[1]), float(np.sum((value / std - design @ solution) ** 2))
