"""The robot as plain numbers, from a parameter set."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.errors import Impossible, InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.physics.sensor import Accelerometer

GRAVITY = 9.8  # m/s^2, the thesis' value
SLIDING_SPEED = 0.3
"""Speed [m/s] over which rubber loses the difference of mu_static and mu_kinetic, where a file does not say."""

_AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class Robot:
    """A four-wheeled skid-steering robot; body frame at the CoM, x forward, y left, z up.

    Parameters
    ----------
    mass : float [kg]
    inertia : (3, 3) float [kg m^2]
        About the CoM, body axes.
    contact_points : (4, 3) float [m]
        From the CoM, in any order (Table 5.1: rear left, front left, front right, rear right); a wheel with
        y > 0 turns with the left motor.
    stiffness, damping : (3,) float [N/m], [N s/m]
        Of one tire along x, y, z.
    effective_mass : float [kg]
        Mass m_t that moves with the contact patch, eq (4.9).
    radius : float [m]
    mu_static, mu_kinetic, lambda_max : float
        Relay friction (6.4) and the slip at which grip is used up (4.10)-(4.12).
    slip_coupling : float
        Share of (4.10)-(4.12) that acts: 1, or 0 where the file knows no lambda_max.
    motor_gain : float [1/s]
        Of eq (6.1).
    cable_stiffness, cable_damping : float [N/m], [N s/m]
    accelerometer : Accelerometer
    sliding_speed : float [m/s]
        Over which friction falls from mu_static to mu_kinetic while a contact slides along both axes together;
        0 keeps the thesis' relay, axis by axis.
    contact : str
        ``printed_6_4``: (6.4) and N >= 0 (4.15) to the letter; ``relay``: one per axis that lands on mu_k N; ``cone``:
        Coulomb's. Empty where the file does not choose, and each experiment takes its usual one.
    """

    mass: float
    inertia: np.ndarray
    contact_points: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    effective_mass: float
    radius: float
    mu_static: float
    mu_kinetic: float
    lambda_max: float
    slip_coupling: float
    motor_gain: float
    cable_stiffness: float
    cable_damping: float
    accelerometer: Accelerometer
    sliding_speed: float = 0.0
    contact: str = ""

    @property
    def height(self) -> float:
        """Height of the CoM above the unloaded contact points [m]."""
        return -float(self.contact_points[:, 2].mean())

    @property
    def half_track(self) -> float:
        """c: half the distance between left and right contacts [m]."""
        return float(np.abs(self.contact_points[:, 1]).mean())

    def sliding_together(self) -> Robot:
        """A robot whose contacts slide along both axes together (Coulomb's cone), unless its file chooses a relay."""
        return self if self.contact or self.sliding_speed > 0.0 else replace(self, sliding_speed=SLIDING_SPEED)

    def with_contact(self, contact: str) -> Robot:
        """A robot under a chosen law of its contacts."""
        speed = (self.sliding_speed or SLIDING_SPEED) if contact == "cone" else 0.0
        return replace(self, contact=contact, sliding_speed=speed)

    def with_changes(self, **changes: object) -> Robot:
        """A copy with some fields replaced."""
        return replace(self, **changes)  # type: ignore[arg-type]


def robot_from_parameters(parameters: ParameterSet) -> Robot:
    """Build a robot from a parameter file's numbers.

    Raises
    ------
    InputError
        A key is missing.
    Impossible
        The inertia is not that of a body.
    """

    def need(path: str) -> float:
        if path not in parameters:
            raise InputError(
                f"{parameters.file or parameters.name}: {path}",
                "is missing",
                f"A robot needs it; write {path.rsplit('.', 1)[-1]}: {{value: …, std: …}}",
            )
        return float(parameters[path].value)

    if "contact_points_m" not in parameters:
        raise InputError(f"{parameters.file or parameters.name}: contact_points_m", "is missing", "Give four xyz rows")
    points = np.asarray(parameters["contact_points_m"].value, dtype=float)
    inertia = np.array([[need(f"inertia_kg_m2.{''.join(sorted(i + j))}") for j in _AXES] for i in _AXES])
    eigenvalues = np.linalg.eigvalsh(inertia)
    if eigenvalues[0] <= 0:
        raise Impossible(
            f"{parameters.file or parameters.name}: inertia_kg_m2",
            f"has principal moments {np.round(eigenvalues, 4).tolist()}, expected all above 0",
            "Check signs and units of the tensor",
        )
    mass = need("mass_kg")
    cable = parameters.number("cable.stiffness_N_m", 1e6)
    mu_static = need("tire.mu_static")
    robot = Robot(
        mass=mass,
        inertia=inertia,
        contact_points=points,
        stiffness=np.array([need(f"tire.stiffness_{axis}_N_m") for axis in _AXES]),
        damping=np.array([need(f"tire.damping_{axis}_N_s_m") for axis in _AXES]),
        effective_mass=parameters.number("tire.effective_mass_kg", 0.0),
        radius=need("tire.radius_m"),
        mu_static=mu_static,
        mu_kinetic=parameters.number("tire.mu_kinetic", mu_static),
        lambda_max=parameters.number("tire.lambda_max", 1.0),
        slip_coupling=float("tire.lambda_max" in parameters),
        motor_gain=parameters.number("motor.gain_1_s", 6.0),
        cable_stiffness=cable,
        # thesis section 4: D_cable = 4 sqrt(m K_cable), so that the steel cable does not ring
        cable_damping=parameters.number("cable.damping_N_s_m", 4.0 * float(np.sqrt(mass * cable))),
        accelerometer=accelerometer_from_parameters(parameters),
        sliding_speed=parameters.number("tire.sliding_speed_m_s", 0.0),
    )
    contact = contact_named(parameters)
    return robot.with_contact(contact) if contact else robot


def contact_named(parameters: ParameterSet) -> str:
    """The law of contact that a parameter file names, by itself or by its speed of sliding; empty for none."""
    speed = parameters.get("tire.sliding_speed_m_s")
    by_speed = "" if speed is None else "cone" if float(speed.value) > 0.0 else "relay"
    return parameters.choices.get("tire.contact", by_speed)


def accelerometer_from_parameters(parameters: ParameterSet) -> Accelerometer:
    """The accelerometer block; the thesis' sensor for what the file leaves out."""
    default = Accelerometer()
    position = parameters.get("accelerometer.position_m")
    return Accelerometer(
        position=default.position if position is None else np.asarray(position.value, dtype=float),
        volts_zero=parameters.number("accelerometer.volts_zero", default.volts_zero),
        volts_per_m_s2=parameters.number("accelerometer.volts_per_m_s2", default.volts_per_m_s2),
        range_m_s2=parameters.number("accelerometer.range_m_s2", default.range_m_s2),
        bandwidth_hz=parameters.number("accelerometer.bandwidth_hz", default.bandwidth_hz),
        polarity=np.array([parameters.number(f"accelerometer.polarity.{axis}", 1.0) for axis in _AXES]),
        gain=np.array([parameters.number(f"accelerometer.gain.{axis}", 1.0) for axis in _AXES]),
    )
