"""What an experiment is: what sets the system in motion, what is logged, and how a model is held against the log."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments.conditions import Conditions
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.robot import Robot

ROBOT = ("rigid6", "decoupled")
"""Baselines of a session that stand for a robot; the others are a rig (``sdof``), a network of bodies, and a dragged
block (``drag``)."""

RIGS = ("sdof", "network")
"""Baselines of bodies on springs, driven by a measured force, by their foot, or let go."""

BASES = ("base_acceleration", "base_position")
"""Channels of the foot that a rig stands on."""

ACCELERATIONS = ("ax", "ay", "az")
"""Channels of a robot's accelerometers."""


class Drive(Enum):
    """What sets the system in motion while it is recorded."""

    NOTHING = "nothing: it was let go or struck"
    FORCE = "a measured force or torque"
    BASE = "the measured motion of the foot that it stands on"
    HEAD = "the head of a testing machine"
    WHEELS = "the robot's own wheels"


class Likelihood(Enum):
    """By what a model is held against a recording, and what pages draw of the two."""

    WAVEFORM = "the motion, sample by sample"
    FORCE = "the force in averages over short blocks, and the teeth of stick-slip by their sizes"
    SPECTRUM = "power spectra and extremes, for no second run has the same waveform"


@dataclass(frozen=True)
class Experiment(Shown):
    """One kind of experiment.

    Parameters
    ----------
    name : str
        As session.yaml, ``--experiment`` and the effects' files have it.
    sentence : str
        What is done.
    verb : str
        The same as an order, in one word.
    drive : Drive
    channels : tuple of tuple of str
        What has to be logged: of each group at least one. The last group is what answers, drives stand before it.
    likelihood : Likelihood
    baselines : tuple of str
        Baselines of a session that predict it.
    nuisances : tuple of str
        What differs from one recording to the next, is refitted for each, and says nothing of the physics.
    file_words : tuple of str
        Words in a file's name that hint at it.
    duration : float [s]
        Of a simulated recording, unless another is asked for.
    sample_rate : float [Hz]
        The same: accelerometers are logged at 1 kHz, a testing machine at 100 Hz.
    wheel_axis : {"", "y", "z"}
        Axis along which a single wheel is loaded on a bench, apart from its robot; empty for anything whole.
    wheel_signs : (float, float)
        Signs of the speeds that the left and the right wheels are asked for.
    scenario : callable or None
        ``scenario(robot, conditions, duration)`` is what the robot's simulator runs; None where that is a bench or a
        rig.
    effect_checks : callable or None
        ``effect_checks(robot, seconds)``: what an effect is switched on and off in, to see that it keeps its promises;
        ``seconds`` are long enough for contacts to let go, or shorter.
    """

    name: str
    sentence: str
    verb: str
    drive: Drive
    channels: tuple[tuple[str, ...], ...]
    likelihood: Likelihood
    baselines: tuple[str, ...]
    nuisances: tuple[str, ...]
    file_words: tuple[str, ...]
    duration: float = 4.0
    sample_rate: float = 1000.0
    wheel_axis: str = ""
    wheel_signs: tuple[float, float] = (0.0, 0.0)
    scenario: Callable[[Robot, Conditions, float], Scenario] | None = None
    effect_checks: Callable[[Robot, float], tuple[Scenario, ...]] | None = None

    @property
    def words(self) -> str:
        """The name as it is read."""
        return self.name.replace("_", " ")

    @property
    def free(self) -> bool:
        """Whether the system swings by itself: its poles alone shape the recording, and it begins somewhere."""
        return self.drive is Drive.NOTHING

    @property
    def driven(self) -> bool:
        """Whether something measured keeps the phase of the motion."""
        return self.drive in (Drive.FORCE, Drive.BASE)

    @property
    def on_a_base(self) -> bool:
        """Whether the foot drives it: what the mass does is then absolute, and nothing tells the mass."""
        return self.drive is Drive.BASE

    @property
    def on_a_testing_machine(self) -> bool:
        """Whether a head moves and a load cell reads."""
        return self.drive is Drive.HEAD

    @property
    def on_wheels(self) -> bool:
        """Whether the robot drives itself."""
        return self.drive is Drive.WHEELS

    @property
    def of_one_wheel(self) -> bool:
        """Whether one wheel is tested by itself: no body swings on it, and a quarter of the weight is on it."""
        return self.wheel_axis != ""

    @property
    def drags_everything(self) -> bool:
        """Whether a head drags the whole robot or block, until it slides on all its contacts."""
        return self.on_a_testing_machine and not self.of_one_wheel

    @property
    def vertical(self) -> bool:
        """Whether the load cell reads a load, where others read what a tire holds along the ground."""
        return self.wheel_axis == "z"

    @property
    def turns(self) -> bool:
        """Whether the robot turns on the spot: its wheels run against each other."""
        return self.wheel_signs[0] != self.wheel_signs[1]

    @property
    def repeats(self) -> bool:
        """Whether a second run gives the same again, so that a fit can follow each recording."""
        return self.likelihood is not Likelihood.SPECTRUM

    def fitted_under(self, baseline: str) -> bool:
        """Whether fits of a session with this baseline follow it."""
        return self.repeats and baseline in self.baselines

    def shows(self, effect: Effect) -> bool:
        """Whether an effect can be seen in it, as the effect's own file says."""
        return self.name in effect.experiments

    def __str__(self) -> str:
        groups = "; ".join(" or ".join(group) for group in self.channels)
        return "\n".join(
            [
                f"{self.name}: {self.sentence}",
                f"  driven by   {self.drive.value}",
                f"  logged      {groups}",
                f"  compared by {self.likelihood.value}",
                f"  baselines   {', '.join(self.baselines)}",
                f"  differs     {', '.join(self.nuisances)}",
                f"  simulated   {self.duration:g} s at {self.sample_rate:g} Hz",
            ]
        )
