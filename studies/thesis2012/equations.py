"""Every numbered equation, figure and table of the thesis: where it is, its command and test, and whether it holds.

``python -m thesis2012.equations`` in studies/ writes equations.md. Where a check is a few lines it is made here and
now; where it is a row of the scoreboard, the row's answer stands. Names of code and tests are looked up, so that none
can go stale unseen.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ssmr_ident.identify.body.tire_parameters import Geometry, damping_as_printed
from ssmr_ident.physics.constrained import constraint, free_directions
from ssmr_ident.physics.drive import drive_matrix, motor_torques
from ssmr_ident.physics.linear import linear_robot, pure_rotations
from ssmr_ident.physics.planar import body_motion, rotation_centres, slip, wheel_rates_for, world_velocity
from ssmr_ident.physics.planar_dynamics import load_split, planar_robot
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.physics.screw import screw_axis
from ssmr_ident.physics.statics import rest_loads, tilt
from ssmr_ident.physics.tire import contact_force, grip_shares, printed_force
from ssmr_ident.session import read_parameters
from thesis2012.rows import Scoreboard
from thesis2012.scoreboard import thesis_scoreboard
from thesis2012.table_5_2 import TABLE_5_2

ROOT = Path(__file__).resolve().parents[2]
LAST = {2: 65, 3: 9, 4: 15, 5: 11, 6: 5}
"""Highest number of an equation that is at hand, per chapter."""
NOT_AT_HAND = "its print is not at hand"

Answer = tuple[bool | None, str]


@dataclass(frozen=True)
class Item:
    """One equation, figure or table.

    Parameters
    ----------
    name : str
        As the thesis numbers it.
    what : str
    code : str
        ``module:name`` below ssmr_ident.
    command : str
    test : str
        ``file::test`` below tests/.
    check : callable, str or None
        Gives whether it holds, with figures; the key of a row of the scoreboard; None where only the test says so.
    said : str
        What differs from the print, or why nothing can be said.
    """

    name: str
    what: str
    code: str
    command: str
    test: str
    check: Callable[[Robot], Answer] | str | None = None
    said: str = ""


def _close(found: float, expected: float, share: float, unit: str = "") -> Answer:
    held = bool(abs(found - expected) <= share * abs(expected))
    return held, f"{found:.4g} against {expected:.4g}{unit and ' ' + unit}"


def _rotation(_: Robot) -> Answer:
    found = world_velocity(np.array([0.3, -0.4, 0.2]), 0.7)
    return bool(np.isclose(np.hypot(*found[:2]), 0.5)), f"length kept to {abs(np.hypot(*found[:2]) - 0.5):.0e} m/s"


def _slip(_: Robot) -> Answer:
    return _close(slip(2.0, 0.1, 0.1), 0.5, 1e-12)


def _centres(_: Robot) -> Answer:
    plane, axis = (
        rotation_centres(np.array([0.3, -0.1, 0.9]), np.array([1.0, 4.0]), 0.111),
        screw_axis(np.array([0.3, -0.1, 0.0]), np.array([0.0, 0.0, 0.9])),
    )
    apart = float(np.abs(axis.point[:2] - [plane.x, plane.body]).max())
    return apart < 1e-12, f"planar and three-dimensional centre {apart:.0e} m apart"


def _motion(_: Robot) -> Answer:
    slips = np.array([0.3, -0.2])
    found = body_motion(wheel_rates_for(0.4, 0.7, slips, 0.111, 0.18), slips, 0.111, 0.18)
    apart = float(np.abs(found - [0.4, 0.7]).max())
    return apart < 1e-12, f"back and forth to {apart:.0e}"


def _constraint(_: Robot) -> Answer:
    left = float(np.abs(constraint(0.7, 0.05) @ free_directions(0.7, 0.05)).max())
    return left < 1e-15, f"A·S = {left:.0e}"


def _loads(robot: Robot) -> Answer:
    apart = float(np.abs(load_split(planar_robot(robot)) / rest_loads(robot) - 1.0).max())
    return apart < 3e-3, f"rigid against elastic robot: {100 * apart:.2f} % apart at most"


def _tilt(_: Robot) -> Answer:
    matrix = tilt(0.1, -0.2)
    off = float(np.abs(matrix @ matrix.T - np.eye(3)).max())
    return off < 1e-15, f"orthogonal to {off:.0e}"


def _torques(robot: Robot) -> Answer:
    forces = np.array([3.0, -1.0, 4.0, 2.0])
    pushed = drive_matrix(robot.radius, robot.half_track) @ motor_torques(
        forces, robot.contact_points[:, 1] > 0, robot.radius
    )
    return _close(float(pushed[0]), float(forces.sum()), 1e-12, "N")


def _shares(_: Robot) -> Answer:
    x, y = grip_shares(0.2, 0.01, 0.005, 0.1)
    return bool(
        np.isclose(x, 0.5) and np.isclose(y, 0.25)
    ), f"µ_x {x:.3f}, µ_y {y:.3f} of µ for |λ| = λ_max/2, tan θ = 1/2"


def _sticking(_: Robot) -> Answer:
    force = contact_force(1e-3, False, 0.0, 0.01, 0.0, 18e3, 30.0, 0.035, 60.0, 45.0, 0.0, 1e-4)[2]
    return _close(float(force), -(18.0 + 0.3), 1e-12, "N")


def _letter(_: Robot) -> Answer:
    """A contact that has been let go, without hub motion: m_t dv/dt + D v = K s after one step."""
    step, mass, damping = 1e-5, 0.035, 30.0
    _, speed, _ = printed_force(
        4e-3, True, 0.0, (0.0, 0.0), 0.0, 18e3, damping, mass, 60.0, 45.0, 0.0, np.exp(-damping * step / mass), step
    )
    return _close(float(speed), 72.0 / damping * (1.0 - np.exp(-damping * step / mass)), 1e-12, "m/s")


def _pure(robot: Robot) -> Answer:
    linear = pure_rotations(robot)
    found = np.sqrt(np.diag(linear.stiffness)[3:] / np.diag(linear.mass)[3:]) / (2 * np.pi)
    printed = [np.mean(TABLE_5_2[motion]) for motion in ("roll", "pitch", "yaw")]
    text = ", ".join(f"{f:.2f} against {p:.2f} Hz" for f, p in zip(found, printed, strict=True))
    return bool(np.all(np.abs(found / printed - 1.0) < 0.1)), f"{text} of Table 5.2 with the CAD inertia"


def _coupled(robot: Robot) -> Answer:
    modes = linear_robot(robot).modes()
    own = {}
    for motion, column in (("roll", 5), ("pitch", 6), ("yaw", 7)):
        seen = modes[modes[:, column] > 0.4]
        own[motion] = (
            float(seen[0, 0] / (2 * np.pi))
            if motion != "yaw"
            else float(seen[np.argmin(np.abs(seen[:, 0] / (2 * np.pi) - 7.5)), 0] / (2 * np.pi))
        )
    printed = {motion: float(np.mean(TABLE_5_2[motion])) for motion in own}
    text = ", ".join(f"{motion} {own[motion]:.2f} against {printed[motion]:.2f} Hz" for motion in own)
    return all(abs(own[motion] / printed[motion] - 1.0) < 0.1 for motion in own), f"{text} of Table 5.2"


def _printed_damping(_: Robot) -> Answer:
    geometry = Geometry()
    natural, xi = np.array([38.0031, 19.4807, 47.4008]), np.array([0.0526, 0.1797, 0.0949])
    found = damping_as_printed(natural, xi, np.array([6000.0, 18000.0, 80000.0]), geometry).damping
    text = ", ".join(f"{value:.0f}" for value in found)
    return bool(np.allclose(found, [1596.0, 2284.0, 4693.0], rtol=0.01)), f"D_x, D_y, D_z = {text} N s/m"


def _fourth(robot: Robot) -> Answer:
    return bool(np.allclose(robot.contact_points[3], [-0.15, -0.18, -0.23])), str(robot.contact_points[3].tolist())


def _weight(robot: Robot) -> Answer:
    return (
        None,
        f"the bundled robot weighs {robot.mass * GRAVITY:.0f} N; the thesis prints 225 N for the platform alone",
    )


SWEEP = "ident sweep p3at-extended --over lambda_max=1,0.1,0.01,1e-3,1e-4 -e swivel --contact printed_6_4"
SPECTRUM, DECAYS = "ident spectrum data/raw/swivel-frame", "ident fit data/raw/free_response --figures figures"
PULLS = "ident fit data/raw/pulls/concrete.yaml"
PLANAR, CHAPTER_2 = "unit/test_planar.py", "unit/test_chapter_2.py"
LAWS = "unit/test_contact_laws.py::test_printed_6_4_against_scipy"
SWIVEL = "ident simulate p3at-extended -e swivel -o swivel.csv"
PYTHON = "none: a function of the library"

ITEMS = (
    Item("(2.1)", "velocity in the world", "physics.planar:world_velocity", PYTHON,
         f"{PLANAR}::test_world_velocity_keeps_length_and_goes_round", _rotation),
    Item("(2.7)", "slip", "physics.planar:slip", SWEEP,
         f"{PLANAR}::test_slip_is_clamped_on_both_sides_and_for_both_directions", _slip),
    Item("(2.8)-(2.10)", "centres of rotation, here in three dimensions too", "physics.screw:screw_axis", PYTHON,
         f"{CHAPTER_2}::test_the_axis_of_rotation_in_three_dimensions", _centres),
    Item("(2.11)", "motion from wheel rates and slips", "physics.planar:body_motion", SWEEP,
         f"{PLANAR}::test_2_11_as_printed", _motion),
    Item("(2.24)", "load split", "physics.planar_dynamics:load_split", PYTHON,
         f"{PLANAR}::test_load_split_is_that_of_the_elastic_robot", _loads),
    Item("(2.28)", "sign against (2.4)", "physics.planar_dynamics:contact_forces", PYTHON,
         f"{PLANAR}::test_power_of_the_motors_is_kinetic_energy_and_heat", None,
         f"here the floor takes power from a slipping wheel and never gives it; {NOT_AT_HAND}"),
    Item("(2.29a)", "µ(λ), rising to its limit", "physics.planar_dynamics:saturating_friction", PYTHON,
         f"{PLANAR}::test_friction_laws", None, f"the form that (4.10) keeps; {NOT_AT_HAND}"),
    Item("(2.29b)", "µ(λ), with a peak", "physics.planar_dynamics:peaking_friction", PYTHON,
         f"{PLANAR}::test_friction_laws", None,
         f"the usual law with one peak stands for it; {NOT_AT_HAND}"),
    Item("A(q), S(q)", "constraint and free directions", "physics.constrained:free_directions", PYTHON,
         f"{CHAPTER_2}::test_what_is_free_meets_the_constraint", _constraint),
    Item("reduced model", "of chapter 2", "physics.constrained:reduced_acceleration", PYTHON,
         f"{CHAPTER_2}::test_the_reduced_model_is_the_full_one_with_the_constraint_as_a_stiff_spring"),
    Item("(2.36)", "planar dynamics", "physics.planar_dynamics:acceleration", PYTHON,
         f"{PLANAR}::test_steady_turns_agree_with_the_six_degrees_of_freedom"),
    Item("(2.37)", "rotation matrix", "physics.statics:tilt", SWIVEL, "unit/test_robot_physics.py", _tilt,
         "angles are named against the usual axes in print; here roll is about x, pitch about y, yaw about z"),
    Item("(2.53), (2.55)", "reaction wrench, wheel centre velocity", "simulate.energy:floor_power", SWIVEL,
         f"{CHAPTER_2}::test_what_the_floor_does_on_the_body_is_its_energy"),
    Item("(2.65)", "rigid body", "simulate.robot_kernel:run", SWIVEL,
         f"{CHAPTER_2}::test_what_the_floor_does_on_the_body_is_its_energy", None,
         "section 6.1 drops M·V̂·V; here it is the effect coriolis"),
    Item("(3.2)", "transfer function", "signals.filters:low_pass", SPECTRUM,
         "golden/test_scoreboard.py::test_every_row_stands_where_it_stood", "filter",
         f"drawn by python -m thesis2012.bode; taken to be that of the Butterworth filter, for {NOT_AT_HAND}"),
    Item("(3.4)-(3.5)", "what the accelerometers measure", "physics.sensor:Accelerometer", SWIVEL,
         "unit/test_robot_physics.py"),
    Item("(3.6)-(3.7)", "the same, solved for the motion", "physics.linear:accelerometer_rows", DECAYS,
         "unit/test_robot_physics.py", lambda _: (False, "gravity has the sign opposite to (3.5)"),
         "here specific force, +g at rest"),
    Item("(3.8)", "two belts in parallel", "physics.effects.motor_belt:force",
         "ident simulate p3at-platform -e pull --direction longitudinal --effect motor_belt:K_b_N_m=3000",
         "golden/test_scoreboard.py::test_numbers_of_single_rows", "belts"),
    Item("(3.9)", "rope in series", "experiments.pull:cable_properties",
         "ident simulate p3at-extended -e pull --cable rope", "golden/test_scoreboard.py::test_numbers_of_single_rows",
         "rope"),
    Item("(4.9), (4.13)", "tire force along y and x", "physics.tire:contact_force", SWIVEL, LAWS, _sticking),
    Item("(4.10)-(4.12)", "dynamic friction", "physics.tire:grip_shares", SWEEP, "unit/test_robot_physics.py", _shares),
    Item("(4.14)", "tire and belt in series", "identify.forces.stiffness:in_series", PULLS,
         "golden/test_scoreboard.py::test_numbers_of_single_rows", "belts"),
    Item("(4.15)", "N ≥ 0", "physics.effects.wheel_lift:load", f"{SWIVEL} --effect wheel_lift",
         "unit/test_contact_laws.py::test_wheels_do_not_pull_at_the_floor_under_the_printed_law", None,
         "in pulls; in decays, swivels and straight runs it is the effect wheel_lift"),
    Item("(5.1), CAD", "inertia", "session:read_parameters", "ident demo", "golden/test_published.py", None,
         "CAD and hand calculation are 1 to 8 % apart in print"),
    Item("(5.3)", "pure rotations", "physics.linear:pure_rotations",
         "ident fit data/raw/free_response/decoupled.yaml", "golden/test_thesis_numbers.py", _pure,
         "the missing translation: (5.11)"),
    Item("(5.8)", "what the sensor sees of each motion", "physics.linear:accelerometer_rows",
         "ident simulate p3at-extended -e free_response --motion pitch --start vertical -o pitch.csv",
         "unit/test_free_starts.py::test_each_motion_shows_its_own_line"),
    Item("(5.9)", "ω_n and ξ", "identify.body.tire_parameters:natural_frequency", DECAYS,
         "golden/test_thesis_numbers.py"),
    Item("(5.10)", "inertia and damping", "identify.body.tire_parameters:rotation_inertia", DECAYS,
         "golden/test_published.py", _printed_damping,
         "the printed D_y = 2284 and D_z = 4693 do not follow from the printed inputs, and no passive tire has a "
         "negative one; I_y and I_z follow with K_x = 6000 N/m only, the resultant of both belts"),
    Item("(5.11)", "roll and pitch with translation", "physics.linear:linear_robot", DECAYS,
         "unit/test_free_starts.py::test_each_motion_shows_its_own_line", _coupled,
         "the print lacks m in its s³ and s² terms; derived anew"),
    Item("(6.1)", "motor", "physics.motor:wheel_rates", SWIVEL, "unit/test_robot_physics.py"),
    Item("(6.2)-(6.3)", "torques from forces, and back", "physics.drive:torques_for", PYTHON,
         f"{CHAPTER_2}::test_torques_and_back", _torques, f"derived from (2.65); {NOT_AT_HAND}"),
    Item("(6.4)", "over-damped release", "physics.tire:printed_force", SWEEP, LAWS, _letter,
         "to the letter under tire.contact: printed_6_4; the kinetic term that the text drops is release_drag"),
    Item("(6.5)", "start of a free response, damping by trial", "experiments.free_response:pressed",
         "ident simulate p3at-extended -e free_response --start vertical -o roll.csv",
         "unit/test_free_starts.py::test_only_vertical_springs_are_pressed"),
    Item("Table 5.1", "contact points", "session:read_parameters", SWIVEL, "golden/test_published.py", _fourth,
         "p_4 closes the rectangle; 'clockwise from the rear right' in the text does not match the table"),
    Item("Table 5.2", "FFT peaks of eight trials", "workflows.fit.decay_table:decay_table", DECAYS,
         "golden/test_published.py", "grid"),
    Item("weight", "of the whole robot", "session:read_parameters", "ident geometry docs/howto/measurements.yaml",
         "unit/test_identify_geometry.py", _weight),
    Item("section 3.3", "µ_s, saw-teeth, K", "identify.forces.sawtooth:take_apart", PULLS,
         "golden/test_scoreboard.py::test_every_row_stands_where_it_stood", "lateral_concrete"),
    Item("Figures 6.10-6.24", "Appendix B: peaks and amplitudes of the recordings", "workflows.spectrum.run:spectrum",
         SPECTRUM, "golden/test_appendix_a.py", "recordings"),
    Item("Appendix A", "peaks and amplitude of a log", "signals.analysis:analyse", SPECTRUM,
         "golden/test_appendix_a.py", "peaks"),
    Item("Appendix C", "the simulator over λ_max", "workflows.sweep.run:sweep", SWEEP,
         "unit/test_sweep.py::test_a_sweep_writes_everything_once", "twenty_hertz"),
)  # fmt: skip


def rows(board: Scoreboard, robot: Robot) -> list[tuple[str, ...]]:
    """All rows as text: name, what, where, command, test, whether it holds."""
    found = []
    for item in ITEMS:
        _there(item)
        found.append(
            (
                item.name,
                item.what,
                f"`{item.code}`",
                f"`{item.command}`",
                f"`tests/{item.test}`",
                _held(item, board, robot),
            )
        )
    named = {number for item in ITEMS for number in _numbers(item.name)}
    for chapter, last in LAST.items():
        for first, end in _runs([k for k in range(1, last + 1) if (chapter, k) not in named]):
            name = f"({chapter}.{first})" if first == end else f"({chapter}.{first})-({chapter}.{end})"
            found.append((name, "not at hand", "–", "–", "–", f"cannot be checked: {NOT_AT_HAND}"))
    return sorted(found, key=lambda row: (_numbers(row[0]) or [(9, 9)])[0])


def _held(item: Item, board: Scoreboard, robot: Robot) -> str:
    if isinstance(item.check, str):
        row = board[item.check]
        answer: Answer = row.passed, row.found if row.passed is not None else row.comment
    elif item.check is None:
        answer = True, "by its test"
    else:
        answer = item.check(robot)
    unknown = answer[0] is None or item.said.endswith(NOT_AT_HAND)
    word = "cannot be checked" if unknown else "holds" if answer[0] else "does not"
    return f"{word}: {answer[1]}" + (f"; {item.said}" if item.said else "")


def _there(item: Item) -> None:
    """Stop where code or test of an item have gone."""
    module, name = item.code.split(":")
    getattr(importlib.import_module(f"ssmr_ident.{module}"), name)
    file, _, test = item.test.partition("::")
    text = (ROOT / "tests" / file).read_text(encoding="utf-8")
    if test and f"def {test}(" not in text:
        raise LookupError(f"{item.name}: tests/{file} has no {test}")


def _numbers(name: str) -> list[tuple[int, int]]:
    """Equations that a name stands for.

    >>> _numbers("(4.10)-(4.12)")
    [(4, 10), (4, 11), (4, 12)]
    """
    each = [(int(a), int(b)) for a, b in re.findall(r"\((\d)\.(\d+)[ab]?\)", name)]
    if ")-(" in name and len(each) == 2:
        return [(each[0][0], k) for k in range(each[0][1], each[1][1] + 1)]
    return each


def _runs(numbers: list[int]) -> list[tuple[int, int]]:
    """Consecutive numbers as first and last."""
    found: list[tuple[int, int]] = []
    for number in numbers:
        if found and number == found[-1][1] + 1:
            found[-1] = found[-1][0], number
        else:
            found.append((number, number))
    return found


def page(table: list[tuple[str, ...]]) -> str:
    """The whole page."""
    counts = [sum(row[-1].startswith(word) for row in table) for word in ("holds", "does not", "cannot")]
    head = ("", "what", "implemented in ssmr_ident", "command", "test", "holds")
    lines = [
        "# Equations, figures and tables of the thesis\n",
        f"Written by `python -m thesis2012.equations` in studies/. {counts[0]} hold, {counts[1]} do not, {counts[2]} "
        "cannot be checked. A test that is named is the answer where no figure is.\n",
        f"| {' | '.join(head)} |",
        f"|{' --- |' * len(head)}",
        *(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in table),
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    known = robot_from_parameters(read_parameters("p3at-extended"))
    target = Path(__file__).with_name("equations.md")
    target.write_text(page(rows(thesis_scoreboard(print), known)), encoding="utf-8")
    print(f"written to {target}")
