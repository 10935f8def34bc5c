"""Steady swivels, measured over several chaotic runs: how fast, about which point, with which lines and amplitudes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import Robot
from ssmr_ident.signals.filters import low_pass
from ssmr_ident.signals.spectra import power_density
from ssmr_ident.simulate import simulate

RATE = 1000.0
LIMITS = (1.0, 0.1, 0.01, 0.001, 0.0001)  # λ_max
SPEEDS = (10.0, 20.0, 30.0, 45.0, 64.0, 90.0)  # deg/s asked for
SETTLE = 4.0  # s
REPEATS = 5
WIDTH_HZ = 0.5  # bins of the power densities
FAST_HZ = (30.0, 200.0)
AXES = ("ax", "ay", "az")
LIFTING = {"wheel_lift": {"active": 1.0}}  # N >= 0 (4.15)
NEAR_HZ = 1.0  # lines nearer than the thesis' spacing of peaks are one


@dataclass(frozen=True, eq=False)
class Turn:
    """A steady swivel, over its repeats.

    Parameters
    ----------
    turned : float
        Yaw rate over the one asked for.
    lateral, lateral_rms : float [m/s]
        Mean and rms of the CoM's sideways velocity.
    shift : float [m]
        Where along x the robot turns about: 0 at the CoM, b at the front axle.
    lines : (3,) float [Hz]
        Where the power density of a_x, a_y, a_z, averaged over the repeats, is highest between 1 and 50 Hz.
    shares : (3,) float
        Of the power in that band, within 1 Hz of it.
    fast_line : float [Hz]
        Highest of a_y between 30 and 200 Hz, beyond what the thesis looks at.
    amplitudes : (3,) float [m/s^2]
        (max − min)/2 below 50 Hz, as the thesis measures logs; median over the repeats.
    least_loads : (REPEATS,) float [N]
        Of all wheels, per repeat.
    """

    turned: float
    lateral: float
    lateral_rms: float
    shift: float
    lines: np.ndarray
    shares: np.ndarray
    fast_line: float
    amplitudes: np.ndarray
    least_loads: np.ndarray


def turn(robot: Robot, lambda_max: float, speed: float, release_drag: float = 0.0) -> Turn:
    """Swivel five times 20 s at a wanted speed [deg/s] on wheels that may lift, and measure the steady part.

    Stick-slip is chaotic: starts that differ by a tenth of a micrometre give other waveforms, and the highest peak of
    one log is a draw. Power densities are averaged over the repeats, as the thesis averages its three.
    """
    wanted = float(np.deg2rad(speed))
    runs = [
        simulate(
            robot.with_changes(lambda_max=lambda_max),
            replace(swivel(wheel_rates(robot, 0.0, wanted), 20.0), offset={"y": 1e-7 * repeat}),
            RATE,
            effects=LIFTING,
            release_drag=release_drag,
        )
        for repeat in range(REPEATS)
    ]
    part = slice(round(SETTLE * RATE), None)
    rate = float(np.mean([run["wz"][part].mean() for run in runs]))
    sideways = np.array([run["vy"][part] for run in runs])
    lines, shares = np.array([_main_line([run[name][part] for run in runs]) for name in AXES]).T
    smooth = np.array([[low_pass(run[name][part], RATE, 50.0) for name in AXES] for run in runs])
    return Turn(
        turned=rate / wanted,
        lateral=float(sideways.mean()),
        lateral_rms=float(np.sqrt(np.mean(sideways**2))),
        shift=-float(sideways.mean()) / rate,
        lines=lines,
        shares=shares,
        fast_line=_main_line([run["ay"][part] for run in runs], FAST_HZ)[0],
        amplitudes=np.median(0.5 * np.ptp(smooth, axis=2), axis=0),
        least_loads=np.array([min(float(run[f"load_{i}"][part].min()) for i in (1, 2, 3, 4)) for run in runs]),
    )


def _main_line(courses: list[np.ndarray], band_hz: tuple[float, float] = (1.0, 50.0)) -> tuple[float, float]:
    """Highest line of the mean power density in a band [Hz], and the share of the band's power within 1 Hz of it."""
    densities = [power_density(course, RATE, band_hz=band_hz, width_hz=WIDTH_HZ) for course in courses]
    frequency, power = densities[0].frequency, np.mean([one.density for one in densities], axis=0)
    line = float(frequency[int(np.argmax(power))])
    return line, float(power[np.abs(frequency - line) <= NEAR_HZ].sum() / power.sum())


Turns = dict[tuple[float, float], Turn]


def all_turns(robot: Robot, release_drag: float = 0.0, progress: Callable[[str], None] | None = None) -> Turns:
    """Every λ_max at every speed."""
    found: Turns = {}
    for limit in LIMITS:
        if progress:
            progress(f"swivels with λ_max = {limit:g} under {robot.contact or 'the relay'}")
        for speed in SPEEDS:
            found[limit, speed] = turn(robot, limit, speed, release_drag)
    return found
