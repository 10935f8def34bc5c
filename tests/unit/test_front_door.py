"""The public names: all there, nothing imported before it is asked for, no name of a room taken."""

from __future__ import annotations

import subprocess
import sys

import pytest

import ssmr_ident


def test_every_public_name_leads_somewhere() -> None:
    for name in ssmr_ident.__all__:
        assert getattr(ssmr_ident, name) is not None
    assert len(ssmr_ident.__all__) <= 16
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        ssmr_ident.simulat  # noqa: B018


def test_importing_the_package_imports_nothing_heavy() -> None:
    code = "import sys, ssmr_ident; print([m for m in ('numpy', 'scipy', 'numba', 'matplotlib') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_robot_is_simulated_in_three_lines() -> None:
    robot = ssmr_ident.robot_from_parameters(ssmr_ident.read_parameters("p3at-extended"))
    result = ssmr_ident.simulate_robot(robot, ssmr_ident.Scenario("free_response", 0.5, offset={"roll": 0.001}))
    assert 0.1 < abs(result["ay"]).max() < 10.0
