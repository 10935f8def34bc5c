"""Runs of one kind, ready to be simulated: the same role, the same wheel speeds."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.compare.turning import AXES, wanted_rates
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Recording
from ssmr_ident.doctor.swivels.likelihood import NEPER_DB, log_variance
from ssmr_ident.doctor.swivels.spectra import Look, average, look
from ssmr_ident.experiments import Experiment
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.signals.noise import line_power, quietest_density

SHORTEST = 4.0  # s; shorter records are starting and stopping, and hold too few segments
LONGEST = 40.0  # s of simulation; a density is known to 16 % by then
STEADY = 12.0  # s of simulation at constant wheel speeds, for each of several seeds
SETTLING = 2.0  # s
AT_LENGTH, BRIEFEST = 5, 6.0
"""Conditions that a search simulates at their length; of more, each as much less [s]: chance averages over them."""


@dataclass(frozen=True, eq=False)
class Condition:
    """Runs of one role and one course of wheel speeds.

    Parameters
    ----------
    role : str
        ``calibration``, ``target`` or ``heldout``.
    experiment : Experiment
    recordings : tuple of str
    looks : tuple of Look
        One per recording.
    mean : Look
    names : tuple of str
        Channels.
    noise : (c,) float [(m/s^2)^2/Hz]
    disturbance : (c,) float [m/s^2]
        Standard deviation of noise and mains together, which widen the extremes.
    rates : (k, 2) float [rad/s]
        Wanted of the wheels, at multiples of ``rate_step`` [s].
    settling, duration : float [s]
    turning : float [rad/s]
        Yaw rate that the wheels ask for.
    yaw_rate : float or None [rad/s]
        Measured mean of the gyroscope.
    halves_db : float
        Distance of the spectra of two halves of a record, mean over records and channels [dB].
    wander : float
        Variance of log densities between runs beyond chance, as the halves of records show it: some swivels change
        between two ways of shaking, and two runs of them differ by more than Welch's scatter.
    """

    role: str
    experiment: Experiment
    recordings: tuple[str, ...]
    looks: tuple[Look, ...]
    mean: Look
    names: tuple[str, ...]
    noise: np.ndarray
    disturbance: np.ndarray
    rates: np.ndarray
    rate_step: float
    settling: float
    duration: float
    turning: float
    yaw_rate: float | None
    halves_db: float
    wander: float

    @property
    def kind(self) -> tuple:
        """What a simulation of it depends on."""
        return (self.experiment, self.names, self.rates.tobytes(), self.rate_step, self.settling, self.duration,
                len(self.mean.frequency))  # fmt: skip


def brief(conditions: tuple[Condition, ...], among: int) -> tuple[Condition, ...]:
    """The same conditions for a search over ``among`` of them: what is simulated of each steady course."""
    seconds = max(BRIEFEST, STEADY * min(1.0, AT_LENGTH / max(among, 1)))
    return tuple(replace(c, duration=min(c.duration, seconds)) if c.settling else c for c in conditions)


HELD_SHARE = 0.35  # of a record's end, kept back where no whole recording can be


def held_back(campaign: Campaign) -> tuple[tuple[Measurement, ...], tuple[str, ...]]:
    """The measurements, some of them turned into heldout ones where the session names none, and a note on which.

    With three or more target speeds the middle one is kept back; with fewer, the end of every target record.
    """
    turning = [m for m in campaign.measurements if not m.experiment.repeats]
    targets = [m for m in turning if m.entry.role == "target" and m.recording.duration >= SHORTEST]
    if any(m.entry.role == "heldout" and m.recording.duration >= SHORTEST for m in turning) or not targets:
        return tuple(turning), ()
    speeds = sorted({_asked(m) for m in targets})
    if len(speeds) >= 3:
        middle = speeds[len(speeds) // 2]
        kept = [m for m in targets if _asked(m) == middle]
        names = {m.name for m in kept}
        changed = [replace(m, entry=replace(m.entry, role="heldout")) if m.name in names else m for m in turning]
        return tuple(changed), (f"kept back and never fitted: {', '.join(sorted(names))}",)
    parts: list[Measurement] = []
    for m in turning:
        if m.entry.role != "target" or m.recording.duration < 3.0 * SHORTEST:
            parts.append(m)
            continue
        first, last = _cut(m.recording, 1.0 - HELD_SHARE)
        end = replace(m.entry, role="heldout", file=f"{m.entry.file} (its last {HELD_SHARE:.0%})")
        parts += [replace(m, recording=first), replace(m, recording=last, entry=end)]
    if len(parts) == len(turning):
        return tuple(turning), ("records too short to keep a part back: the improvement is on what was fitted",)
    return tuple(parts), (f"kept back and never fitted: the last {HELD_SHARE:.0%} of every target recording",)


def _asked(m: Measurement) -> float:
    for value in (m.entry.yaw_rate_deg_s, m.entry.wheel_speed_m_s):
        if value is not None:
            return abs(float(value))
    return 0.0


def _cut(recording: Recording, share: float) -> tuple[Recording, Recording]:
    middle = round(share * len(recording.time))

    def part(samples: slice) -> Recording:
        channels = tuple(replace(c, samples=c.samples[samples]) for c in recording.channels)
        return replace(recording, time=recording.time[samples], channels=channels)

    return part(slice(None, middle)), part(slice(middle, None))


def conditions_of(
    campaign: Campaign, parameters: ParameterSet, measurements: tuple[Measurement, ...] | None = None
) -> tuple[tuple[Condition, ...], tuple[str, ...]]:
    """All swivels and straight runs of a campaign by kind, and notes about what was passed over.

    Raises
    ------
    InputError
        No recording is long enough.
    """
    robot = robot_from_parameters(parameters)
    kinds: dict[tuple, list[Measurement]] = defaultdict(list)
    notes = []
    for m in campaign.measurements if measurements is None else measurements:
        if m.experiment.repeats:
            continue
        if m.recording.duration < SHORTEST:
            notes.append(f"{m.name} lasts {m.recording.duration:.1f} s: too short for a spectrum, passed over")
            continue
        rates, step, _ = wanted_rates(robot, m)
        channels = tuple(name for name in AXES if name in m.recording)
        kinds[m.entry.role, m.experiment, rates.tobytes(), step, channels].append(m)
    if not kinds:
        raise InputError(
            str(campaign.session.folder),
            f"holds no swivel of {SHORTEST:g} s or more",
            "Record at least 10 s of steady turning",
        )
    return tuple(_condition(robot, list(group)) for group in kinds.values()), tuple(notes)


def _condition(robot: Robot, group: list[Measurement]) -> Condition:
    first = group[0]
    rates, step, settling = wanted_rates(robot, first)
    names = tuple(name for name in AXES if name in first.recording)
    looks, noises, spreads, turns, halves = [], [], [], [], []
    for m in group:
        even = even_samples(m.recording.time, np.column_stack([m.recording[name] for name in names]))
        looks.append(look(even.samples, even.sample_rate))
        halves.append(_halves(even.samples, even.sample_rate))
        noises.append(quietest_density(even.samples, even.sample_rate))
        spreads.append(_disturbance(even.samples, even.sample_rate, noises[-1]))
        if "wz" in m.recording:
            turns.append(float(np.mean(m.recording["wz"])))
    asked = rates.mean(axis=0) * robot.radius
    # a steady course is simulated for one length, so that runs of one speed are one simulation
    duration = STEADY if settling else min(LONGEST, max(m.recording.duration for m in group))
    return Condition(
        role=first.entry.role,
        experiment=first.experiment,
        recordings=tuple(m.name for m in group),
        looks=tuple(looks),
        mean=average(looks),
        names=names,
        noise=np.mean(noises, axis=0),
        disturbance=np.mean(spreads, axis=0),
        rates=rates,
        rate_step=step,
        settling=SETTLING if settling else 0.0,
        duration=duration,
        turning=float((asked[1] - asked[0]) / (2.0 * robot.half_track)),
        yaw_rate=float(np.mean(turns)) if turns else None,
        halves_db=float(np.mean(np.sqrt(halves))) * NEPER_DB,
        wander=_wander(halves, looks),
    )


def _halves(samples: np.ndarray, sample_rate: float) -> float:
    """Mean square difference of the log densities of two halves, over bins and channels."""
    half = len(samples) // 2
    logs = [np.log(np.einsum("kii->ki", look(part, sample_rate).cross)) for part in (samples[:half], samples[half:])]
    return float(np.mean((logs[0] - logs[1]) ** 2))


def _wander(halves: list[float], looks: list[Look]) -> float:
    """Halves differ by four times the variance of a whole by chance; what is more stays for a whole of any length."""
    excess = [square - 4.0 * log_variance(one.dof) for square, one in zip(halves, looks, strict=True)]
    return 0.5 * max(float(np.mean(excess)), 0.0)


def _disturbance(samples: np.ndarray, sample_rate: float, noise: np.ndarray) -> np.ndarray:
    """Noise up to half the rate, and the mains line where the log holds it: (c,) float."""
    power = noise * sample_rate / 2.0
    if sample_rate > 130.0:
        power = power + line_power(samples, sample_rate, 60.0)
    return np.sqrt(power)
