"""Section 3.3: are the forces of the testing machine what the identified numbers give when the tests are simulated?"""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from ssmr_ident.experiments.pull import ROPE_STIFFNESS, pull
from ssmr_ident.identify.forces.curves import load_curve
from ssmr_ident.identify.forces.friction import friction_of, gripping_load
from ssmr_ident.identify.forces.sawtooth import take_apart
from ssmr_ident.identify.forces.stiffness import in_series
from ssmr_ident.physics.robot import Robot
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.bench import compress_wheel, drag_wheel
from thesis2012.rows import Row

RATE = 100.0
WEIGHT = 225.0  # N, of the platform, over which the thesis takes its coefficients
RUBBER = 18000.0  # N/m along x taken as along y: the tire behind the belt of (4.14)


def force_rows(robot: Robot, platform: Robot) -> list[Row]:
    """Rows of section 3.3.

    Parameters
    ----------
    robot : Robot
        With frame and laptop.
    platform : Robot
        Alone, 225 N.
    """
    return [
        *_longitudinal(platform), *_lateral(platform), _knee(platform), _rope(robot), _steel(robot), _release(robot),
        *_hardening(robot), _compression(robot),
    ]  # fmt: skip


def _longitudinal(platform: Robot) -> list[Row]:
    scenario = pull("longitudinal", 1.0, 60.0)
    result = simulate(platform, scenario, RATE)
    taken = take_apart(result["head"], result["force"])
    belts = {"motor_belt": {"K_b_N_m": 3000.0}}
    rubber = platform.with_changes(stiffness=platform.stiffness * np.array([RUBBER / platform.stiffness[0], 1.0, 1.0]))
    soft = simulate(rubber, scenario, RATE, effects=belts)
    slope, with_belts = taken.first.slope, take_apart(soft["head"], soft["force"]).first.slope
    roped = simulate(rubber, pull("longitudinal", 1.0, 60.0, "rope"), RATE, effects=belts)
    with_rope = take_apart(roped["head"], roped["force"]).first.slope
    expected = 2.0 * in_series(3000.0, 2.0 * RUBBER)
    return [
        Row(
            "longitudinal_teeth", "3.3", "A longitudinal pull is a saw-tooth", f"{len(taken.teeth)} teeth in 60 mm",
            "teeth", len(taken.teeth) >= 2,
        ),
        Row(
            "longitudinal_ramp", "3.3", "Its ramps rise by 5–7 kN/m, with K_x = 3 kN/m in each of four tires (5.3)",
            f"{slope / 1e3:.1f} kN/m", "5–7 kN/m", 5e3 < slope < 7e3,
            "(3.8) counts two belts, (5.3) and the simulator four wheels of the same K_x: the sum is twice too stiff",
        ),
        Row(
            "belts", "3.3", "K_measured = 2·K_belt (3.8), each belt of 3 kN/m in series with two tires (4.14)",
            f"{with_belts / 1e3:.2f} kN/m, closed form {expected / 1e3:.2f}; with the rope {with_rope / 1e3:.2f} kN/m, "
            f"closed form {in_series(expected, ROPE_STIFFNESS) / 1e3:.2f}",
            "5–7 kN/m without the rope",
            5e3 < with_belts < 7e3 and abs(with_belts / expected - 1.0) < 0.05,
            "the effect motor_belt, behind tires as stiff along x as along y",
        ),
    ]  # fmt: skip


def _lateral(platform: Robot) -> list[Row]:
    rows = []
    for floor, mu, low, high in (("concrete", 0.86, 180.0, 200.0), ("carpet", 0.98, 200.0, 224.0)):
        standing = platform.with_changes(mu_static=mu, mu_kinetic=0.8 * mu)
        result = simulate(standing, pull("lateral", 1.0, 16.0), RATE)
        taken = take_apart(result["head"], result["force"])
        rows.append(
            Row(
                f"lateral_{floor}", "3.3", f"A lateral pull on {floor} is a saw-tooth with such peaks",
                f"{len(taken.teeth)} teeth, highest {taken.peak:.0f} N", f"{low:.0f}–{high:.0f} N",
                len(taken.teeth) > 3 and low <= taken.peak <= high,
            )
        )  # fmt: skip
        load = gripping_load(standing, (1, 2, 3, 4), "lateral", 0.05, taken.level)
        mean, top = friction_of(taken, load).mu_static, taken.peak / WEIGHT
        rows.append(
            Row(
                f"mu_{floor}", "3.3", f"µ_s on {floor} from the peaks over 225 N",
                f"{top:.3f} from the highest, {mean:.3f} from the mean of the teeth", f"{mu:.2f}",
                abs(top - mu) < 0.5 * (high - low) / WEIGHT,  # half the range of the printed peaks
                "wheels let go one after another, so the mean over teeth lies below the tires' coefficient",
            )
        )  # fmt: skip
    return rows


def spinning_force(robot: Robot, slip: float, lambda_max: float = 0.1) -> tuple[float, float]:
    """Mean and standard deviation of the lateral force [N] at 1 mm/s while held wheels spin with this slip [m/s]."""
    rates = np.full((1, 2), slip / robot.radius)
    held = pull("lateral", 1.0, 24.0, held=True, wheel_rates=rates)
    force = simulate(robot.with_changes(lambda_max=lambda_max), held, RATE)["force"][600:]
    return float(force.mean()), float(force.std())


def _knee(platform: Robot) -> Row:
    slips = (0.01, 0.02, 0.04, 0.08)
    forces = [spinning_force(platform, slip)[0] for slip in slips]
    flat = abs(forces[3] / forces[2] - 1.0) < 0.1 and 20.0 <= forces[2] <= 30.0
    return Row(
        "knee", "3.3", "Spinning in place the force falls nearly linearly with slip speed, flat from 0.04 m/s",
        ", ".join(f"{force:.1f} N at {slip:g} m/s" for slip, force in zip(slips, forces, strict=True)),
        "20–30 N from 0.04 m/s on", flat,
        "(4.12) gives µ_y = µ·v_y/(rω), a hyperbola that ends at zero: the least friction µ_k,min = 0.10 of the "
        "recordings is in no equation of the thesis",
    )  # fmt: skip


def _rope(robot: Robot) -> Row:
    slope = _one_wheel(robot, "rope")
    return Row(
        "rope", "3.3", "One wheel behind the rope, springs in series (3.9)", f"{slope / 1e3:.2f} kN/m",
        "4–6 kN/m", 4e3 < slope < 6e3,
    )  # fmt: skip


def _steel(robot: Robot) -> Row:
    slope = _one_wheel(robot, "steel")
    return Row(
        "steel", "3.3", "One wheel behind the steel cable", f"{slope / 1e3:.1f} kN/m", "20–25 kN/m",
        20e3 < slope < 25e3,
        "the thesis takes K_y = 18 kN/m, from the wheel dragged over wood, and not the 22.5 kN/m of this test: with "
        "one linear tire the two cannot both hold",
    )  # fmt: skip


def _one_wheel(robot: Robot, cable: str) -> float:
    """Ramp of a low lateral pull [N/m] with the rear left wheel gripping and the others oiled."""
    result = simulate(robot, pull("lateral", 1.0, 3.0, cable, height=0.0, wheels_gripping=(1,), held=True), RATE)
    part = (result.time > 0.5) & (result["force"] < 0.7 * result["force"].max()) & (result["force"] > 5.0)
    part &= result.time < result.time[np.argmax(result["force"])]
    return float(np.polyfit(result["head"][part], result["force"][part], 1)[0])


def _release(robot: Robot) -> Row:
    head = np.linspace(0.0, 0.012, 1200)
    drops = [int(np.sum(np.diff(drag_wheel(robot, head, 0.01, free_normal=free)) < -5.0)) for free in (True, False)]
    return Row(
        "wheel_release", "3.3", "A dragged wheel lets go only where it can move off the surface",
        f"{drops[0]} releases when free, {drops[1]} when held", "some, none", drops[0] > 0 and drops[1] == 0,
    )  # fmt: skip


def _hardening(robot: Robot) -> list[Row]:
    head = np.linspace(0.0, 0.012, 1200)

    def slopes(stiffness: float, k3: float) -> np.ndarray:
        tire = robot.with_changes(stiffness=np.array([robot.stiffness[0], stiffness, robot.stiffness[2]]))
        effects = {"nonlinear_stiffness": {"k3_N_m3": k3}}
        force = drag_wheel(tire, head, 0.01, free_normal=False, effects=effects)
        parts = ((force >= 0.0) & (force < 90.0), (force >= 90.0) & (force < 150.0))
        return np.array([np.polyfit(head[part], force[part], 1)[0] for part in parts])

    linear = slopes(float(robot.stiffness[1]), 0.0)
    wanted = np.array([15e3, 21e3])
    fit = least_squares(lambda q: slopes(1e4 * q[0], 1e8 * q[1]) / wanted - 1.0, [1.5, 1.0], diff_step=1e-3)
    hard = slopes(1e4 * fit.x[0], 1e8 * fit.x[1])
    return [
        Row(
            "ramp_linear", "3.3", "The dragged wheel's last ramp: 15 kN/m up to 90 N, 21 kN/m from 90 to 150 N",
            " and ".join(f"{slope / 1e3:.1f}" for slope in linear) + " kN/m", "15 and 21 kN/m",
            bool(np.all(np.abs(linear / wanted - 1.0) < 0.05)),
            "a linear tire has one slope, 18 kN/m, the mean of both",
        ),
        Row(
            "ramp_hardening", "3.3", "The same with the effect nonlinear_stiffness",
            " and ".join(f"{slope / 1e3:.1f}" for slope in hard)
            + f" kN/m with K = {10 * fit.x[0]:.1f} kN/m, k3 = {1e8 * fit.x[1]:.2g} N/m³",
            "15 and 21 kN/m", bool(np.all(np.abs(hard / wanted - 1.0) < 0.01)),
            "two numbers for two slopes: what it shows is that one cubic spring holds both",
        ),
    ]  # fmt: skip


def _compression(robot: Robot) -> Row:
    head = np.linspace(0.0, 0.003, 1500)
    found = load_curve(head, compress_wheel(robot, head, 0.02)).stiffness
    return Row(
        "compression", "3.3", "K_z from a simulated vertical compression", f"{found / 1e3:.2f} kN/m", "80 kN/m",
        abs(found / 80e3 - 1.0) < 0.01,
    )  # fmt: skip
