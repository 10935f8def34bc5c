"""Random robots, and what their users know of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.physics.robot import Robot, robot_from_parameters

SPREAD = {
    # value of a typical robot, share by which robots differ, what the user honestly does not know (as in the field)
    "mass_kg": (30.0, 0.06, 0.3, "kg"),
    "inertia_kg_m2.xx": (1.2, 0.08, 0.096, "kg m^2"),
    "inertia_kg_m2.yy": (1.45, 0.10, 0.116, "kg m^2"),
    "inertia_kg_m2.zz": (0.95, 0.06, 0.076, "kg m^2"),
    "inertia_kg_m2.xy": (0.0004, 0.0, 0.01, "kg m^2"),
    "inertia_kg_m2.xz": (-0.068, 0.2, 0.02, "kg m^2"),
    "inertia_kg_m2.yz": (-0.0012, 0.0, 0.01, "kg m^2"),
    "tire.stiffness_x_N_m": (3300.0, 0.15, 495.0, "N/m"),
    "tire.stiffness_y_N_m": (18500.0, 0.08, 1850.0, "N/m"),
    "tire.stiffness_z_N_m": (77000.0, 0.08, 7700.0, "N/m"),
    "tire.damping_x_N_s_m": (48.0, 0.3, 14.4, "N s/m"),
    "tire.damping_y_N_s_m": (42.0, 0.25, 12.6, "N s/m"),
    "tire.damping_z_N_s_m": (88.0, 0.2, 26.0, "N s/m"),
    "tire.mu_static": (0.83, 0.05, 0.04, "1"),
}
HEIGHT, CONTACT_STD = 0.2325, 0.005  # m
ARMS = ((-0.15, 0.18), (0.13, 0.18), (0.13, -0.18), (-0.15, -0.18))


def draw_robot(random: np.random.Generator) -> tuple[Robot, ParameterSet, np.ndarray]:
    """A robot, its file, and the gains of its three accelerometers over what the file says.

    The file's values are drawn about the truth with the standard deviations that the file states; a tire is passive,
    so a file or a robot with a damping below a fifth of the usual is drawn again. The gains differ from 1 by what
    the file leaves open (2 %), axis by axis.

    Returns
    -------
    Robot, ParameterSet, (3,) float
    """
    true: dict[str, float] = {}
    told: dict[str, Estimate] = {}
    for path, (typical, share, std, unit) in SPREAD.items():
        floor = -np.inf if path[-3:] in (".xy", ".xz", ".yz") else 0.2 * typical
        value = guess = -np.inf
        while value <= floor or guess <= floor:
            value = typical * (1.0 + share * random.standard_normal())
            guess = value + std * random.standard_normal()
        true[path], told[path] = float(value), Estimate(float(f"{guess:.4g}"), std, unit)
    told["tire.mu_kinetic"] = told["tire.mu_static"]
    true["tire.mu_kinetic"] = true["tire.mu_static"]
    height = HEIGHT + 0.006 * random.standard_normal()
    points = np.array([[x, y, -height] for x, y in ARMS])
    told["contact_points_m"] = Estimate(points.round(4), CONTACT_STD, "m")
    shift = CONTACT_STD * random.standard_normal(3)
    place = np.array([-0.2, 0.0, 0.0])
    told |= {
        "tire.effective_mass_kg": Estimate(0.035, 0.02, "kg"),
        "tire.radius_m": Estimate(0.111, 0.001, "m"),
        "tire.lambda_max": Estimate(0.1, 0.05, "1"),
        "motor.gain_1_s": Estimate(6.0, 1.0, "1/s"),
        "cable.stiffness_N_m": Estimate(1e6, None, "N/m", "steel cable", fixed=True),
        "accelerometer.position_m": Estimate(place, 0.005, "m"),
        "accelerometer.volts_zero": Estimate(2.6, 0.02, "V"),
        "accelerometer.volts_per_m_s2": Estimate(0.15006, 0.003, "V s^2/m"),
        "accelerometer.range_m_s2": Estimate(16.66, None, "m/s^2", fixed=True),
        "accelerometer.bandwidth_hz": Estimate(80.0, 10.0, "Hz"),
        **{f"accelerometer.polarity.{axis}": Estimate(1.0, None, "1") for axis in "xyz"},
    }
    file = ParameterSet("p3at-extended", told)
    real = ParameterSet("real", told).updated({path: Estimate(value) for path, value in true.items()})
    real = real.updated({"contact_points_m": Estimate(points + shift)})
    robot = robot_from_parameters(real)
    sensor = replace(
        robot.accelerometer,
        position=place + 0.005 * random.standard_normal(3),
        bandwidth_hz=float(np.clip(80.0 + 10.0 * random.standard_normal(), 50.0, 110.0)),
    )
    gains = 1.0 + 0.02 * random.standard_normal(3)
    return replace(robot, accelerometer=sensor), file, gains


def true_values(robot: Robot) -> dict[str, float]:
    """The robot's numbers by the file's paths, and how far its contacts lie from where the file has them."""
    found = {"mass_kg": robot.mass, "tire.mu_static": robot.mu_static, "height_m": robot.height}
    for row, column, name in ((0, 0, "xx"), (1, 1, "yy"), (2, 2, "zz"), (0, 2, "xz"), (0, 1, "xy"), (1, 2, "yz")):
        found[f"inertia_kg_m2.{name}"] = float(robot.inertia[row, column])
    aside = robot.contact_points[:, :2].mean(axis=0) - np.mean(ARMS, axis=0)
    found |= {f"contact_shift_{axis}_m": value for axis, value in zip("xy", aside, strict=True)}
    for index, axis in enumerate("xyz"):
        found[f"tire.stiffness_{axis}_N_m"] = float(robot.stiffness[index])
        found[f"tire.damping_{axis}_N_s_m"] = float(robot.damping[index])
    return {name: float(value) for name, value in found.items()}
