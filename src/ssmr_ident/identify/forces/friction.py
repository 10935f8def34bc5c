"""Friction coefficients from pulls (section 3.3)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.forces.sawtooth import Pull, Tooth
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.statics import rest_loads

Array = np.ndarray


@dataclass(frozen=True)
class Friction(Shown):
    """Coefficients of one pull.

    Parameters
    ----------
    mu_static, mu_static_std : float
        From the peaks of teeth, or from the level where the contact slides without teeth.
    mu_kinetic, mu_kinetic_std : float
        From the troughs, or from the level.
    static_over_teeth, kinetic_over_teeth : (t,) float
        One value per tooth; empty without stick-slip.
    load : float [N]
        On the gripping wheels while sliding.
    """

    mu_static: float
    mu_static_std: float
    mu_kinetic: float
    mu_kinetic_std: float
    static_over_teeth: Array
    kinetic_over_teeth: Array
    load: float

    def __str__(self) -> str:
        return (
            f"mu_s = {self.mu_static:.3f} ± {self.mu_static_std:.3f}, mu_k = {self.mu_kinetic:.3f} ± "
            f"{self.mu_kinetic_std:.3f} under {self.load:.4g} N"
        )


def gripping_load(robot: Robot, gripping: tuple[int, ...], direction: str, height: float, force: float) -> float:
    """Load on the gripping wheels [N] while the cable pulls with ``force`` [N].

    Parameters
    ----------
    gripping : tuple of int
        Wheels 1 to 4 as in Table 5.1.
    direction : str
        ``lateral`` (to the left, +y) or ``longitudinal`` (backwards, −x).
    height : float [m]
        Of the cable above the floor.

    Notes
    -----
    At rest by (2.24); the pull at a height shifts force·height/(track or wheelbase) to the side it pulls to.
    """
    at_rest = rest_loads(robot)
    axis, sign = (1, 1.0) if direction == "lateral" else (0, -1.0)
    place = sign * robot.contact_points[:, axis]
    centred = place - place.mean()
    shift = force * height * centred / float(centred @ centred)
    loads = np.maximum(at_rest + shift, 0.0)
    return float(sum(loads[wheel - 1] for wheel in gripping))


def friction_of(
    pull: Pull, load: float | Callable[[float], float], load_std: float = 0.0, zero: float = 0.0
) -> Friction:
    """Coefficients of a pull.

    Parameters
    ----------
    pull : Pull
    load : float [N], or callable
        On the gripping wheels; a callable gives it at a pulling force, which matters where one side or one wheel
        grips, for the pull itself then loads or unloads it. Each tooth is taken over the load at its own force.
    load_std : float [N]
    zero : float [N]
        What the load cell reads without a pull.

    Notes
    -----
    A wheel that lets go early bounces, and small teeth follow before the next full one. They never reach µ_s·N,
    so only teeth whose drop is at least half of the largest fifth's count for the means.
    """
    at = load if callable(load) else (lambda _force: load)
    if pull.stick_slip:
        teeth = full_teeth(pull)
        peaks = np.array([(tooth.peak - zero) / at(tooth.peak - zero) for tooth in teeth])
        troughs = np.array([(tooth.trough - zero) / at(tooth.trough - zero) for tooth in teeth])
        count = np.sqrt(len(peaks))
        upper, lower = float(np.mean(peaks)), float(np.mean(troughs))
        scatter = (float(np.std(peaks, ddof=1)), float(np.std(troughs, ddof=1))) if len(peaks) > 1 else (np.inf, np.inf)
        upper_std, lower_std = scatter[0] / count, scatter[1] / count
        mean_load = at(float(np.mean([tooth.peak for tooth in teeth])) - zero)
    else:
        peaks = troughs = np.empty(0)
        mean_load = at(pull.level - zero)
        upper = lower = (pull.level - zero) / mean_load
        upper_std = lower_std = pull.level_std / mean_load
    relative = load_std / mean_load
    return Friction(
        mu_static=upper,
        mu_static_std=float(np.hypot(upper_std, upper * relative)),
        mu_kinetic=lower,
        mu_kinetic_std=float(np.hypot(lower_std, lower * relative)),
        static_over_teeth=peaks,
        kinetic_over_teeth=troughs,
        load=mean_load,
    )


def full_teeth(pull: Pull) -> tuple[Tooth, ...]:
    """Teeth whose drop is at least half of what the largest fifth of drops have on average."""
    drops = np.array([tooth.peak - tooth.trough for tooth in pull.teeth])
    largest = float(np.mean(np.sort(drops)[-max(1, len(drops) // 5) :]))
    return tuple(tooth for tooth, drop in zip(pull.teeth, drops, strict=True) if drop >= 0.5 * largest)
