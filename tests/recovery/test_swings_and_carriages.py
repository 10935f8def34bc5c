"""Swings that friction ends, and carriages under position control: plants that are not the simulator's."""

from __future__ import annotations

from pathlib import Path

import pytest
from bank.lab_plants import Carriage, Swing

from ssmr_ident.workflows.diagnose import diagnose_session

pytestmark = pytest.mark.slow

ENCODER = 1.53e-3


@pytest.mark.parametrize(
    ("laws", "degrees", "periods"), [(("sine", "friction"), 70.0, 14.0), (("friction",), 50.0, 9.0)]
)
def test_a_swing_that_friction_ends(tmp_path: Path, laws: tuple[str, ...], degrees: float, periods: float) -> None:
    swing = Swing(laws, 0.02, 0.85, 0.003, degrees, periods, 1.1 * periods / 0.85, 200.0, ENCODER, 1)
    found = diagnose_session(swing.write(tmp_path))
    assert {e.id for e in found.effects} == {"dry_friction", *(["nonlinear_stiffness"] if "sine" in laws else [])}
    assert found.training.after < 1.3 * found.training.noise_floor


def carriage(friction: float) -> Carriage:
    return Carriage(12.0, 0.2, 1.0, friction, 0.25, 0.0, 0.04, 0.04, 3.2, 12.0, 1000.0, 1e-4, 2)


def test_a_carriage_rubs(tmp_path: Path) -> None:
    found = diagnose_session(carriage(0.3).write(tmp_path))
    assert [e.id for e in found.effects] == ["dry_friction"]
    force = found.effects[0].parameters["F_c_N"]
    assert force.std is not None
    assert abs(float(force.value) - 0.3 * 12.0) < 3.0 * force.std + 0.04


def test_a_held_command_is_no_delay(tmp_path: Path) -> None:
    found = diagnose_session(carriage(0.0).write(tmp_path))
    assert (found.verdict, found.effects) == ("nothing_missing", ())
