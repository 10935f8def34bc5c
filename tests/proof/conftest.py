"""A diagnosis that is no diagnosis, and extents small enough for a test."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from ssmr_proof.lab.case import Extent
from ssmr_proof.lab.decays import Programme
from ssmr_proof.lab.pulls import TESTS
from ssmr_proof.lab.rigs import RUNS

HERE = Path(__file__).parent


@pytest.fixture(scope="session", autouse=True)
def engine() -> object:
    """MuJoCo; all tests here skip when it is not installed."""
    return pytest.importorskip("mujoco", reason="needs the extra proof")


@pytest.fixture(scope="session")
def tiny() -> Extent:
    """A few seconds of everything."""
    return Extent(Programme(("roll", "yaw"), ("pitch",), 1024), (TESTS[1], TESTS[6]), (RUNS[1], RUNS[6]), 1.5)


@pytest.fixture(scope="session")
def pretended() -> tuple[str, ...]:
    """A command that answers at random, in the contract's files."""
    return (sys.executable, str(HERE / "pretended_diagnosis.py"), "{session}", "{out}")
