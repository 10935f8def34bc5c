"""Section 6.2, swivelling: what the simulation must show, over λ_max and speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.planar_dynamics import planar_robot, saturating_friction, settle
from ssmr_ident.physics.robot import Robot
from thesis2012.pulls import even_axles
from thesis2012.rows import Row
from thesis2012.swivels import LIMITS, NEAR_HZ, REPEATS, SPEEDS, Turn, Turns, all_turns, turn

CLIPPED = 0.7 * 9.8  # m/s^2: what is left of a_z beside gravity before the accelerometer clips (thesis.md 7.8)


def turning_rows(robot: Robot, progress: Callable[[str], None] | None = None) -> list[Row]:
    """Rows of section 6.2 about swivels, under (6.4) to the letter, N >= 0 (4.15) and the contact points of Table 5.1.

    What the relay that lands on its limit makes of the same statement is in the remark.
    """
    relay = _rows(robot.with_contact("relay"), progress)
    printed = _rows(robot.with_contact("printed_6_4"), progress)
    return [_beside(one, other) for one, other in zip(printed, relay, strict=True)]


def _beside(printed: Row, relay: Row) -> Row:
    """The row under the printed law, with the other law's answer; reasons were worked out under the relay."""
    answer = {True: "it holds", False: "it does not"}[bool(relay.passed)]
    said = f"Under the relay that lands on µ_k N {answer}: {relay.found}. {relay.comment}".rstrip()
    return replace(printed, comment=said)


def _rows(robot: Robot, progress: Callable[[str], None] | None) -> list[Row]:
    turns = all_turns(robot, progress=progress)
    variants = {
        "kinetic term kept": turn(robot, 0.01, 64.0, release_drag=1.0),
        "a = b": turn(even_axles(robot), 0.01, 64.0),
        "a = b and kinetic term kept": turn(even_axles(robot), 0.01, 64.0, release_drag=1.0),
    }
    return [
        _lateral(robot, turns, variants), _slower(turns), _skid(turns), _lower(turns), _one_line(turns),
        _common(turns), _twenty(turns), _vertical(turns), _vertical_one(turns), _amplitudes(turns), _lifting(turns),
    ]  # fmt: skip


def _over(values: dict[float, str]) -> str:
    return ", ".join(f"{text} at {limit:g}" for limit, text in values.items())


def _lateral(robot: Robot, turns: Turns, variants: dict[str, Turn]) -> Row:
    at = {limit: turns[limit, 90.0] for limit in LIMITS}
    # a turn about the CoM drags the wheels sideways at this speed; the robot's own should be small beside it
    centred = float(np.abs(robot.contact_points[:, 0]).mean() * np.deg2rad(90.0))
    small = max(abs(one.lateral) for one in at.values()) < 0.1 * centred
    others = "; ".join(f"{name}: {100 * one.shift:.0f} cm" for name, one in variants.items())
    law = saturating_friction(robot.mu_static, 0.01)
    plane = settle(planar_robot(robot), wheel_rates(robot, 0.0, float(np.deg2rad(64.0))), law)
    return Row(
        "lateral_velocity", "6.2", "A swivel has a small lateral velocity",
        _over({limit: f"{abs(one.lateral):.3f} m/s" for limit, one in at.items()}) + " (90°/s)",
        f"a tenth of the {centred:.2f} m/s at which the wheels skid", small,
        "Only for λ_max = 1. Below, (4.12) saturates: a wheel's sideways grip no longer grows with its sideways speed, "
        "so nothing centres the turn. The front axle, which carries more, stands still sideways and the rear one "
        f"skids: the robot turns about a point {100 * turns[0.01, 64.0].shift:.0f} cm ahead of its CoM (64°/s, λ_max "
        f"0.01; front axle at 13 cm). Otherwise there: {others}. The planar model, which shares no code with the "
        f"simulator, agrees: {-100 * plane[1] / plane[2]:.0f} cm. With equal axles the thesis' (6.4) leaves the centre "
        "as well, to the side that rounding chooses, because without friction during release a contact holds the less "
        "the faster it is dragged; with the kinetic term it stays",
    )  # fmt: skip


def _slower(turns: Turns) -> Row:
    shares = {limit: float(np.mean([turns[limit, speed].turned for speed in SPEEDS])) for limit in LIMITS}
    three = [shares[limit] for limit in LIMITS[:3]]
    return Row(
        "slower_turn", "6.2", "The larger λ_max, the slower the turn",
        _over({limit: f"{100 * share:.1f} %" for limit, share in shares.items()}) + " of the yaw rate asked for",
        "rising as λ_max falls", bool(np.all(np.diff(three) > 0)) and min(shares.values()) == three[0],
        "by (4.10) the slip must reach λ_max before the wheels push with their full grip",
    )  # fmt: skip


def _skid(turns: Turns) -> Row:
    rms = {limit: turns[limit, 90.0].lateral_rms for limit in LIMITS}
    shaking = {limit: float(np.sqrt(rms[limit] ** 2 - turns[limit, 90.0].lateral ** 2)) for limit in LIMITS}
    return Row(
        "larger_skid", "6.2", "The larger λ_max, the larger the lateral skid",
        _over({limit: f"{value:.3f} m/s" for limit, value in rms.items()}) + " (rms sideways, 90°/s)",
        "falling as λ_max falls", bool(np.all(np.diff(list(rms.values())) < 0)),
        "The reverse, because below λ_max = 1 the turn is not centred (see the lateral velocity). Without that steady "
        "part the sideways shaking is " + _over({limit: f"{value:.4f} m/s" for limit, value in shaking.items()}),
    )  # fmt: skip


def _lower(turns: Turns) -> Row:
    lines = {limit: float(turns[limit, 30.0].lines[1]) for limit in LIMITS}
    fast = {limit: turns[limit, 30.0].fast_line for limit in LIMITS[:3]}
    return Row(
        "lower_frequency", "6.2", "The larger λ_max, the lower the vibration frequency",
        _over({limit: f"{line:.1f} Hz" for limit, line in lines.items()}) + " (a_y, 30°/s)",
        "rising as λ_max falls", bool(np.all(np.diff(list(lines.values())) > 0)),
        "The reverse below 50 Hz, where the thesis looks: the body's own slow modes remain there. The stick-slip of "
        "the wheels is faster, at their sideways speed over the length of a tooth, and does rise as λ_max falls: "
        + _over({limit: f"{line:.0f} Hz" for limit, line in fast.items()}),
    )  # fmt: skip


def _one_line(turns: Turns) -> Row:
    lines = [float(turns[1.0, speed].lines[0]) for speed in SPEEDS]
    shares = [float(turns[1.0, speed].shares[0]) for speed in SPEEDS]
    return Row(
        "one_line", "6.2", "λ_max = 1: one line that rises with speed",
        ", ".join(f"{line:.1f} Hz at {speed:.0f}°/s" for speed, line in zip(SPEEDS, lines, strict=True)) + " (a_x)",
        "one line, rising", bool(np.all(np.diff(lines) > 0)) and min(shares) > 0.5,
        "It rises up to 30°/s; from 45°/s on a whole-body motion at 8 Hz takes over, which rises too, from "
        f"{lines[3]:.1f} to {lines[5]:.1f} Hz. Up to 30°/s the line within 1 Hz holds {100 * max(shares[:3]):.0f} % of "
        "the energy below 50 Hz at most",
    )  # fmt: skip


def _common(turns: Turns) -> Row:
    spread = {key: float(np.ptp(turns[key].lines)) for key in turns if key[0] in (0.1, 0.01)}
    together = sum(value < NEAR_HZ for value in spread.values())
    return Row(
        "common_line", "6.2", "λ_max = 10⁻¹, 10⁻²: one main line common to the three axes",
        f"common within 1 Hz in {together} of {len(spread)} runs", "in all", together == len(spread),
        "Common at "
        + (", ".join(f"λ_max {k[0]:g} and {k[1]:.0f}°/s" for k, value in spread.items() if value < NEAR_HZ) or "none")
        + ". Else a_z shows the pitch mode near 11 Hz, a_x the slow longitudinal one at 3 Hz and above, a_y stick-slip",
    )  # fmt: skip


def _twenty(turns: Turns) -> Row:
    """A line counts from five times the power that a flat spectrum would have within 1 Hz."""
    flat = 2.0 * NEAR_HZ / 49.0
    found = {}
    for limit in (0.1, 0.01):
        one = turns[limit, 10.0]
        found[limit] = float(np.max(np.where(one.shares > 5.0 * flat, one.lines, 0.0)))
    broad = turns[0.1, 10.0]
    return Row(
        "twenty_hertz", "6.2", "λ_max = 10⁻¹, 10⁻²: lines up to 20 Hz at low speed",
        _over({limit: f"{line:.1f} Hz" for limit, line in found.items()}) + " (highest clear line, 10°/s)",
        "up to about 20 Hz", 15.0 < max(found.values()) < 25.0,
        f"a_y, which shakes most, has no line there: its strongest 2 Hz hold {100 * broad.shares[1]:.0f} % of its "
        "power, and the highest peak of a single log is a draw below 25 Hz; the clear line is the pitch mode in a_z",
    )  # fmt: skip


def _vertical(turns: Turns) -> Row:
    ratios = {
        limit: max(float(turns[limit, speed].amplitudes[2] / turns[limit, speed].amplitudes[1]) for speed in SPEEDS)
        for limit in LIMITS[1:]
    }
    return Row(
        "small_az", "6.2", "The amplitude of a_z is small, λ_max ≤ 10⁻¹",
        _over({limit: f"{ratio:.2f}" for limit, ratio in ratios.items()}) + " of that of a_y at most",
        "well below 1", max(ratios.values()) < 0.5,
    )  # fmt: skip


def _vertical_one(turns: Turns) -> Row:
    ratios = [float(turns[1.0, speed].amplitudes[2] / turns[1.0, speed].amplitudes[1]) for speed in SPEEDS]
    return Row(
        "small_az_one", "6.2", "The amplitude of a_z is small, λ_max = 1",
        ", ".join(f"{ratio:.2f} at {speed:.0f}°/s" for speed, ratio in zip(SPEEDS, ratios, strict=True)) + " of a_y",
        "well below 1", max(ratios) < 0.5,
        "the 8 Hz motion from 45°/s on is a pitch and roll of the whole body, and the accelerometer sits 0.2 m behind "
        "the CoM",
    )  # fmt: skip


def _amplitudes(turns: Turns) -> Row:
    largest = {limit: max(float(turns[limit, speed].amplitudes[2]) for speed in SPEEDS) for limit in LIMITS}
    return Row(
        "small_amplitudes", "6.2", "For every λ_max the amplitudes are much smaller than the recorded ones",
        _over({limit: f"{value:.2f} m/s²" for limit, value in largest.items()}) + " (a_z, largest over speeds)",
        f"far below {CLIPPED:.1f} m/s²", max(largest.values()) < 0.5 * CLIPPED,
        "no recorded amplitude is printed; known is that large a_z reached the end of the sensor's range, 0.7 g beside "
        "gravity",
    )  # fmt: skip


def _lifting(turns: Turns) -> Row:
    typical = {limit: float(np.median(turns[limit, 90.0].least_loads)) for limit in LIMITS}
    lifted = int(sum(np.sum(turns[limit, 90.0].least_loads <= 0.0) for limit in LIMITS))
    return Row(
        "lifting", "3.2", "Wheels lift above 64°/s (recordings)",
        _over({limit: f"{load:.0f} N" for limit, load in typical.items()})
        + f" (least wheel load, 90°/s); lifted in {lifted} of {REPEATS * len(LIMITS)} runs",
        "0 N", np.median(list(typical.values())) <= 0.0,
        "part of the thesis' open mismatch: without an uneven floor the simulated robot seldom shakes enough to lift",
    )  # fmt: skip
