"""What converters and sensors do within their sheets is no physics that is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import NOISE, Run, campaign

from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

RELEASES = (1e-3, -8e-4, 6e-4, -4e-4, 9e-4)


def drifting(effects: dict, size: float, seed: int = 1) -> Campaign:
    """A rig let go five times, its sensor's zero falling by ``size`` deviations of the noise to either side."""
    made = campaign(effects, [Run(release=r) for r in RELEASES], seed=seed, duration=2.0)
    changed = []
    for measurement in made.measurements:
        (channel,) = measurement.recording.channels
        samples = channel.samples + size * NOISE * np.linspace(1.0, -1.0, len(channel.samples))
        recording = replace(measurement.recording, channels=(replace(channel, samples=samples),))
        changed.append(replace(measurement, recording=recording))
    return replace(made, measurements=tuple(changed))


@pytest.mark.parametrize("size", [0.5, 2.0])
def test_a_zero_that_drifts_is_no_spring_that_is_stiffer_to_one_side(size: float) -> None:
    assert diagnose(drifting({}, size)).verdict == "nothing_missing"


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_a_spring_that_is_stiffer_to_one_side_is_found_beside_it(seed: int) -> None:
    found = diagnose(drifting({"unlisted": {"c_abs_s_N_m": 3000.0}}, 1.0, seed))
    (effect,) = found.effects
    assert effect.id == "unlisted"
    stiffer = effect.parameters["c_abs_s_N_m"]
    assert stiffer.std == pytest.approx(100.0, rel=0.2)
    assert stiffer.value == pytest.approx(3000.0, abs=3.0 * stiffer.std)


def test_steps_of_a_converter_are_noise() -> None:
    """Of four deviations of the noise: a tail that rests within one step shows no noise at all."""
    made = drifting({}, 0.0)
    changed = []
    for measurement in made.measurements:
        (channel,) = measurement.recording.channels
        step = 4.0 * NOISE
        recording = replace(
            measurement.recording,
            channels=(replace(channel, samples=step * np.round(channel.samples / step)),),
        )
        changed.append(replace(measurement, recording=recording))
    found = diagnose(replace(made, measurements=tuple(changed)))
    assert found.verdict == "nothing_missing"
    assert found.heldout.before == pytest.approx(found.heldout.noise_floor, rel=0.3)
