"""Effects drawn at random that act on the robot's body, its sensors, its cable or its grip."""

from __future__ import annotations

import numpy as np

from ssmr_proof.drawn.hidden import Change, Hidden
from ssmr_proof.drawn.springs import graded
from ssmr_proof.plant.robot_model import Frame, Turned


def frame(random: np.random.Generator, strength: float) -> Hidden:
    """A mast: a mass on two slides, or at the end of a rod."""
    shape = str(random.choice(["carriage", "rod"]))
    mass, hertz = graded(strength, 0.35, 3.0), float(random.uniform(7.5, 13.0))
    height, ratio = float(random.uniform(0.28, 0.36)), float(random.uniform(0.02, 0.05))
    how = "part of the robot's mass sways above the platform; total mass and inertia hold with it locked"
    parameters = {"f_mast_Hz": hertz, "mass_kg": mass, "height_above_com_m": height, "damping_ratio": ratio}
    change = Change(frame=Frame(shape, hertz, mass, height, ratio))
    return Hidden("flexible_mast", shape, parameters, how, change, strength)


def askew(random: np.random.Generator, strength: float) -> Hidden:
    """The cube of accelerometers is turned."""
    direction = random.normal(size=3)
    angles = graded(strength, 0.035, 0.16) * direction / np.abs(direction).max()
    parameters = {f"angle_{axis}_rad": float(angle) for axis, angle in zip("xyz", angles, strict=True)}
    change = Change(turned=Turned(*map(float, angles)))
    return Hidden("sensor_misalignment", "turned cube", parameters, "the sensor's axes are turned", change, strength)


def slow_sensor(random: np.random.Generator, strength: float) -> Hidden:
    """The robot's accelerometer is slower than its sheet."""
    hertz = graded(strength, 16.0, 8.0)
    how = "second-order Butterworth low-pass in the sensor"
    return Hidden("sensor_bandwidth", "Butterworth", {"bandwidth_hz": hertz}, how, Change(bandwidth_hz=hertz), strength)


def slow_rig_sensor(random: np.random.Generator, strength: float) -> Hidden:
    """A rig's accelerometer is slower than its sheet."""
    hertz = graded(strength, 220.0, 30.0)
    how = "second-order Butterworth low-pass in the sensor"
    return Hidden("sensor_bandwidth", "Butterworth", {"bandwidth_hz": hertz}, how, Change(bandwidth_hz=hertz), strength)


def off_centre(random: np.random.Generator, strength: float) -> Hidden:
    """The centre of mass is elsewhere."""
    angle, reach = random.uniform(0.0, 2.0 * np.pi), graded(strength, 0.04, 0.09)
    x, y = float(reach * np.cos(angle)), float(reach * np.sin(angle))
    how = "the centre of mass lies (offset_x, offset_y) from where the file has it"
    return Hidden("com_offset", "offset", {"offset_x_m": x, "offset_y_m": y}, how, Change(offset_m=(x, y)), strength)


def lifted(random: np.random.Generator, strength: float) -> Hidden:
    """Pushed so hard that wheels leave the floor; every plant's wheels can, the others are not pushed so hard."""
    loud = graded(strength, 2.95, 3.5)
    how = "the robot is let go from so far that wheels leave the floor, lose their grip and land"
    return Hidden("wheel_lift", "unilateral contact", {}, how, Change(loud=loud), strength)


def soft_cable(random: np.random.Generator, strength: float) -> Hidden:
    """A cable that stretches."""
    k = graded(strength, 4e5, 4e4)
    how = "the cable is a spring K_cable in series"
    return Hidden("cable_compliance", "series spring", {"K_cable_N_m": k}, how, Change(cable_stiffness=k), strength)


def drifting_cell(random: np.random.Generator, strength: float) -> Hidden:
    """A load cell whose zero wanders."""
    rate = float(random.choice([-1.0, 1.0])) * graded(strength, 0.2, 2.5)
    how = "the load cell's zero wanders linearly in time"
    return Hidden("load_cell_drift", "zero", {"zero_drift_N_s": rate}, how, Change(zero_drift=rate), strength)


def falling_friction(random: np.random.Generator, strength: float) -> Hidden:
    """Stribeck."""
    share, speed = 1.0 - graded(strength, 0.1, 0.3), float(random.uniform(2e-3, 4e-3))
    how = "mu(u) = mu_k + (mu_s - mu_k) exp(-(u/v_s)^2), the file says mu_k = mu_s"
    parameters = {"kinetic_share": share, "stribeck_velocity_m_s": speed}
    return Hidden("stribeck", "Gaussian", parameters, how, Change(kinetic_share=share, slip_speed=speed), strength)


def light_grip(random: np.random.Generator, strength: float) -> Hidden:
    """Friction that falls with the load."""
    n = graded(strength, 0.2, 0.5)
    how = "mu(N) = mu (N/N_0)^-n, N_0 = m g/4"
    change = Change(load_exponent=n)
    return Hidden("load_sensitive_friction", "power law", {"exponent": n}, how, change, strength)


def clipped(random: np.random.Generator, strength: float) -> Hidden:
    """A sensor that clips; the level is set where the recordings are made, as a share of their largest value."""
    share = graded(strength, 0.7, 0.45)
    how = "the sensor clips at ± its range"
    return Hidden("sensor_saturation", "clipped", {}, how, Change(range=share), strength)


def coupled(random: np.random.Generator, strength: float) -> Hidden:
    """Nothing beyond a rigid robot, but the session asks for pure rotations."""
    how = "roll and lateral, pitch and longitudinal motion are coupled through the contact points"
    return Hidden("translation_coupling", "rigid body", {}, how, Change(), strength)
