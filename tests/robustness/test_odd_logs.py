"""Logs that hold no experiment at all: a rig's diagnosis says one thing of each, or one line of what is wrong."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from driven_session import LOG, written

from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.experiments.campaign import load
from ssmr_ident.workflows.compare import compare_session
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

TIME = np.arange(300) / 1000
WHITE = np.random.default_rng(5).standard_normal((2, 300))
SPIKE = np.where(TIME == 0.1, 1e3, 0.0)


def _log(force: np.ndarray, acceleration: np.ndarray) -> str:
    rows = zip(TIME, force, acceleration, strict=False)
    return "time [s],F [N],a [m/s^2]\n" + "".join(f"{t:.9g},{f:.9g},{a:.9g}\n" for t, f, a in rows)


LOGS = {
    "saw teeth": LOG,
    "noise": _log(*WHITE),
    "large numbers": _log(*(1e12 * WHITE)),
    "small numbers": _log(*(1e-12 * WHITE)),
    "the largest numbers": _log(*(1e98 * WHITE)),
    "the smallest numbers": _log(*(1e-98 * WHITE)),
    "no force": _log(0.0 * TIME, WHITE[1]),
    "one number": _log(0.0 * TIME + 1.0, 0.0 * TIME + 9.81),
    "one spike": _log(SPIKE, SPIKE),
    "a dozen samples": _log(TIME[:12], TIME[:12] ** 2),
}


@pytest.mark.parametrize("log", LOGS)
def test_no_experiment(tmp_path: Path, log: str) -> None:
    written(tmp_path, log=LOGS[log])
    with suppress(InputError):
        assert diagnose(load(tmp_path), budget=5.0).verdict in ("nothing_missing", "missing_physics", "undetermined")


def test_a_model_that_answers_with_no_number_is_told_of(tmp_path: Path) -> None:
    """A cubic spring that logs of a million million newtons throw out of the numbers."""
    folder = written(tmp_path, log=LOGS["large numbers"])
    with pytest.raises(SimulationError, match=r"what the model says of log\.csv left the finite numbers"):
        compare_session(folder)
