"""The laws under which a contact slides: (6.4) to the letter against an integrator of scipy, and the choice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.experiments.pull import pull
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.session import read_parameters, write_parameters
from ssmr_ident.simulate.bench import drag_wheel
from ssmr_ident.simulate.many import simulate_alike
from ssmr_ident.simulate.simulation import simulate


@pytest.fixture(scope="module")
def robot() -> Robot:
    return robot_from_parameters(read_parameters("p3at-extended"))


def releases_by_scipy(robot: Robot, speed: float, teeth: int) -> np.ndarray:
    """Times [s] at which (6.4) lets go, for a hub at constant speed [m/s]."""
    load = robot.mass * GRAVITY / 4.0
    k, d, m = robot.stiffness[1], robot.damping[1], robot.effective_mass
    state, start, times = np.array([0.0, 0.0]), 0.0, []
    for _ in range(teeth):
        for released, limit in ((False, robot.mu_static * load), (True, robot.mu_kinetic * load)):

            def rates(_: float, q: np.ndarray, released: bool = released) -> list[float]:
                return [speed - q[1], (released * (k * q[0] + d * speed) - d * q[1]) / m]

            def crosses(_: float, q: np.ndarray, limit: float = limit) -> float:
                return k * q[0] + d * speed - limit

            crosses.terminal, crosses.direction = True, -1.0 if released else 1.0  # type: ignore[attr-defined]
            found = solve_ivp(rates, (start, start + 10.0), state, "DOP853", events=crosses, rtol=1e-9, atol=1e-12)
            if not released:
                times.append(found.t[-1])
            state, start = found.y[:, -1], found.t[-1]
    return np.array(times)


def releases(force: np.ndarray, step: float) -> np.ndarray:
    """Times [s] at which a drag's force falls through four fifths of its highest."""
    high = force > 0.8 * force.max()
    return step * np.flatnonzero(high[:-1] & ~high[1:])


def test_printed_6_4_against_scipy(robot: Robot) -> None:
    speed, step = 0.02, 1e-5
    head = speed * np.arange(0.0, 0.8, step)
    found = releases(drag_wheel(robot.with_contact("printed_6_4"), head, step), step)
    expected = releases_by_scipy(robot, speed, 4)
    assert found[:4] == pytest.approx(expected, rel=2e-3)
    # a contact whose relay has fallen back coasts: teeth are twice as deep as where it lands on mu_k N
    landed = np.diff(releases(drag_wheel(robot, head, step), step))
    span = (robot.mu_static - robot.mu_kinetic) * robot.mass * GRAVITY / 4.0
    assert landed == pytest.approx(span / robot.stiffness[1] / speed, rel=0.03)
    assert np.diff(expected).min() > 2.0 * landed.mean()


def test_the_kinetic_term_that_the_thesis_drops_stops_a_contact(robot: Robot) -> None:
    """Beside it a contact coasts less far, so that teeth are less deep."""
    printed = robot.with_contact("printed_6_4")
    depth = [np.ptp(simulate(printed, pull(duration=8.0), release_drag=share)["force"][5000:]) for share in (0.0, 1.0)]
    assert depth[1] < 0.8 * depth[0]


def test_wheels_do_not_pull_at_the_floor_under_the_printed_law(robot: Robot) -> None:
    tossed = free_response("pitch", 0.004, 0.5)
    loads = [f"load_{wheel}" for wheel in (1, 2, 3, 4)]
    least = [
        min(simulate(robot.with_contact(law), tossed)[name].min() for name in loads) for law in ("printed_6_4", "relay")
    ]
    assert least[0] == 0.0
    assert least[1] < -50.0


def test_under_the_cone_by_name_and_by_its_speed_the_answers_are_the_same(robot: Robot) -> None:
    run = free_response("roll", 0.002, 0.5)
    assert np.array_equal(
        simulate(robot.with_contact("cone"), run).values, simulate(robot.sliding_together(), run).values
    )
    assert robot.with_contact("relay").sliding_together().sliding_speed == 0.0


def test_printed_pulls_in_lanes(robot: Robot) -> None:
    robots = [replace(robot.with_contact("printed_6_4"), mu_static=0.8 + 0.02 * i) for i in range(4)]
    together = simulate_alike([(one, {}, pull(duration=4.0)) for one in robots], 100.0, 1e-4, ("force", "ay"))
    for one, found in zip(robots, together, strict=True):
        alone = simulate(one, pull(duration=4.0), 100.0, 1e-4)
        assert np.array_equal(found, np.column_stack([alone["force"], alone["ay"]]))


def test_a_file_chooses_the_law(tmp_path: Path) -> None:
    known = replace(read_parameters("p3at-extended"), choices={"tire.contact": "printed_6_4"})
    file = tmp_path / "robot.yaml"
    write_parameters(file, known)
    again = read_parameters(file)
    assert again.choices == known.choices
    assert robot_from_parameters(again).contact == "printed_6_4"
    file.write_text(file.read_text(encoding="utf-8").replace("printed_6_4", "printed"), encoding="utf-8")
    with pytest.raises(InputError, match=r"tire\.contact: is 'printed'.*printed_6_4"):
        read_parameters(file)
