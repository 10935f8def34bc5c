"""A rig's recordings beside its parameter file: every effect that the file may hold is in the prediction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import butter, lfilter
from small_rigs import RATE, RIG, Run, campaign

from ssmr_ident.compare import predict
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.doctor.held import held_fit
from ssmr_ident.estimate.from_file import node_of
from ssmr_ident.estimate.network import followed
from ssmr_ident.estimate.problem import problem_of
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.simulate.rig import simulate_rig

NOISE = 2e-3

TRUTH = {
    "mass_kg": Estimate(RIG.mass, None, "kg", fixed=True),
    "damping_N_s_m": Estimate(RIG.damping, None, "N s/m"),
    "stiffness_N_m": Estimate(RIG.stiffness, None, "N/m"),
}


def known(effects: dict[str, dict[str, float]]) -> ParameterSet:
    blocks = {name: {key: Estimate(value) for key, value in block.items()} for name, block in effects.items()}
    return ParameterSet("rig", TRUTH, blocks)


def accelerations(effects: dict[str, dict[str, float]], force: float, seed: int = 5) -> Campaign:
    """Of the simulator, 32 times as finely as they are logged; let go, or under a smooth force."""
    made = campaign({}, [Run(release=1e-3, force=force)], seed)
    measurement, random = made.measurements[0], np.random.default_rng(seed)
    recording = measurement.recording
    pushed = recording["force"] if force else np.zeros(len(recording.time))
    motion = simulate_rig(RIG, pushed, RATE, 0.0 if force else 1e-3, oversampling=32, effects=effects)[:, 2]
    seen = Channel("acceleration", motion + NOISE * random.standard_normal(len(motion)), "m/s^2")
    channels = (seen, *(c for c in recording.channels if c.name == "force"))
    logged = Recording(recording.time, channels, Provenance("run.csv", "", "test"))
    return replace(made, measurements=(Measurement(measurement.entry, logged),))


@pytest.mark.parametrize("force", [0.0, 20.0])
@pytest.mark.parametrize(
    "effects",
    [
        {},
        {"sensor_bandwidth": {"bandwidth_hz": 30.0}},
        {"sensor_bandwidth": {"bandwidth_hz": 20.0, "order": 1.0}},
        {"sensor_saturation": {"range_m_s2": 6.0}},
        {"unlisted": {"rider_share": 0.05, "rider_Hz": 9.0, "rider_ratio": 0.05}},
        {"unlisted": {"rider_share": 0.05, "rider_Hz": 9.0, "c_v2_N_s2_m2": 200.0}},
        {"viscoelastic_relaxation": {"K_m_N_m": 6000.0, "tau_s": 0.02}},
        {"dry_friction": {"F_c_N": 0.5, "element_stiffness_N_m": 2e5}},
        {"free_play": {"gap_m": 2e-4, "rounding": 0.1}},
    ],
    ids=lambda effects: "+".join(f"{e}({', '.join(block)})" for e, block in effects.items()) or "linear",
)
def test_a_file_that_holds_the_truth_leaves_the_noise(effects: dict[str, dict[str, float]], force: float) -> None:
    made = accelerations(effects, force)
    found = predict(made, made.measurements[0], known(effects))
    left = float((found.measured - found.simulated).std())
    assert left < 1.15 * NOISE
    if effects and not (force == 0.0 and "sensor_saturation" in effects):  # and not without them
        bare = predict(made, made.measurements[0], known({}))
        assert float((bare.measured - bare.simulated).std()) > 1.5 * NOISE


def test_a_low_pass_of_first_order_is_scipys() -> None:
    """The mass by an integrator, its sensor by a digital filter, both on a grid forty times as fine."""
    fine, seconds, hz = 40, 3.0, 20.0
    time = np.arange(round(seconds * RATE) * fine) / (fine * RATE)
    force = 20.0 * np.sin(2.0 * np.pi * (5.0 + 2.0 * time) * time) * np.hanning(len(time))

    def rates(t: float, s: np.ndarray) -> list[float]:
        return [s[1], (np.interp(t, time, force) - RIG.damping * s[1] - RIG.stiffness * s[0]) / RIG.mass]

    x, v = solve_ivp(rates, (0.0, time[-1]), [0.0, 0.0], t_eval=time, rtol=1e-8, atol=1e-12, max_step=2e-3).y
    acceleration = (force - RIG.damping * v - RIG.stiffness * x) / RIG.mass
    b, a = butter(1, hz, fs=fine * RATE)
    seen = lfilter(b, a, acceleration)[::fine]
    channels = (Channel("acceleration", seen, "m/s^2"), Channel("force", force[::fine], "N"))
    made = campaign({}, [Run(force=1.0)], 1)
    logged = Measurement(made.measurements[0].entry, Recording(time[::fine], channels, Provenance("r.csv", "", "")))
    made = replace(made, measurements=(logged,))
    found = predict(made, logged, known({"sensor_bandwidth": {"bandwidth_hz": hz, "order": 1.0}}))
    assert (found.measured - found.simulated).std() < 2e-3 * seen.std()


def test_what_was_kept_back_is_found_from_a_start_that_has_lost_its_way() -> None:
    """Play makes a push of a hand's breadth at the start another motion; stretch by stretch it is found again."""
    effects = {"free_play": {"gap_m": 1e-3, "rounding": 0.05}}
    made = accelerations(effects, 60.0)
    problem = problem_of(list(made.measurements), known(effects))
    node, point = node_of(problem, known(effects))
    exact = followed(problem, node, point)
    astray = replace(exact, nuisances=tuple(n + np.array([8e-3, 0.4, *np.zeros(len(n) - 2)]) for n in exact.nuisances))
    found = held_fit(problem, exact, astray)
    assert found is not None
    assert found.chi2 < 1.2 * exact.chi2


def test_an_effect_of_a_robot_is_none_of_a_rig() -> None:
    made = accelerations({}, 20.0)
    with pytest.raises(InputError, match=r"motor_belt.*rig"):
        predict(made, made.measurements[0], known({"motor_belt": {}}))
