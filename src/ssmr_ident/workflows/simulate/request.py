"""What ``ident simulate`` and ``ident sweep`` are asked for, and whether that can be met."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Annotated

from ssmr_ident.core.domain import Number
from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.nested_domain import declared
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.place import Place, shown
from ssmr_ident.experiments import EXPERIMENTS, Conditions, Experiment
from ssmr_ident.readers.options import RATE
from ssmr_ident.session.entry import WHEELS
from ssmr_ident.session.schema import CHOICES


@dataclass(frozen=True)
class Request:
    """What to simulate, as the command line asks for it (units are in the names).

    Parameters
    ----------
    experiment : Experiment
    conditions : Conditions
    force, base : str
        Log with the force or torque of a driven rig, or with the motion of the foot that it stands on.
    baseline : str
        Of a session; empty takes the one that the parameter file's keys stand for.
    duration_s, rate_hz : float or None
        None takes the experiment's own.
    noise : bool
        That of the parameter file.
    seed : int
    effects : tuple of str
        ``ID`` or ``ID:KEY=VALUE,…``, beside those of the file.
    contact : str or None
        Law of the contacts instead of the file's.
    """

    experiment: Experiment
    conditions: Conditions = field(default_factory=Conditions)
    force: str = ""
    base: str = ""
    baseline: str = ""
    duration_s: Annotated[float | None, Number("s", least=1e-6, most=1e6)] = None
    rate_hz: Annotated[float | None, RATE] = None
    noise: bool = False
    seed: int = 0
    effects: tuple[str, ...] = ()
    contact: Annotated[str | None, CHOICES["tire.contact"][0]] = None

    @property
    def duration(self) -> float:
        """Of the recording [s]."""
        return self.experiment.duration if self.duration_s is None else self.duration_s

    @property
    def rate(self) -> float:
        """Samples per second [Hz]."""
        return self.experiment.sample_rate if self.rate_hz is None else self.rate_hz


def check(request: Request) -> None:
    """Whether a request can be met at all.

    Raises
    ------
    InputError
        A value out of its domain, or too many samples.
    """
    duration, rate = request.duration, request.rate
    options: tuple[tuple[object, type], ...] = ((request, Request), (request.conditions, Conditions))
    for asked, kind in options:
        for option, (domain, _) in declared(kind).items():
            value = getattr(asked, option)
            if value is not None:
                domain.check(Place(f"--{option.replace('_', '-')}"), value)
    if duration * rate > 5e7:
        raise InputError("--duration-s, --rate-hz", f"ask for {duration * rate:g} samples")


def asked_for(parameters: ParameterSet, request: Request) -> ParameterSet:
    """A file's parameters with the effects and the law of contacts that the command line names beside them."""
    choices = {"tire.contact": request.contact} if request.contact else parameters.choices
    effects = dict(parameters.effects)
    for text in request.effects:
        effect_id, _, pairs = text.partition(":")
        given: dict[str, Estimate] = {}
        for pair in pairs.split(",") if pairs else ():
            key, _, value = (part.strip() for part in pair.partition("="))
            try:
                given[key] = Estimate(float(value))
            except ValueError:
                problem = f"{shown(pair)} is no KEY=VALUE"
                raise InputError("--effect", problem, "Such as dry_friction:F_c_N=2") from None
        effects[effect_id] = given
    return replace(parameters, effects=effects, choices=choices)


def experiment_of(name: str) -> Experiment:
    """The experiment that the command line names."""
    if name not in EXPERIMENTS:
        raise InputError("--experiment", f"is {name!r}", did_you_mean(name, EXPERIMENTS))
    return EXPERIMENTS[name]


def wheels_of(text: str) -> tuple[int, ...]:
    """Wheels as the command line names them.

    >>> wheels_of("2, 1")
    (1, 2)
    """
    parts = [part.strip() for part in text.split(",") if part.strip()]
    wheels = [int(part) if part in "1234" else part for part in parts]
    return tuple(sorted(WHEELS.check(Place("--wheels-gripping"), wheels)))
