"""Section 6.2, pulls and straight driving: what the simulation must show."""

from __future__ import annotations

import numpy as np

from ssmr_ident.experiments.pull import pull
from ssmr_ident.experiments.straight import straight
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import Robot
from ssmr_ident.simulate import simulate
from thesis2012.forces import spinning_force
from thesis2012.rows import Row

HEIGHTS = (0.0, 0.1, 0.2, 0.3)  # m, of the cable


def pull_rows(robot: Robot) -> list[Row]:
    """Rows of section 6.2 without turning."""
    return [_teeth(robot), *_heights(robot), _first_wheels(robot), *_spinning(robot), _straight(robot)]


def _teeth(robot: Robot) -> Row:
    force = simulate(robot, pull("lateral", 1.0, 16.0), 100.0)["force"][500:]
    drops = int(np.sum(np.diff(force) < -10.0))
    return Row(
        "pull_teeth", "6.2", "A pull with stopped wheels at 1 mm/s is a saw-tooth", f"{drops} drops of 10 N and more",
        "teeth", drops > 5,
    )  # fmt: skip


def _heights(robot: Robot) -> list[Row]:
    slopes, shapes = [], []
    for height in HEIGHTS:
        result = simulate(robot, pull("lateral", 1.0, 12.0, height=height), 100.0)
        ramp = (result.time > 0.3) & (result.time < 1.5)
        slopes.append(float(np.polyfit(result["head"][ramp], result["force"][ramp], 1)[0]) / robot.stiffness[1])
        rest = result["force"][600:]
        shapes.append(float(np.quantile(rest, 0.98) - np.quantile(rest, 0.02)))
    change = max(shapes) / min(shapes)
    return [
        Row(
            "ramp_slopes", "6.2", "Ramp slopes lie between 2 and 4 K_tire with the height of the cable",
            ", ".join(f"{slope:.2f} K_tire at {height:g} m" for height, slope in zip(HEIGHTS, slopes, strict=True)),
            "2 … 4 K_tire, falling", bool(np.all(np.diff(slopes) < 0)) and 2.0 < slopes[-1] < slopes[0] < 4.0,
            "a low pull moves all four tires; a high one tilts the robot as well, which adds compliance",
        ),
        Row(
            "shape_over_height", "6.2", "The shape of the saw-tooth changes with height",
            ", ".join(f"{depth:.0f} N at {height:g} m" for height, depth in zip(HEIGHTS, shapes, strict=True))
            + " from trough to peak",
            "not the same at all heights", change > 1.3,
        ),
    ]  # fmt: skip


def even_axles(robot: Robot) -> Robot:
    """The robot of chapter 5, a = b: both axles alike."""
    points = robot.contact_points.copy()
    points[:, 0] = np.sign(points[:, 0]) * float(np.abs(points[:, 0]).mean())
    return robot.with_changes(contact_points=points)


def _first_wheels(robot: Robot) -> Row:
    even = even_axles(robot)
    result = simulate(even, pull("lateral", 1.0, 8.0, height=0.2), 1000.0)
    start = int(np.flatnonzero(result["sliding"])[0])
    first = int(result["sliding"][start])
    loads = [result[f"load_{wheel}"][start - 5] for wheel in (1, 2, 3, 4)]
    return Row(
        "two_first", "6.2", "Two wheels let go before the others",
        f"{first} at first, under {min(loads):.0f} N against {max(loads):.0f} N", "2", first == 2,
        "with a = b; with Table 5.1's unequal axles they let go one by one",
    )  # fmt: skip


def _spinning(robot: Robot) -> list[Row]:
    slips = (0.0, 0.001, 0.003, 0.01, 0.04)
    forces = [spinning_force(robot, slip)[0] for slip in slips]
    limits = (1.0, 0.1, 0.01)
    same, scatter = np.array([spinning_force(robot, 0.01, limit) for limit in limits]).T
    return [
        Row(
            "spinning_fall", "6.2", "Pulled while its wheels spin, the force falls with slip speed",
            ", ".join(f"{force:.0f} N at {1e3 * slip:g} mm/s" for slip, force in zip(slips, forces, strict=True)),
            "falling", bool(np.all(np.diff(forces) < 0)),
        ),
        Row(
            "spinning_lambda", "6.2", "There λ_max has no effect, because λ = 1",
            ", ".join(f"{force:.1f} N at {limit:g}" for limit, force in zip(limits, same, strict=True)), "equal",
            float(np.ptp(same)) < float(scatter.min()),
            f"less apart than the teeth are high ({scatter.min():.0f} N rms). At 1 the force is lower by "
            f"{100 * (1 - same[0] / same[1]):.0f} %: the hubs sway on their tires, and |λ| is a little below 1",
        ),
    ]  # fmt: skip


def _straight(robot: Robot) -> Row:
    limits = (1.0, 0.1, 0.01)
    runs = [
        simulate(robot.with_changes(lambda_max=limit), straight(wheel_rates(robot, 0.3, 0.0), 6.0), 100.0)
        for limit in limits
    ]
    ways = [float(run["x"][-1]) for run in runs]
    return Row(
        "straight", "6.2", "Driving straight on, λ_max hardly matters",
        ", ".join(f"{way:.4f} m at {limit:g}" for limit, way in zip(limits, ways, strict=True)) + " after 6 s",
        "equal", max(ways) / min(ways) < 1.01,
    )  # fmt: skip
