"""What is left is judged against noise and mains, and of a pull without the jolt at which its cable tightens."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from ssmr_ident.compare.comparison import measure
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.assemble import hidden_by_jolts
from ssmr_ident.diagnose.worth import (
    grows_with_motion,
    noise_floor,
    over_any_noise,
    reddest,
    without_jolts,
    worth,
)
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.trials.pull import pull_trial
from ssmr_ident.session import Entry
from ssmr_ident.signals.noise import background_noise

RATE, SLACK = 100.0, 0.8  # Hz, s


@pytest.mark.parametrize(("spike_s", "seen"), [(SLACK, False), (4.0, True)])
def test_a_jolt_counts_unless_the_cable_tightens_there(spike_s: float, seen: bool) -> None:
    random = np.random.default_rng(11)
    time = np.arange(800) / RATE
    force = 10.0 * np.minimum(np.maximum(time - SLACK, 0.0), 2.0)
    logged = force + 0.05 * random.standard_normal(len(time))
    logged[round(spike_s * RATE) : round(spike_s * RATE) + 4] += 5.0
    known = {
        "mass_kg": Estimate(4.0, 0.1, "kg"),
        "mu_static": Estimate(0.5, 0.1, "1"),
        "mu_kinetic": Estimate(0.5, 0.1, "1"),
        "cable.stiffness_N_m": Estimate(1e4, None, "N/m"),
    }
    recording = Recording(time, (Channel("force", logged, "N"),), Provenance("made", "", "test"))
    trial = pull_trial(
        Measurement(Entry("drag.csv", "wheel_drag", speed_mm_s=1.0), recording), ParameterSet("block", known)
    )
    assert trial.jolt is not None
    assert trial.jolt[0] < SLACK < trial.jolt[1]
    whole = Prediction(time, ("force",), ("N",), logged[:, None], force[:, None], low_pass_hz=None)
    (cut,) = without_jolts(SimpleNamespace(trials=(trial,)), [whole])  # type: ignore[arg-type]
    assert measure(whole)[0] > 1.6 * noise_floor(whole)
    assert (measure(cut)[0] > 1.6 * noise_floor(cut)) is seen


@pytest.mark.parametrize(("jolt", "missed", "said"), [(30.0, 0.5, True), (0.1, 0.5, False), (30.0, -0.5, False)])
def test_an_answer_that_a_jolt_alone_makes_worse_says_so(jolt: float, missed: float, said: bool) -> None:
    random = np.random.default_rng(12)
    time = np.arange(800) / RATE
    force = 10.0 * np.minimum(time, 2.0)
    logged = force + 0.05 * random.standard_normal(len(time))
    tightens = time < 0.05

    def pull(error: float, spike: float, whole: bool) -> Prediction:
        shown = np.ones(len(time), bool) if whole else ~tightens
        simulated = force + error * np.sin(time) + spike * tightens
        return Prediction(
            time[shown], ("force",), ("N",), logged[shown, None], simulated[shown, None], low_pass_hz=None
        )

    before, after = abs(min(missed, 0.0)) * 0.2 + max(missed, 0.0), abs(min(missed, 0.0))
    whole = worth([pull(before, 0.0, True)], [pull(after, jolt, True)], ())
    words = hidden_by_jolts([whole, whole], *([[pull(e, 0.0, False)]] * 2 for e in (before, after)))
    assert [word.partition(":")[0] for word in words] == (["fitted", "held out"] if said else [])


@pytest.mark.parametrize(("rate", "hum"), [(1000.0, 0.0), (1000.0, 1.0), (500.0, 1.0)])
def test_the_floor_is_what_noise_and_mains_leave_of_the_metric(rate: float, hum: float) -> None:
    """A loud third harmonic is no noise: it does not pass the low-pass, and second differences see little else."""
    random = np.random.default_rng(7)
    time = np.arange(round(3.0 * rate)) / rate
    motion = 2.0 * np.exp(-time) * np.sin(2.0 * np.pi * 5.0 * time)
    line = np.sin(2.0 * np.pi * 60.01 * time) + 0.2 * np.sin(2.0 * np.pi * 180.03 * time + 1.0)
    logged = motion + hum * line + 0.02 * random.standard_normal(len(time))
    prediction = Prediction(time, ("ax",), ("m/s^2",), logged[:, None], motion[:, None], low_pass_hz=50.0)
    assert noise_floor(prediction) == pytest.approx(measure(prediction)[0], rel=0.1)


def test_the_floor_of_noise_whose_colour_is_known() -> None:
    """Three quarters of it below 10 Hz, of which differences see nothing."""
    random = np.random.default_rng(8)
    time = np.arange(20_000) / 1000.0
    motion = 2.0 * np.exp(-0.2 * time) * np.sin(2.0 * np.pi * 5.0 * time)
    slow = lfilter([1.0], [1.0, -0.94], random.standard_normal((6, len(time))), axis=1)
    noises = 0.02 * (random.standard_normal(slow.shape) + np.sqrt(3.0) * slow / slow.std())
    model = background_noise(list(noises.reshape(6, -1, 5).mean(axis=2)), 8)
    whole = [
        Prediction(time, ("ax",), ("m/s^2",), (motion + rest)[:, None], motion[:, None], low_pass_hz=20.0)
        for rest in noises
    ]
    known = [replace(one, noises=(model,), block=5) for one in whole]
    left = np.mean([measure(one)[0] for one in whole])
    assert np.mean([noise_floor(one) for one in whole]) < 0.6 * left
    assert np.mean([noise_floor(one) for one in known]) == pytest.approx(left, rel=0.05)
    assert reddest(known) == 1.0


@pytest.mark.parametrize(("missed", "told"), [(0.0, False), (0.05, True)])
def test_a_line_that_rings_where_the_low_pass_sets_in_does_not_follow_the_motion(missed: float, told: bool) -> None:
    random = np.random.default_rng(5)
    time = np.arange(1500) / 500.0
    found = []
    for amplitude in np.linspace(1.0, 2.0, 8):
        motion = amplitude * np.exp(-2.0 * time) * np.sin(2.0 * np.pi * 5.0 * time)
        hum = np.sin(2.0 * np.pi * 60.01 * time + random.uniform(0.0, 2.0 * np.pi))
        logged = (1.0 + missed) * motion + hum + 0.005 * random.standard_normal(len(time))
        found.append(Prediction(time, ("ax",), ("m/s^2",), logged[:, None], motion[:, None], low_pass_hz=50.0))
    assert (grows_with_motion(found) < 1e-3) is told


def test_one_recording_beyond_noise_of_any_colour_is_told_from_those_within_it() -> None:
    """White noise, noise of which three quarters are slow, and a misfit that neither can be."""
    random = np.random.default_rng(21)
    time = np.arange(3000) / 1000.0
    motion = np.exp(-time) * np.sin(2.0 * np.pi * 5.0 * time)
    white = 0.01 * random.standard_normal((2, len(time)))
    slow = lfilter([1.0], [1.0, -0.95], random.standard_normal(len(time)))
    coloured = white[1] + np.sqrt(2.9) * 0.01 * slow / slow.std()
    rests = (white[0], coloured, white[0] + 0.2 * motion)
    found = [
        Prediction(time, ("ax",), ("m/s^2",), (motion + rest)[:, None], motion[:, None], low_pass_hz=50.0)
        for rest in rests
    ]
    over = over_any_noise(found)
    assert over[0] < 0.4
    assert 0.6 < over[1] < 1.0
    assert over[2] > 3.0
