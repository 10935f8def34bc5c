"""Body on tires, geometry, posterior: against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.body.coupled import body_modes, plane_modes, vibration_modes
from ssmr_ident.identify.forces.pull_model import pull_stiffness
from ssmr_ident.identify.geometry.mass_properties import assemble, box, from_two_weighings, height_from_tilting
from ssmr_ident.identify.posterior.findings import conflicts, posterior_findings
from ssmr_ident.identify.posterior.most_probable import Observation, Unknown, most_probable
from ssmr_ident.physics.robot import GRAVITY
from ssmr_ident.session import read_parameters


def robot_file() -> ParameterSet:
    return read_parameters("p3at-extended")


def test_plane_modes_against_the_determinant() -> None:
    """Roots of det(s) of section 5, expanded by hand."""
    mass, inertia, k_y, d_y, k_z, d_z, h, c = 32.0, 1.21, 18000.0, 30.0, 80000.0, 70.0, 0.23, 0.18
    side = np.array([mass, 4 * d_y, 4 * k_y])
    cross = np.array([4 * h * d_y, 4 * h * k_y])
    roll = np.array([inertia, 4 * (h**2 * d_y + c**2 * d_z), 4 * (h**2 * k_y + c**2 * k_z) - mass * GRAVITY * h])
    roots = np.roots(np.polysub(np.polymul(side, roll), np.polymul(cross, cross)))
    roots = roots[roots.imag > 0]
    roots = roots[np.argsort(np.abs(roots))]
    modes = plane_modes(mass, inertia, (k_y, d_y), (k_z, d_z), h, c)
    np.testing.assert_allclose(modes.natural, np.abs(roots), rtol=1e-9)
    np.testing.assert_allclose(modes.xi, -roots.real / np.abs(roots), rtol=1e-9)


def test_body_modes_of_a_symmetric_robot_are_the_plane_modes() -> None:
    parameters = robot_file()
    builder = RobotBuilder.of(parameters)
    robot = builder({"inertia_kg_m2.xz": 0.0})
    points = robot.contact_points.copy()
    points[:, 0] = [-0.14, 0.14, 0.14, -0.14]
    inertia = np.diag(np.diag(robot.inertia))
    robot = robot.with_changes(contact_points=points, inertia=inertia)
    found = body_modes(robot)
    # at rest the tires are pressed in, so the arms are shorter by m g / (4 K_z)
    height = robot.height - robot.mass * GRAVITY / (4 * robot.stiffness[2])
    side = [(robot.stiffness[k], robot.damping[k]) for k in range(3)]
    roll = plane_modes(robot.mass, inertia[0, 0], side[1], side[2], robot.height, robot.half_track)
    pitch = plane_modes(robot.mass, inertia[1, 1], side[0], side[2], robot.height, 0.14)
    assert found["roll"] == pytest.approx((roll.natural[0], roll.xi[0]), rel=2e-3)
    assert found["pitch"] == pytest.approx((pitch.natural[0], pitch.xi[0]), rel=2e-3)
    assert height < robot.height


def test_overdamped_motion_is_no_mode() -> None:
    modes = vibration_modes(np.eye(1), np.array([[10.0]]), np.array([[1.0]]))
    assert len(modes.natural) == 0


def test_pull_stiffness_limits() -> None:
    robot = RobotBuilder.of(robot_file())({})
    stiff = robot.with_changes(stiffness=np.array([3000.0, 18000.0, 1e12]))
    # nothing tilts and the hook pulls through the centre of the contacts: four tires side by side
    centred = stiff.contact_points.copy()
    centred[:, 0] = [-0.14, 0.14, 0.14, -0.14]
    stiff = stiff.with_changes(contact_points=centred)
    assert pull_stiffness(stiff, "lateral", 0.0, cable_stiffness=np.inf) == pytest.approx(4 * 18000, rel=1e-3)
    assert pull_stiffness(stiff, "longitudinal", 0.0, cable_stiffness=np.inf) == pytest.approx(4 * 3000, rel=1e-3)
    both = pull_stiffness(stiff, "lateral", 0.0, cable_stiffness=72000.0)
    assert both == pytest.approx(36000, rel=1e-3)
    assert pull_stiffness(robot, "lateral", 0.05) < 4 * 18000


def test_weighing_and_tilting() -> None:
    place = from_two_weighings(15.0, 13.0, 0.28, 0.05)
    assert place.value == pytest.approx(0.15)
    h, c, y = 0.23, 0.18, 0.01
    height, offset = height_from_tilting(np.arctan((c - y) / h), np.arctan((c + y) / h), c, np.radians(0.2))
    assert (height.value, offset.value) == pytest.approx((h, y))
    rng = np.random.default_rng(0)
    trials = [
        height_from_tilting(np.arctan((c - y) / h) + e[0], np.arctan((c + y) / h) + e[1], c, 1.0)
        for e in np.radians(0.2) * rng.normal(size=(2000, 2))
    ]
    assert np.std([t[0].value for t in trials]) == pytest.approx(height.std, rel=0.06)
    assert np.std([t[1].value for t in trials]) == pytest.approx(offset.std, rel=0.06)


def test_parallel_axes() -> None:
    """Two halves of a box make the box."""
    whole = box(6.0, (0.4, 0.2, 0.1), (0, 0, 0))
    halves = assemble([box(3.0, (0.2, 0.2, 0.1), (x, 0, 0)) for x in (-0.1, 0.1)])
    np.testing.assert_allclose(halves.inertia, whole.inertia, atol=1e-12)
    assert halves.mass == 6.0
    np.testing.assert_allclose(halves.place, 0, atol=1e-15)


def test_posterior_of_a_linear_problem_is_the_closed_form() -> None:
    unknowns = [Unknown("a", "1", 1.0, 0.5, positive=False), Unknown("b", "1", 2.0, 1.0, positive=False)]
    matrix, variance = np.array([[1.0, 1.0]]), 0.1
    observation = Observation(
        "sum", ("a + b",), np.array([4.0]), np.array([[variance]]), lambda v: matrix @ np.array([v["a"], v["b"]])
    )
    found = most_probable(unknowns, [observation])
    prior = np.diag([0.25, 1.0])
    gain = prior @ matrix.T / (matrix @ prior @ matrix.T + variance)
    expected = np.array([1.0, 2.0]) + (gain @ np.array([1.0])).ravel()
    covariance = prior - gain @ matrix @ prior
    np.testing.assert_allclose(found.values, expected, rtol=1e-8)
    np.testing.assert_allclose(found.stds, np.sqrt(np.diag(covariance)), rtol=1e-6)
    assert found.excess == 1.0


def test_findings_name_conflict_and_what_is_unexplained() -> None:
    unknowns = [Unknown("inertia", "kg m^2", 1.21, 0.1), Unknown("idle", "1", 1.0, 0.2)]
    one = Observation("roll", ("I",), np.array([9.8]), np.array([[0.01]]), lambda v: np.array([v["inertia"]]))
    found = most_probable(unknowns, [one])
    assert conflicts(found)[0]["parameter"] == "inertia"
    assert "conflict" in posterior_findings(found)[0]
    assert found.information_share[1] == pytest.approx(0.0, abs=1e-9)
    assert found["idle"][1] == pytest.approx(0.2)
    other = Observation("pitch", ("I",), np.array([2.0]), np.array([[0.01]]), lambda v: np.array([v["inertia"]]))
    text = " ".join(posterior_findings(most_probable(unknowns, [one, other])))
    assert "not explained" in text
    assert "misses something" in text


def test_negative_damping_is_said() -> None:
    unknown = Unknown("tire.damping_y_N_s_m", "N s/m", 30.0, 15.0, positive=False)
    seen = Observation("x", ("d",), np.array([-20.0]), np.array([[1.0]]), lambda v: np.array([v[unknown.name]]))
    assert any("negative" in text for text in posterior_findings(most_probable([unknown], [seen])))
