"""What is built: a mast, a cable, and the choices that are the model's, not the robot's."""

from __future__ import annotations

from dataclasses import dataclass

from ssmr_ident.core.errors import InputError

WHEELS = ("rear_left", "front_left", "front_right", "rear_right")
AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Mast:
    """A point mass on horizontal springs, as the effect flexible_mast has it.

    Parameters
    ----------
    frequency_hz : float [Hz]
        With the platform held.
    mass : float [kg]
    height : float [m]
        Above the CoM.
    damping_ratio : float [1]
    """

    frequency_hz: float
    mass: float
    height: float
    damping_ratio: float


@dataclass(frozen=True)
class Cable:
    """A cable to a winch far away, horizontal; it pulls and never pushes.

    Parameters
    ----------
    direction : str
        ``lateral`` pulls along +y, ``longitudinal`` along -x.
    height : float [m]
        Above the unloaded contact points.
    speed : float [m/s]
        Of the winch.
    stiffness, damping : float [N/m], [N s/m]
    """

    direction: str
    height: float
    speed: float
    stiffness: float
    damping: float


@dataclass(frozen=True)
class Build:
    """Choices that are the model's, not the robot's.

    Parameters
    ----------
    tires : str
        ``patch``: a plate that lies flat on the floor, hung in a ball joint at the contact point; springs along the
        floor's axes, as the simulator's law has them. ``strut``: a sphere on springs along the body's axes.
        ``rigid``: a sphere without springs, the plainest robot on four wheels, for measuring speed.
    driven : bool
        Spheres turn on hinges, driven at the motors' speed (6.1); otherwise they stand still.
    friction : str
        ``grip``: nailed to the floor; ``cone``: Coulomb's law with mu_static in every direction.
    wheel_mass : float [kg]
        Of each wheel; taken from the chassis.
    step : float [s]
    plain : bool
        The engine's own defaults for contact, cone and solver instead of the stiffest: quicker and softer.
    """

    tires: str = "patch"
    driven: bool = False
    friction: str = "cone"
    wheel_mass: float = 0.035
    step: float = 1e-4
    plain: bool = False

    @property
    def pinned(self) -> bool:
        """Standing wheels that hold for good are tied to the floor: no contact, so nothing that creeps or rattles."""
        return self.friction == "grip" and not self.driven

    def __post_init__(self) -> None:
        if self.tires not in ("patch", "strut", "rigid"):
            raise InputError("mujoco: tires", f"is {self.tires!r}", "Give patch, strut or rigid")
        if self.friction not in ("grip", "cone"):
            raise InputError("mujoco: friction", f"is {self.friction!r}", "Give grip or cone")
        if self.tires == "patch" and self.driven:
            raise InputError("mujoco: tires", "a plate does not turn", "Give strut")
