"""The robots and rigs that cases are recorded with, and what a lab would know of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.physics.robot import Robot
from ssmr_ident.physics.sensor import Accelerometer

MASS, STEEL = 30.0, 1e6
_POINTS = np.array([[-0.15, 0.18, 0.0], [0.13, 0.18, 0.0], [0.13, -0.18, 0.0], [-0.15, -0.18, 0.0]])
_SENSOR = np.array([-0.2, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class Drawn:
    """A true robot and what a lab knows of it."""

    robot: Robot
    known: ParameterSet
    true: dict[str, float]


def draw_robot(random: np.random.Generator, biased: bool = False) -> Drawn:
    """A robot like the thesis', each number its own.

    Parameters
    ----------
    random : numpy Generator
    biased : bool
        What the lab knows is off by 1.5 to 2 of its standard deviations throughout, as honest knowledge may be.
    """
    u = random.uniform
    true: dict[str, float] = {
        "mass_kg": u(27.5, 32.0), "inertia_kg_m2.xx": u(1.05, 1.35), "inertia_kg_m2.yy": u(1.3, 1.65),
        "inertia_kg_m2.zz": u(0.85, 1.02), "inertia_kg_m2.xz": u(-0.09, -0.04),
        "tire.stiffness_x_N_m": u(2600, 4200), "tire.stiffness_y_N_m": u(16500, 21000),
        "tire.stiffness_z_N_m": u(66e3, 92e3), "tire.damping_x_N_s_m": u(35, 75), "tire.damping_y_N_s_m": u(28, 55),
        "tire.damping_z_N_s_m": u(60, 125), "tire.mu_static": u(0.78, 0.9), "height_m": u(0.226, 0.242),
        "accelerometer.bandwidth_hz": u(72, 88),
    }  # fmt: skip
    relative = {"tire.stiffness_x_N_m": 0.15, "tire.damping_x_N_s_m": 0.3, "tire.damping_y_N_s_m": 0.3}
    relative |= {"tire.damping_z_N_s_m": 0.3, "tire.stiffness_y_N_m": 0.1, "tire.stiffness_z_N_m": 0.1}
    spread = {key: share * true[key] for key, share in relative.items()}
    spread |= {f"inertia_kg_m2.{axis}": 0.08 * true[f"inertia_kg_m2.{axis}"] for axis in ("xx", "yy", "zz")}
    spread |= {"mass_kg": 0.3, "inertia_kg_m2.xz": 0.02, "tire.mu_static": 0.04, "height_m": 0.003}
    spread["accelerometer.bandwidth_hz"] = 10.0

    def known(key: str) -> float:
        away = random.choice([-1.0, 1.0]) * u(1.5, 2.0) if biased else float(np.clip(random.normal(), -2.0, 2.0))
        return float(f"{true[key] + away * spread[key]:.4g}")

    value = {key: known(key) for key in true}
    value["accelerometer.bandwidth_hz"] = 80.0  # as the sheet says
    n = true
    xz = n["inertia_kg_m2.xz"]
    robot = Robot(
        mass=n["mass_kg"],
        inertia=np.array(
            [[n["inertia_kg_m2.xx"], 0.0, xz], [0.0, n["inertia_kg_m2.yy"], 0.0], [xz, 0.0, n["inertia_kg_m2.zz"]]]
        ),
        contact_points=_POINTS - [0.0, 0.0, n["height_m"]],
        stiffness=np.array([n[f"tire.stiffness_{axis}_N_m"] for axis in "xyz"]),
        damping=np.array([n[f"tire.damping_{axis}_N_s_m"] for axis in "xyz"]),
        effective_mass=0.035, radius=0.111, mu_static=n["tire.mu_static"], mu_kinetic=n["tire.mu_static"],
        lambda_max=0.1, slip_coupling=1.0, motor_gain=6.0, cable_stiffness=STEEL, cable_damping=0.0,
        accelerometer=Accelerometer(_SENSOR, bandwidth_hz=n["accelerometer.bandwidth_hz"]),
    )  # fmt: skip
    return Drawn(robot, _robot_file(value, spread), true)


def _robot_file(value: dict[str, float], spread: dict[str, float]) -> ParameterSet:
    sources = {"mass_kg": "electronic scale", "tire.mu_static": "pull tests", "tire.mu_kinetic": "pull tests"}

    def of(key: str, unit: str, source: str = "") -> Estimate:
        return Estimate(value[key], float(f"{spread[key]:.3g}"), unit, source or sources.get(key, "earlier tests"))

    points = np.round(_POINTS - [0.0, 0.0, value["height_m"]], 5)
    entries: dict[str, Estimate] = {"mass_kg": of("mass_kg", "kg")}
    for axis in ("xx", "yy", "zz"):
        entries[f"inertia_kg_m2.{axis}"] = of(f"inertia_kg_m2.{axis}", "kg m^2", "CAD model")
    entries["inertia_kg_m2.xy"] = Estimate(0.0, 0.01, "kg m^2", "CAD model")
    entries["inertia_kg_m2.xz"] = of("inertia_kg_m2.xz", "kg m^2", "CAD model")
    entries["inertia_kg_m2.yz"] = Estimate(0.0, 0.01, "kg m^2", "CAD model")
    entries["contact_points_m"] = Estimate(points, 0.005, "m", "tape and scale")
    for kind, unit in (("stiffness", "N/m"), ("damping", "N s/m")):
        for axis in "xyz":
            key = f"tire.{kind}_{axis}_{unit.replace(' ', '_').replace('/', '_')}"
            entries[key] = of(key, unit, "earlier tests" if kind == "stiffness" else "guess")
    entries["tire.effective_mass_kg"] = Estimate(0.035, 0.02, "kg", "guess")
    entries["tire.radius_m"] = Estimate(0.111, 0.001, "m", "calliper")
    entries["tire.mu_static"] = of("tire.mu_static", "1")
    entries["tire.mu_kinetic"] = Estimate(value["tire.mu_static"], 0.04, "1", "pull tests")
    entries["tire.lambda_max"] = Estimate(0.1, 0.05, "1", "guess")
    entries["motor.gain_1_s"] = Estimate(6.0, 1.0, "1/s", "step response")
    entries["cable.stiffness_N_m"] = Estimate(STEEL, None, "N/m", "steel cable", fixed=True)
    sensor = Accelerometer()
    entries["accelerometer.position_m"] = Estimate(_SENSOR, 0.005, "m", "tape")
    entries["accelerometer.volts_zero"] = Estimate(sensor.volts_zero, 0.02, "V", "sheet")
    entries["accelerometer.volts_per_m_s2"] = Estimate(round(sensor.volts_per_m_s2, 8), 0.003, "V s^2/m", "sheet")
    entries["accelerometer.range_m_s2"] = Estimate(16.66, None, "m/s^2", "sheet", fixed=True)
    entries["accelerometer.bandwidth_hz"] = of("accelerometer.bandwidth_hz", "Hz", "sheet")
    for axis in "xyz":
        entries[f"accelerometer.polarity.{axis}"] = Estimate(1.0, None, "1")
    return ParameterSet("p3at-extended", entries)


@dataclass(frozen=True)
class DrawnRig:
    """A true rig and what a lab knows of it."""

    mass: float
    stiffness: float
    damping: float
    known: ParameterSet

    @property
    def true(self) -> dict[str, float]:
        return {"mass_kg": self.mass, "stiffness_N_m": self.stiffness, "damping_N_s_m": self.damping}


def draw_rig(random: np.random.Generator, biased: bool = False) -> DrawnRig:
    """A rig of some kilograms at some 8 Hz."""
    mass, stiffness, damping = random.uniform(6.0, 9.5), random.uniform(13e3, 23e3), random.uniform(22.0, 80.0)
    spread = {"mass_kg": 0.02 * mass, "stiffness_N_m": 0.1 * stiffness, "damping_N_s_m": 0.35 * damping}

    def known(key: str, value: float, unit: str) -> Estimate:
        away = random.choice([-1.0, 1.0]) * random.uniform(1.5, 2.0) if biased else random.normal()
        away = float(np.clip(away, -2.0, 2.0))
        return Estimate(float(f"{value + away * spread[key]:.4g}"), float(f"{spread[key]:.3g}"), unit, "earlier tests")

    entries: dict[str, Any] = {
        "mass_kg": known("mass_kg", mass, "kg"),
        "stiffness_N_m": known("stiffness_N_m", stiffness, "N/m"),
        "damping_N_s_m": known("damping_N_s_m", damping, "N s/m"),
        "accelerometer.range_m_s2": Estimate(39.2, None, "m/s^2", "sheet", fixed=True),
        "accelerometer.bandwidth_hz": Estimate(500.0, None, "Hz", "sheet", fixed=True),
    }
    return DrawnRig(mass, stiffness, damping, ParameterSet("rig", entries))
