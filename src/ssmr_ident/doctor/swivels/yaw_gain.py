"""How fast a robot turns for what its wheels ask, and what that says of its grip: quasi-static, whatever shakes.

In a steady turn on the spot at rate w the wheels' rims run at v, lengthwise they slip by v - w c and sideways by w a
(c half the track, a half the wheelbase), and what they push lengthwise balances what they hold sideways: c F_x = a F_y.
Friction against the direction of sliding, alike in all directions, has F_x/F_y = (v - w c)/(w a), so that whatever the
friction w c/v = c²/(c² + a²). A gain above or below says how much less or more the ground holds sideways at the same
slip. Under the relay of each axis with (4.10)-(4.12) F_y is at its limit and F_x = (slip/lambda_max) of it, hence
w c/v = 1 - lambda_max a/c, as long as that is above the other value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from ssmr_ident.compare.turning import wanted_rates
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.physics.robot import Robot, robot_from_parameters

BLOCK = 1.0
"""s; clocks of wheels and gyroscope may lie as far apart, so that blocks beside a start or a stop are left out, too."""
STEADY = 0.1  # of the asked yaw rate, by which it may differ in a block from the record's median


@dataclass(frozen=True, eq=False)
class YawGain(Shown):
    """Measured yaw rate over that of wheels that roll without slip.

    Parameters
    ----------
    gain, lower, upper : float
        Over all recordings, weighed by their steady seconds, and where 95 % of further ones lie.
    each : mapping of recording to (gain, steady seconds, yaw rate [rad/s])
    half_track, half_base : float [m]
        c and a.
    """

    gain: float
    lower: float
    upper: float
    each: dict[str, tuple[float, float, float]]
    half_track: float
    half_base: float

    @property
    def isotropic(self) -> float:
        """Gain under friction that is alike in all directions."""
        return self.half_track**2 / (self.half_track**2 + self.half_base**2)

    def sideways(self, gain: float) -> float:
        """Grip sideways over that lengthwise at the same slip."""
        return (1.0 / gain - 1.0) * (self.half_track / self.half_base) ** 2

    def lambda_max(self, gain: float) -> float:
        """Slip at which the grip is used up, under the relay of each axis."""
        return (1.0 - gain) * self.half_track / self.half_base

    @property
    def relay(self) -> bool:
        """Whether (4.10)-(4.12) on each axis explains it, and friction alike in all directions does not."""
        return self.lower > self.isotropic and self.lambda_max(self.lower) <= 1.0

    def __str__(self) -> str:
        return ". ".join(part for part in (self.turn, self.grip) if part)

    @property
    def turn(self) -> str:
        """How fast it turns and how it slips, in words."""
        rates = np.degrees([abs(rate) for _, _, rate in self.each.values()])
        skid = float(np.radians(rates.max())) * self.half_base
        return (
            f"the robot turns at {self.gain:.2f} (95 %: {self.lower:.2f} to {self.upper:.2f}) of the rate that its "
            f"wheels ask for (recordings: {len(self.each)}, {rates.min():.3g} to {rates.max():.3g} deg/s): wheels slip "
            f"lengthwise by {1.0 - self.gain:.2f} ({1.0 - self.upper:.2f} to {1.0 - self.lower:.2f}) and skid "
            f"sideways at up to {skid:.2g} m/s"
        )

    @property
    def grip(self) -> str:
        """What grip that asks for, in words; empty where the interval holds no turn, or a roll without slip."""
        if self.lower <= 0.0 or self.upper >= 1.0:
            return ""
        held = [self.sideways(gain) for gain in (self.gain, self.upper, self.lower)]
        text = (
            f"Friction alike in all directions would let it turn at {self.isotropic:.2f} by the file's contact "
            f"points: at the same slip the ground holds sideways {held[0]:.2f} ({held[1]:.2f} to {held[2]:.2f}) of "
            "what it holds lengthwise"
        )
        if self.relay:
            limits = [self.lambda_max(gain) for gain in (self.gain, self.upper, self.lower)]
            text += (
                f"; under a relay on each axis with (4.10)-(4.12) that is lambda_max = {limits[0]:.2f} "
                f"({limits[1]:.2f} to {limits[2]:.2f})"
            )
        elif self.upper < self.isotropic:
            text += ", as where wheels dig in, or spin"
        return text


def yaw_gain(measurements: Sequence[Measurement], parameters: ParameterSet) -> YawGain | None:
    """The gain over turns on the spot whose yaw rate was logged; None without any.

    Parameters
    ----------
    measurements : sequence of Measurement
    parameters : ParameterSet
        Contact points and wheel radius are used.
    """
    robot = robot_from_parameters(parameters)
    steady = {m.name: _steady(robot, m) for m in measurements if m.experiment.turns and "wz" in m.recording}
    steady = {name: blocks for name, blocks in steady.items() if len(blocks) > 1}
    if not steady:
        return None
    each = {
        name: (float(_gains(blocks)[0]), BLOCK * len(blocks), float(blocks[:, 1].mean()))
        for name, blocks in steady.items()
    }
    units = (
        list(steady.values()) if len(steady) > 2 else [block[None] for blocks in steady.values() for block in blocks]
    )
    gains = np.array([_gains(unit)[0] for unit in units])
    weights = np.array([_gains(unit)[1] for unit in units])
    share = weights / weights.sum()
    gain = float(share @ gains)
    scatter = float(share @ (gains - gain) ** 2) * len(units) / (len(units) - 1)
    reach = float(student.ppf(0.975, len(units) - 1) * np.sqrt(scatter * (1.0 + share @ share)))
    ahead = robot.contact_points[:, 0]
    return YawGain(gain, gain - reach, gain + reach, each, robot.half_track, float(np.abs(ahead - ahead.mean()).mean()))


def _gains(blocks: np.ndarray) -> tuple[float, float]:
    """Least squares of measured on asked rates, (n, 2) float [rad/s], through nought; and its weight."""
    weight = float(blocks[:, 0] @ blocks[:, 0])
    return float(blocks[:, 0] @ blocks[:, 1]) / weight, weight


def _steady(robot: Robot, m: Measurement) -> np.ndarray:
    """Asked and measured yaw rates of steady blocks, (n, 2) float [rad/s]."""
    rates, step, _ = wanted_rates(robot, m)
    time = m.recording.time - m.recording.time[0]
    asked = robot.radius * (rates[:, 1] - rates[:, 0]) / (2.0 * robot.half_track)
    course = np.interp(time, step * np.arange(len(asked)), asked)
    number = (time / BLOCK).astype(int)
    count = np.bincount(number)
    means = np.column_stack([np.bincount(number, part) / np.maximum(count, 1) for part in (course, m.recording["wz"])])
    whole = count >= 0.9 * np.median(count)
    usual = float(np.median(means[whole, 0]))
    near = whole & (np.abs(means[:, 0] - usual) < STEADY * abs(usual))
    if len(rates) > 1:
        beside = np.concatenate([[False], near, [False]])
        near = near & beside[:-2] & beside[2:]
    return means[near]
