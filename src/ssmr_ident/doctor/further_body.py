"""A body that a network's file has not, found as a mass that rides on one of its bodies: the network with it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from ssmr_ident.core.parameter import FITTED, Estimate, ParameterSet
from ssmr_ident.estimate.node import RIDER, Member
from ssmr_ident.estimate.values import Fit
from ssmr_ident.physics.network import BODY_KEY, SPRING_KEYS, network_from_parameters

Array = np.ndarray


STEP = 1e-4
"""Of differences, in coordinates of the fit."""


def riders(fit: Fit) -> tuple[Member, ...]:
    """Further bodies of a network; none of a rig, whose file has no place for them."""
    return tuple(m for m in fit.node.members if m.linear == RIDER and m.element)


def with_further_bodies(fit: Fit, known: ParameterSet) -> ParameterSet:
    """A network's parameters, those of the fit, with a body and a spring more for each mass that rides."""
    for member in riders(fit):
        rotary = fit.node.layout.rotary
        body, host = f"on_{member.element}", f"bodies.{member.element}.{BODY_KEY[rotary]}"
        mass, left, damping, stiffness = _with_std(fit, partial(_numbers, host=host))
        unit = known[host].unit
        units = [known[f"springs.{fit.node.layout.springs[0]}.{key}"].unit for key in SPRING_KEYS[rotary]]
        new = {
            host: replace(known[host], value=left[0], std=left[1], source=FITTED),
            f"bodies.{body}.{BODY_KEY[rotary]}": Estimate(*mass, unit, FITTED),
            f"springs.{body}.{SPRING_KEYS[rotary][1]}": Estimate(*stiffness, units[1], FITTED),
            f"springs.{body}.{SPRING_KEYS[rotary][0]}": Estimate(*damping, units[0], FITTED),
        }
        known = known.updated(new, between={**known.between, body: (member.element, body)})
    return known


def mode_parameters(fit: Fit, member: Member) -> dict[str, Estimate]:
    """Mass, frequency with the other body held, and damping ratio of a further body."""
    host = f"bodies.{member.element}.{BODY_KEY[fit.node.layout.rotary]}"
    unit = next(c.unit for c in fit.node.baseline if c.name == host)
    mass, *_ = _with_std(fit, partial(_numbers, host=host))
    hz, ratio = _with_std(fit, lambda v: (v["rider_Hz"], v["rider_ratio"]))
    return {
        "mass_kg": Estimate(*mass, unit, FITTED),
        "f_mast_Hz": Estimate(*hz, "Hz", FITTED),
        "damping_ratio": Estimate(*ratio, "1", FITTED),
    }


def shapes_told(after: ParameterSet) -> str:
    """The modes of a network in a sentence."""
    network = network_from_parameters(after)
    hz, ratio, shapes = network.modes()
    told = [
        f"{f:.4g} Hz ({100 * xi:.2g} %): "
        + ", ".join(f"{n} {v:.2g}" for n, v in zip(network.layout.bodies, s, strict=True))
        for f, xi, s in zip(hz, ratio, shapes.T, strict=True)
    ]
    return f"Modes, damping ratios and shapes with it are {'; '.join(told)}."


def _numbers(values: Mapping[str, float], host: str) -> tuple[float, float, float, float]:
    share, turning = values["rider_share"], 2.0 * math.pi * values["rider_Hz"]
    mass = share * values[host]
    return mass, values[host] - mass, 2.0 * values["rider_ratio"] * turning * mass, turning**2 * mass


def _with_std(fit: Fit, numbers: Callable[[Mapping[str, float]], tuple[float, ...]]) -> list[tuple[float, float]]:
    """Numbers of a fit's values, each with its standard deviation to first order."""
    names = [c.name for c in fit.node.coordinates]

    def at(point: Array) -> Array:
        return np.array(numbers(dict(zip(names, fit.node.values(point).tolist(), strict=True))))

    eye = STEP * np.eye(len(fit.point))
    slopes = np.array([(at(fit.point + own) - at(fit.point - own)) / (2.0 * STEP) for own in eye])
    std = np.sqrt(np.maximum(np.einsum("ki,kl,li->i", slopes, fit.covariance, slopes), 0.0))
    return list(zip(at(fit.point).tolist(), std.tolist(), strict=True))
