"""What the field calls the formulas, kinds and places that a diagnosis names by the words of files."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.diagnosis import NamedEffect
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.report.figures_diagnosis import readable

UNLISTED = "unlisted"

FORMULAS = {
    "sine": "a pendulum's sine",
    "two slopes": "two slopes, as of stops",
    "cubic and two slopes": "cubic, and two slopes as of stops",
    "tanh": "Coulomb",
    "slider": "Coulomb, with an elastic slider",
    "Dahl": "Coulomb, with pre-sliding after Dahl",
}
"""What the formulas of an effect are called in the field, where that is not how the search calls them."""

CHOSEN = {
    "nonlinear_stiffness": (
        ("cubic and two slopes", ("k3", "knee_share")),
        ("sine", ("sine_share",)),
        ("two slopes", ("knee_share",)),
        ("cubic", ("k3",)),
        ("cubic", ("k3_share",)),
    ),
    "dry_friction": (("tanh", ("rounding",)), ("slider", ("slider",)), ("Dahl", ("element_stiffness",))),
}
"""Formulas by the beginnings of the parameters that are not 0 in them, where no search says which it is."""

KINDS = {
    "static_force": "force of displacement or speed",
    "memory": "force that depends on the path",
    "extra_motion": "further degree of freedom",
    "changing": "parameter that changes with time",
    "geometry": "geometry",
    "ground_and_grip": "ground and friction",
    "sensor_chain": "measuring chain",
}

UNLISTED_SAYS = {
    "static_force": "A force of displacement or speed acts that no listed law makes; its curve stands below.",
    "memory": "A force acts that depends on the path and that no listed law makes.",
    "extra_motion": "Something else moves along that no listed law describes.",
    "changing": "Stiffness, damping, mass or a force changes in the course of a recording, by no listed law.",
    "sensor_chain": "The measuring chain does what no listed law describes.",
}

SAYS = {
    ("nonlinear_stiffness", "sine"): "The restoring moment is a pendulum's: it follows the sine of the angle.",
    ("dry_friction", "slider"): "Coulomb friction acts through an elastic contact, which gives before it slides.",
    ("dry_friction", "Dahl"): "Coulomb friction acts through an elastic contact, which gives before it slides.",
}
"""One sentence for each formula that deserves its own."""


def kind_words(kind: str) -> str:
    """A kind of physics, as files write it, in the field's words."""
    return KINDS.get(kind.replace(" ", "_"), readable(kind))


def form_of(effect: NamedEffect) -> str:
    """The formula of an effect as the search calls it; by its parameters where none did."""
    if effect.form or effect.id not in CHOSEN:
        return effect.form
    acting = [name for name, e in effect.parameters.items() if not isinstance(e.value, int | float) or e.value != 0]
    for form, beginnings in CHOSEN[effect.id]:
        if all(any(name.startswith(begin) for name in acting) for begin in beginnings):
            return form
    return ""


def effect_words(effect: NamedEffect) -> str:
    """An effect by its name in the field, its formula in brackets."""
    if effect.id == UNLISTED:
        return f"a {kind_words(effect.kind)}, by no listed law" if effect.kind else "a force that no listed law makes"
    form = form_of(effect)
    return f"{readable(effect.id)} ({FORMULAS.get(form, form)})" if form else readable(effect.id)


def sentence(effect: NamedEffect, parameters: ParameterSet) -> str:
    """What it does in one sentence, without the numbers that stand beside the law.

    Parameters
    ----------
    effect : NamedEffect
    parameters : ParameterSet
        Of the robot or rig.
    """
    if effect.id == UNLISTED and effect.kind:
        return UNLISTED_SAYS.get(effect.kind.replace(" ", "_"), effect.sentence)
    form = form_of(effect)
    if (effect.id, form) in SAYS:
        return SAYS[effect.id, form]
    if effect.id == "nonlinear_stiffness":
        return _stiffens(effect, form, parameters)
    known = CATALOGUE.get(effect.id)
    plain = f"{known.sentence.rstrip('.')}." if known else ""
    return plain if plain and effect.sentence.startswith(plain[:-1]) else effect.sentence


def _stiffens(effect: NamedEffect, form: str, parameters: ParameterSet) -> str:
    what = "spring" if is_rig(parameters) else "tires"
    verb = "stiffen" if _largest(effect.parameters) > 0.0 else "soften"
    does = verb if what == "tires" else f"{verb}s"
    beyond = ": beyond a deflection its slope is another, as where it meets a stop" if form == "two slopes" else ""
    return f"The {what} {does} with deflection{beyond}."


def _largest(parameters: Mapping[str, Estimate]) -> float:
    """The term that leads: of a cubic its coefficient, without one the change of slope."""
    values = {name: float(e.value) for name, e in parameters.items() if isinstance(e.value, int | float)}
    for begin in ("k3", "knee_share"):
        found = [v for name, v in values.items() if name.startswith(begin) and v != 0.0]
        if found:
            return found[0]
    return 0.0


def is_rig(parameters: ParameterSet) -> bool:
    """Whether it is of a rig, a network or a block, and not of a robot."""
    return not any(key.startswith("tire.") or key == "contact_points_m" for key in parameters)


def place_words(element: str, parameters: ParameterSet) -> str:
    """Where an effect acts: springs and bodies of a network by what they are.

    >>> from ssmr_ident.core.parameter import ParameterSet
    >>> place_words("sensor.acceleration", ParameterSet("rig", {}))
    'sensor of the acceleration'
    """
    if element in parameters.between:
        return f"spring {element}"
    if any(key.startswith(f"bodies.{element}.") for key in parameters):
        return f"body {element}"
    if element == "tire":
        return "tires"
    sensor, _, channel = element.partition(".")
    if sensor == "sensor" and channel:
        return f"sensor of {'the ' if channel == channel.lower() and len(channel) > 2 else ''}{readable(channel)}"
    return readable(element)


def explanation_words(name: str, id: str) -> str:
    """One of the explanations tried, with formula and place, as the search names it; by its id where it does not.

    >>> explanation_words("static_force in any shape at s2", "unlisted")
    'force of displacement or speed, in any shape, at s2'
    >>> explanation_words("dry_friction (Dahl) + unlisted (|s - place|)", "dry_friction+unlisted")
    'dry friction (Coulomb, with pre-sliding after Dahl) + by no listed law (|s - place|)'
    """
    if not name or id == "baseline":
        return readable(id)
    return " + ".join(_one(part) for part in name.split(" + "))


def _one(name: str) -> str:
    shape = re.fullmatch(r"(\w+) in (.*?)( at \S+)?", name)
    if shape:
        kind, form, place = shape.groups()
        return f"{kind_words(kind)}, in {form}" + (f",{place}" if place else "")
    law = re.fullmatch(r"(\w+)(?: \((.*)\))?( at \S+)?", name)
    if law is None:
        return readable(name)
    id, form, place = law.groups()
    words = "by no listed law" if id == UNLISTED else readable(id)
    return words + (f" ({FORMULAS.get(form, form)})" if form else "") + (place or "")
