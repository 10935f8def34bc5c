"""What a sweep varies: ``NAME=A:B:N`` or ``NAME=V,V,…``, and what NAME may be."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ssmr_ident.core.domain import Domain, Number
from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.place import Place
from ssmr_ident.core.rotary import rotary_name
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.session.schema import KEYS
from ssmr_ident.workflows.simulate.request import Request, asked_for

FLOORS = {"concrete": 0.86, "carpet": 0.98}
"""µ_s of section 3.3; µ_k keeps its ratio to µ_s. Other floors come as parameter files, ``robot=A.yaml,B.yaml``."""

_NUMBERS = {
    "amplitude_mm": "mm", "push_N": "N", "speed_mm_s": "mm/s", "height_m": "m", "angle_deg": "deg",
    "wheel_rate_rad_s": "rad/s", "yaw_rate_deg_s": "deg/s", "speed_m_s": "m/s",
}  # fmt: skip
_OPTIONS = ("motion", "start", "direction", "cable")
_WORDS = ("robot", "floor", "contact", *_OPTIONS)

Value = float | str


@dataclass(frozen=True)
class Axis:
    """One swept quantity.

    Parameters
    ----------
    name : str
        As asked for.
    target : str
        Key of the parameter file, ``EFFECT.PARAMETER``, or option of the experiment.
    unit : str
    values : tuple of float or str
    """

    name: str
    target: str
    unit: str
    values: tuple[Value, ...]

    @property
    def label(self) -> str:
        """Name and unit, for an axis of a figure."""
        return f"{self.name} [{self.unit}]" if self.unit not in ("", "1") else self.name

    def applied(self, value: Value, parameters: ParameterSet, request: Request) -> tuple[ParameterSet, Request]:
        """Parameters and request with this quantity at one value; a robot is read beforehand."""
        if self.target in _NUMBERS or self.target in _OPTIONS:
            changed: dict[str, Any] = {self.target: value}
            return parameters, replace(request, conditions=replace(request.conditions, **changed))
        if self.target == "contact":
            return asked_for(parameters, replace(request, contact=str(value))), request
        if self.target == "floor":
            return _on_floor(parameters, str(value)), request
        number = float(value)
        if self.target in KEYS:
            known = parameters.get(self.target) or Estimate(number, None, self.unit)
            return parameters.updated({self.target: replace(known, value=number)}), request
        effect, key = self.target.split(".")
        key = rotary_name(key, self.unit) if parameters.rotary else key
        block = {**parameters.effects.get(effect, {}), key: Estimate(number, None, self.unit)}
        return replace(parameters, effects={**parameters.effects, effect: block}), request


def axis_of(text: str) -> Axis:
    """An axis from the command line.

    Raises
    ------
    InputError
        No such quantity, values that are none, or out of bounds.

    Examples
    --------
    >>> axis_of("lambda_max=0.2:1:3").values
    (0.2, 0.6, 1.0)
    >>> axis_of("lambda_max=1e-4:1:5:log").target
    'tire.lambda_max'
    """
    name, equals, given = (part.strip() for part in text.partition("="))
    if not (name and equals and given):
        raise InputError("--over", f"{text!r} is no NAME=VALUES", "Such as lambda_max=0.2:1:9 or floor=concrete,carpet")
    if name in _WORDS:
        return Axis(name, name, "", tuple(_words(name, given)))
    target, unit, domain = _numeric(name)
    values = _numbers(name, given)
    for value in values:
        domain.check(Place(f"--over {name}"), value)
    return Axis(name, target, unit, values)


def _words(name: str, given: str) -> list[str]:
    values = [value.strip() for value in given.split(",") if value.strip()]
    if name == "floor":
        for value in values:
            if value not in FLOORS:
                mend = f"{did_you_mean(value, FLOORS)} Others as files: --over robot=a.yaml,b.yaml"
                raise InputError("--over floor", f"{value!r} is not known", mend)
    return values


def _numeric(name: str) -> tuple[str, str, Domain]:
    """Target, unit and domain of a number's name, whole or by its last part."""
    if name in _NUMBERS:
        return name, _NUMBERS[name], Number()
    scalars = [key for key, kind in KEYS.items() if kind.shape == ()]
    effects = {f"{id}.{p.name}": p for id, effect in CATALOGUE.items() for p in effect.parameters}
    keys = [key for key in scalars if name in (key, key.rsplit(".", 1)[-1])]
    keys = [name] if name in keys else keys
    within = [key for key in effects if name in (key, key.rsplit(".", 1)[-1])] if not keys else []
    if len(keys) + len(within) > 1:
        raise InputError("--over", f"{name!r} may be {' or '.join(keys + within)}", "Write it in full")
    if keys:
        return keys[0], KEYS[keys[0]].unit, KEYS[keys[0]].domain
    if within:
        one = effects[within[0]]
        return within[0], one.unit, Number(least=one.lower, most=one.upper)
    known = (*scalars, *effects, *_NUMBERS, *_WORDS)
    raise InputError("--over", f"{name!r} is nothing that can be swept", did_you_mean(name, known))


def _numbers(name: str, given: str) -> tuple[float, ...]:
    spaced, _, logarithmic = given.partition(":log")
    parts = spaced.split(":") if ":" in spaced else spaced.split(",")
    try:
        numbers = [float(part) for part in parts if part.strip()]
        if ":" in spaced:
            low, high, count = numbers
            if count < 2 or count != int(count):
                raise ValueError
            spacing = np.geomspace if logarithmic or given.endswith(":log") else np.linspace
            if spacing is np.geomspace and low * high <= 0.0:
                raise ValueError
            return tuple(float(f"{value:.12g}") for value in spacing(low, high, int(count)))
    except ValueError:
        mend = "A:B:N with N of 2 or more, A:B:N:log of one sign, or values with commas"
        raise InputError(f"--over {name}", f"{given!r} are no numbers", mend) from None
    return tuple(numbers)


def _on_floor(parameters: ParameterSet, floor: str) -> ParameterSet:
    static = parameters["tire.mu_static"]
    share = parameters.number("tire.mu_kinetic", float(static.value)) / float(static.value)
    changes = {"tire.mu_static": replace(static, value=FLOORS[floor], source=f"{floor} (3.3)")}
    if "tire.mu_kinetic" in parameters:
        kinetic = parameters["tire.mu_kinetic"]
        changes["tire.mu_kinetic"] = replace(kinetic, value=share * FLOORS[floor], source=f"{floor} (3.3)")
    return parameters.updated(changes)
