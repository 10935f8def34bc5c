"""The swivel that is advised lies between the speeds that the session has shown."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.doctor.swivels import next_run
from ssmr_ident.session import read_parameters


@dataclass(frozen=True)
class Turn:
    turning: float
    settling: float = 1.0
    rates: np.ndarray | None = None


def outcome(*speeds: float) -> SimpleNamespace:
    rivals = [
        SimpleNamespace(id=id, anchor=SimpleNamespace(values={}), effects=id) for id in ("free_play", "hysteresis")
    ]
    turns = [replace(Turn(0.0), turning=float(np.deg2rad(speed))) for speed in speeds]
    bench = SimpleNamespace(parameters=read_parameters("p3at-extended"))
    return SimpleNamespace(screened=[], explanations=rivals, targets=turns, bench=bench, calibrated=False)


@pytest.mark.parametrize(("speeds", "wanted"), [((15.0, 50.0), "45"), ((31.0, 33.0), "33")])
def test_no_faster_than_was_recorded(speeds: tuple[float, ...], wanted: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two explanations that differ the more, the faster the robot turns."""

    def logs(_: object, turn: Turn, values: object, effects: str) -> np.ndarray:
        return np.full((4, 1), turn.turning if effects == "free_play" else 0.0)

    monkeypatch.setattr(next_run, "_logs", logs)
    told = next_run.next_run(outcome(*speeds), ("free_play", "hysteresis"))  # type: ignore[arg-type]
    assert told.startswith(f"Swivel for 20 s at {wanted} deg/s: ")
