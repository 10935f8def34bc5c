"""Do reported intervals hold? Random robots are drawn from the priors, simulated, and fitted; one table is printed.

Each robot's truth is drawn from what ``data/raw/free_response/robot.yaml`` says a lab would know. The full simulator
makes two decays of each motion (4.1 s at 1 kHz, white noise 0.02 m/s², mains line 0.06 m/s²); ``fit_body`` fits them
with those same priors. Printed per parameter: share of robots whose true value lies in the 95 % interval, median
posterior over prior standard deviation, and the root mean square of (fitted − true)/std. Run it as
``python benchmarks/bench_recovery.py [ROBOTS]``.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.body.coupled import body_modes
from ssmr_ident.identify.body.free_decays import BodyDecay, body_decay
from ssmr_ident.identify.body.tire_parameters import MOTIONS
from ssmr_ident.identify.posterior.most_probable import Unknown
from ssmr_ident.identify.robot.fit import BodyFit, fit_body
from ssmr_ident.identify.robot.unknowns import robot_unknowns
from ssmr_ident.physics.linear import COORDINATES, accelerometer_rows, linear_robot
from ssmr_ident.physics.robot import GRAVITY, Robot
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate.simulation import simulate

PRIORS = Path(__file__).resolve().parents[1] / "data" / "raw" / "free_response" / "robot.yaml"
RATE, SECONDS, TRIALS = 1000.0, 4.096, 2
NOISE, HUM = 0.02, 0.06
PEAK = 0.9
"""Largest acceleration of a decay's main mode [m/s²], as in data/raw; contacts stick."""

SIDE = 0.1
"""Standard deviation of each other mode's share of it."""


@dataclass(frozen=True)
class Recovered:
    """One robot.

    Parameters
    ----------
    names : tuple of str
    truth, values, stds, prior_stds : (p,) float
    flat : int
        Directions with less than a hundredth of the prior's information.
    fit : BodyFit
    """

    names: tuple[str, ...]
    truth: np.ndarray
    values: np.ndarray
    stds: np.ndarray
    prior_stds: np.ndarray
    flat: int
    fit: BodyFit

    @property
    def scores(self) -> np.ndarray:
        """(p,) float, (fitted − true)/std."""
        return (self.values - self.truth) / self.stds


def unknowns_of_decays() -> tuple[tuple[Unknown, ...], RobotBuilder]:
    """Unknowns that a decay feels, with the priors of the file."""
    parameters = read_parameters(PRIORS)
    unknowns = tuple(u for u in robot_unknowns(parameters) if "mu_" not in u.name)
    return unknowns, RobotBuilder.of(parameters)


def draw(unknowns: tuple[Unknown, ...], rng: np.random.Generator) -> dict[str, float]:
    """True values from the priors; a damping below a tenth of its prior is drawn again, for tires are passive."""
    truth = {}
    for unknown in unknowns:
        value = -np.inf
        while value < 0.1 * unknown.prior or value == -np.inf:
            value = unknown.value(float(rng.standard_normal()))
            if not unknown.name.startswith("tire.damping"):
                break
        truth[unknown.name] = float(value)
    return truth


def start_of(robot: Robot, motion: str, rng: np.random.Generator) -> np.ndarray:
    """Displacements and velocities that excite the main mode of a motion, and every other mode a little; (12,)."""
    linear = linear_robot(robot)
    poles, vectors = np.linalg.eig(linear.state_matrix)
    rows = accelerometer_rows(linear, robot.accelerometer.position, GRAVITY)
    expected = body_modes(robot)[motion][0]
    upper = [k for k in range(len(poles)) if poles[k].imag > 0]
    main = min(upper, key=lambda k: abs(abs(poles[k]) - expected))
    start = np.zeros(12)
    for k in upper:
        size = PEAK * rng.uniform(0.7, 1.0) if k == main else SIDE * PEAK * rng.standard_normal()
        phase = np.exp(1j * rng.uniform(0, 2 * np.pi))
        start += size * (phase * vectors[:, k]).real / np.max(np.abs(rows @ vectors[:, k]))
    return start


def recordings(robot: Robot, rng: np.random.Generator) -> list[BodyDecay]:
    """Decays of all motions by the full simulator, with noise and mains line."""
    found = []
    for motion in MOTIONS:
        for trial in range(TRIALS):
            start = start_of(robot, motion, rng)
            offset = dict(zip(COORDINATES, map(float, start[:6]), strict=True))
            velocity = dict(zip(COORDINATES, map(float, start[6:]), strict=True))
            scenario = Scenario("free_response", SECONDS, offset=offset, velocity=velocity)
            run = simulate(robot, scenario, RATE, step=1e-4)
            samples = run.values[:, :3] + NOISE * rng.standard_normal((len(run.time), 3))
            samples += HUM * np.sin(2 * np.pi * 60.0 * run.time + rng.uniform(0, 2 * np.pi))[:, None]
            channels = [(axis, samples[:, axis]) for axis in range(3)]
            bandwidth = robot.accelerometer.bandwidth_hz
            found.append(body_decay(f"{motion}-{trial + 1}", run.time, channels, bandwidth))
    return found


def recover(number: int, seed: int = 20120612) -> Recovered:
    """Draw, simulate and fit robot ``number``."""
    rng = np.random.default_rng([seed, number])
    unknowns, builder = unknowns_of_decays()
    truth = draw(unknowns, rng)
    fit = fit_body(recordings(builder(truth), rng), builder, unknowns, seed=number)
    return Recovered(
        tuple(u.name for u in unknowns),
        np.array(list(truth.values())),
        fit.posterior.values,
        fit.posterior.stds,
        np.array([u.prior_spread for u in unknowns]),
        len(fit.posterior.flat),
        fit,
    )


def main() -> None:
    robots = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    begin = time.perf_counter()
    rows = [recover(number) for number in range(robots)]
    spent = time.perf_counter() - begin
    scores = np.array([row.scores for row in rows])
    shares = np.array([row.stds / row.prior_stds for row in rows])
    covered = np.abs(scores) < 1.959964
    print(f"{robots} robots, {spent / robots:.2f} s each; 95 % intervals")
    print(f"{'parameter':<30}{'covered %':>10}{'std/prior':>11}{'rms score':>11}")
    for index, name in enumerate(rows[0].names):
        rms = float(np.sqrt(np.mean(scores[:, index] ** 2)))
        share = float(np.median(shares[:, index]))
        print(f"{name:<30}{100 * covered[:, index].mean():>10.1f}{share:>11.3f}{rms:>11.2f}")
    print(f"{'all':<30}{100 * covered.mean():>10.1f}{'':>11}{float(np.sqrt(np.mean(scores**2))):>11.2f}")
    print(f"flat directions found: {sorted({row.flat for row in rows})} (theory: 1, the common factor)")
    settled = sum(row.fit.settled for row in rows)
    print(f"simulator and closed form agree in {settled} of {robots}")


if __name__ == "__main__":
    main()
