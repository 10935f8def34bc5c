"""`ident new` on logs of two accelerometers: a network where two modes are seen, a rig where one is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from made_networks import write_log

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import load
from ssmr_ident.physics.network import network_from_parameters
from ssmr_ident.workflows.new.run import Told, draft_session

TIME = np.arange(6000) / 600.0


def log(folder: Path, shapes: list[tuple[float, tuple[float, float]]]) -> Path:
    """A blow at the second sensor's place; modes by frequency [Hz] and shape."""
    random = np.random.default_rng(1)
    blow = np.exp(-(((TIME - 0.2) / 0.002) ** 2))
    columns = {"hammer [N]": 10.0 * blow}
    motion = np.zeros((len(TIME), 2))
    for hz, shape in shapes:
        ring = np.where(TIME > 0.2, np.exp(-0.01 * 2 * np.pi * hz * (TIME - 0.2)), 0.0)
        motion += np.outer(hz * ring * -np.sin(2 * np.pi * hz * (TIME - 0.2)), np.multiply(shape, shape[1]))
    motion += 0.01 * random.standard_normal(motion.shape)
    write_log(folder / "hit.csv", TIME, columns | {"a1 [m/s^2]": motion[:, 0], "a2 [m/s^2]": motion[:, 1]})
    return folder


def test_two_modes_are_two_bodies(tmp_path: Path) -> None:
    draft = draft_session(log(tmp_path, [(12.0, (1.0, 0.8)), (17.0, (-0.7, 1.0))]))
    assert draft.baseline == "network"
    channels = draft.guesses[0].fields["channels"]
    assert channels["force"] == {"column": "hammer", "body": "body_2"}
    draft.write()
    hz = network_from_parameters(load(tmp_path).parameters).modes()[0]
    np.testing.assert_allclose(hz, [12.0, 17.0], rtol=0.02)


def test_one_mode_is_a_rig(tmp_path: Path) -> None:
    folder = log(tmp_path, [(12.0, (1.0, 0.8))])
    assert draft_session(folder).baseline == "sdof"
    with pytest.raises(InputError, match="--baseline: network needs accelerations"):
        draft_session(folder, Told(baseline="network"))
