"""A zero that drifts within its sheet is no spring that is stiffer to one side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import NOISE, Run, campaign

from ssmr_ident.campaign import Campaign
from ssmr_ident.pipeline.diagnose import diagnose

RELEASES = (1e-3, -8e-4, 6e-4, -4e-4, 9e-4)


def drifting(effects: dict, size: float) -> Campaign:
    """A rig let go five times, its sensor's zero falling by ``size`` deviations of the noise to either side."""
    made = campaign(effects, [Run(release=r) for r in RELEASES], seed=1, duration=2.0)
    changed = []
    for measurement in made.measurements:
        (channel,) = measurement.recording.channels
        samples = channel.samples + size * NOISE * np.linspace(1.0, -1.0, len(channel.samples))
        recording = replace(measurement.recording, channels=(replace(channel, samples=samples),))
        changed.append(replace(measurement, recording=recording))
    return replace(made, measurements=tuple(changed))


@pytest.mark.parametrize("size", [0.5, 2.0])
def test_nothing_is_missing(size: float) -> None:
    assert diagnose(drifting({}, size)).verdict == "nothing_missing"


def test_a_spring_that_is_stiffer_to_one_side_is_found_beside_it() -> None:
    found = diagnose(drifting({"unlisted": {"c_abs_s_N_m": 3000.0}}, 1.0))
    (effect,) = found.effects
    assert effect.id == "unlisted"
    assert effect.parameters["c_abs_s_N_m"].value == pytest.approx(3000.0, abs=3.0 * 120.0)
