"""A left-out piece of physics as a value: what it is, its parameters, and where it acts on the simulator."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.shown import Shown


class Site(Enum):
    """Where an effect enters. Kernel sites are compiled into the one simulator; the others change values.

    ==========  ======================================================================================
    ELEMENT     ``force(s, v, z, ...)``: further force of one tire or rig spring [N], against s [m], v [m/s]
    STATE       ``advance(z, s, v, step, ...)``: the element's hidden state one step later
    DRIVE       ``force(v, carried, ...)``: what the gears of a rig's drive take of the force that they carry
    FRICTION    ``coefficient(mu, ...)``: friction coefficient of a contact
    GROUND      ``height(...)``: height of the floor under a wheel [m]
    BODY        extra bodies and terms of the equations of motion
    ROBOT       ``change(robot, **parameters)``: another robot value
    SENSOR      the same, of which the accelerometer alone is another: the motion stays
    PULL        ``change(stiffness, **parameters)``: another cable
    OUTPUT      ``change(time, channels, **parameters)``: what the sensor makes of the motion
    ==========  ======================================================================================
    """

    ELEMENT = "element"
    STATE = "state"
    DRIVE = "drive"
    FRICTION = "friction"
    GROUND = "ground"
    BODY = "body"
    ROBOT = "robot"
    SENSOR = "sensor"
    PULL = "pull"
    OUTPUT = "output"


@dataclass(frozen=True)
class Sized:
    """A value in units of what a recording shows: its deflections, forces, times.

    Parameters
    ----------
    share : float
    of : str
        ``deflection`` [m], ``stiffness`` [N/m], ``force`` [N], ``time`` [s] (one radian of the motion), ``speed``
        [m/s], ``duration`` [s], ``acceleration`` [m/s^2], ``load`` [N] (largest reading of a load cell), ``rise``
        [N/m] (the most that a pull reads over how far it goes), ``reach`` [m]
        and ``slope`` [N/m] (deflection and stiffness in the direction that goes farthest), ``weight`` and
        ``beyond_weight`` [m/s^2] (what an accelerometer reads of gravity at rest, and how far the largest reading goes
        beyond it), ``reading`` [m/s^2] (``acceleration`` where no axis reads gravity), ``level_reading`` (the most of
        an axis that does not, where one does), ``mass`` [kg], ``height`` [m]
        (of a robot's centre of mass over the floor), ``swing`` [s] (one radian of the mass on its springs, across the
        robot), or a combination as in ``force/deflection^3``.
    above : str
        A size on which it stands.
    """

    share: float
    of: str
    above: str = ""

    def value(self, sizes: Mapping[str, float]) -> float:
        """In SI, for given sizes."""
        over, _, under = self.of.partition("/")
        value = self.share * _product(over, sizes) / _product(under, sizes)
        return value + sizes[self.above] if self.above else value


def _product(text: str, sizes: Mapping[str, float]) -> float:
    result = 1.0
    for factor in text.split("*") if text else ():
        name, _, power = factor.partition("^")
        result *= sizes[name] ** float(power or 1)
    return result


@dataclass(frozen=True, eq=False)
class Effect(Shown):
    """One effect of the catalogue.

    Parameters
    ----------
    id : str
        Fixed name, as in the catalogue file.
    sentence : str
        What it is, for a reader who is no specialist.
    equation : str
        TeX.
    source : str
        Where the formula is from.
    signature : str
        How it shows in a recording.
    parameters : tuple of Parameter
        Those with ``off`` switch the effect off when all of them are at it: the baseline is nested exactly.
    experiments : tuple of str
        In which it can be seen.
    acts : mapping of Site to function
    rig : bool
        Whether it also acts on a rig with one mass.
    probes : tuple of mapping of parameter to float or Sized
        Where a search for this effect looks first: parameters that are named are then fitted, the others stay at
        their nominal values; plain numbers are SI.
    rig_probes : tuple of mapping of parameter to float or Sized
        Further ones on a rig, whose recordings are long and simulated in no time.
    sizes : mapping of parameter to Sized
        How far those that switch nothing off, and may have either sign, may go from nothing, which a fit is to know
        where it begins there.
    holds : mapping of parameter to tuple of float
        Parameters that are not fitted but tried at each of these values.
    limits : mapping of parameter to pair of Sized
        Between which a fit stays, of what would do the work of something else beyond: a mast of a few grams that is
        damped by half. A parameter's own bounds are those of any robot or rig.
    forms : tuple of mapping of parameter to float or Sized
        Formulas, each by what is fitted in it beside the amplitudes (where that begins) and what is held (plain
        numbers): tried once the effect leads.
    robot_forms : tuple of mapping of parameter to float or Sized
        Further ones of a robot, whose axes are of different stiffness.
    grows : tuple of str
        Parameters that a small effect is proportional to, where these are not the ones that switch it off.
    sudden : bool
        Acts beyond a threshold alone, and is not proportional to anything.
    loosens : bool
        Takes away what holds a body near rest, so that it starts elsewhere than without the effect.
    apart : bool
        Its probes lie in valleys of their own, as those of a line at one frequency or another: how far each of them
        comes on the first moments of a recording says nothing of where it ends.
    spans : mapping of str to tuple of float
        Values of its parameters, and after ``baseline.`` factors on a parameter that a fit without the effect moves:
        every combination is simulated where sliding contacts leave so much that no single probe leads anywhere.
    """

    id: str
    sentence: str
    equation: str
    source: str
    signature: str
    parameters: tuple[Parameter, ...]
    experiments: tuple[str, ...]
    acts: Mapping[Site, Callable[..., Any] | None] = field(default_factory=dict)
    rig: bool = False
    probes: tuple[Mapping[str, float | Sized], ...] = ()
    rig_probes: tuple[Mapping[str, float | Sized], ...] = ()
    sizes: Mapping[str, Sized] = field(default_factory=dict)
    holds: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    limits: Mapping[str, tuple[Sized, Sized]] = field(default_factory=dict)
    forms: tuple[Mapping[str, float | Sized], ...] = ()
    robot_forms: tuple[Mapping[str, float | Sized], ...] = ()
    grows: tuple[str, ...] = ()
    sudden: bool = False
    loosens: bool = False
    apart: bool = False
    spans: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    @property
    def amplitudes(self) -> tuple[Parameter, ...]:
        """The parameters that switch it off."""
        return tuple(parameter for parameter in self.parameters if parameter.off is not None)

    @property
    def moves(self) -> bool:
        """Whether it changes the motion, and not only what instruments make of it."""
        return not set(self.acts) <= {Site.SENSOR, Site.OUTPUT}

    @property
    def robot(self) -> bool:
        """Whether it acts on a robot, and not on the drive of a rig alone."""
        return set(self.acts) != {Site.DRIVE}

    def values(self, given: Mapping[str, float] | None = None) -> dict[str, float]:
        """All parameters: the given ones, nominal for the rest."""
        return {p.name: float((given or {}).get(p.name, p.nominal)) for p in self.parameters}

    def begun(self, at: Mapping[str, float]) -> dict[str, float]:
        """All parameters: the given ones, nominal for the rest; where one that switches it off is given, the others of
        these are off."""
        off = {p.name: p.off for p in self.parameters if p.off is not None}
        return self.values({**({} if off.keys().isdisjoint(at) else off), **at})

    def is_off(self, values: Mapping[str, float]) -> bool:
        return all(values[parameter.name] == parameter.off for parameter in self.amplitudes)

    def __str__(self) -> str:
        lines = [f"{self.id}: {self.sentence}", f"  {self.equation}", f"  signature: {self.signature}"]
        lines += [
            f"  {p.name} [{p.unit}]  nominal {p.nominal:g}, {p.lower:g} … {p.upper:g}"
            + (f", off at {p.off:g}" if p.off is not None else "")
            + (f"  {p.meaning}" if p.meaning else "")
            for p in self.parameters
        ]
        return "\n".join([*lines, f"  seen in: {', '.join(self.experiments)}", f"  source: {self.source}"])
