"""What is done to the robot, as the compiled loop takes it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


@dataclass(frozen=True, eq=False)
class Scenario:
    """One run of the robot's simulator.

    Parameters
    ----------
    experiment : str
        What it is called in messages and in the provenance of what comes out; it decides nothing.
    duration : float [s]
    offset : mapping
        Start away from rest: ``x``, ``y``, ``z`` [m], ``roll``, ``pitch``, ``yaw`` [rad]; with a flexible mast also
        ``sway_x``, ``sway_y`` [m]. ``brace_x`` is how far the front tires are strained forward and the rear ones
        backward against each other, ``brace_y`` the same for left and right [m]: what a light wheel that slid while
        the robot was pushed leaves behind. ``loaded`` is the share of the state in which a quick push to this place
        leaves friction, loops and relaxing branches of the tires; 0 is at rest. ``unseen`` is the share of the first
        acceleration that the sensor's low-pass has not met yet: 1 where what held the robot lets go at once. Belts
        begin in equilibrium with the tires.
    velocity : mapping
        Start velocities: ``x``, ``y``, ``z`` [m/s], ``roll``, ``pitch``, ``yaw`` [rad/s], ``sway_x``, ``sway_y`` [m/s].
    wheel_rates : (k, 2) float [rad/s]
        Wanted rates of the left and right wheels at multiples of ``wheel_rate_step``, held in between.
    wheel_rate_step : float [s]
    head : (m,) float [m]
        Travel of the pulling head at multiples of ``head_step``; empty when nothing pulls.
    head_step : float [s]
    direction : str
        ``lateral`` pulls along +y, ``longitudinal`` along -x (backwards, as in section 3.3).
    angle_deg : float or None [deg]
        Of the cable, from straight behind (0) to the left (90), where ``direction`` does not say it.
    height : float [m]
        Of the cable above the floor.
    wheels_gripping : tuple of int
        1 rear left, 2 front left, 3 front right, 4 rear right; the others stand on oiled plates.
    cable_stiffness, cable_damping : float or None
        None takes the robot's own.
    held : bool
        A fixture keeps the robot from driving off and turning while its wheels spin.
    """

    experiment: str
    duration: float
    offset: Mapping[str, float] = field(default_factory=dict)
    velocity: Mapping[str, float] = field(default_factory=dict)
    wheel_rates: Array = field(default_factory=lambda: np.zeros((1, 2)))
    wheel_rate_step: float = 1.0
    head: Array = field(default_factory=lambda: np.zeros(0))
    head_step: float = 1.0
    direction: str = "lateral"
    angle_deg: float | None = None
    height: float = 0.05
    wheels_gripping: tuple[int, ...] = (1, 2, 3, 4)
    cable_stiffness: float | None = None
    cable_damping: float | None = None
    held: bool = False

    @property
    def along(self) -> Array:
        """Unit vector of the pull in the robot's axes (x ahead, y to the left); (2,) float."""
        if self.angle_deg is not None:
            angle = math.radians(self.angle_deg)
            return np.array([-math.cos(angle), math.sin(angle)])
        return np.array([0.0, 1.0] if self.direction == "lateral" else [-1.0, 0.0])

    @property
    def pulled(self) -> bool:
        """Whether a cable pulls: a head travels, or stands and holds."""
        return len(self.head) > 0
