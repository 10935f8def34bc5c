"""The catalogue for a reader: its entries as text and as values, and figures of what each effect does."""

from __future__ import annotations

import math
import shutil
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.effects import CATALOGUE


def find(effect_id: str) -> Effect:
    """One entry of the catalogue.

    Raises
    ------
    InputError
        No such effect; names the nearest.
    """
    if effect_id not in CATALOGUE:
        raise InputError(f"effects: {effect_id}", "is no known effect", did_you_mean(effect_id, CATALOGUE))
    return CATALOGUE[effect_id]


def bearer(effect: Effect) -> str:
    """On what an effect can be seen, in words."""
    if not any(EXPERIMENTS[name].scenario for name in effect.experiments):
        return "a rig"
    return "the robot and of a rig" if effect.rig else "the robot"


def catalogue_text(width: int | None = None) -> str:
    """Every effect with its sentence and where it is seen, folded to ``width`` columns (the terminal's)."""
    width = max(60, width or shutil.get_terminal_size((110, 24)).columns)
    column = max(len(effect_id) for effect_id in CATALOGUE) + 2
    lines = []
    for effect in CATALOGUE.values():
        words = f"{effect.sentence} Seen in: {', '.join(effect.experiments)}."
        folded = textwrap.wrap(words, width - column)
        lines.append(f"{effect.id:<{column}}{folded[0]}")
        lines += [" " * column + line for line in folded[1:]]
    return "\n".join([*lines, "", f"{len(CATALOGUE)} effects. ident effects ID shows one, -o FIGURE.png draws it."])


def effect_text(effect: Effect) -> str:
    """One effect on a screen: equation, parameters with unit, bounds and off value, signature, source."""
    lines = [f"{effect.id}: {effect.sentence}", "", f"  equation   {effect.equation}"]
    lines += [f"  signature  {effect.signature}", f"  seen in    {', '.join(effect.experiments)}"]
    lines += [f"  acts on    {', '.join(site.value for site in effect.acts)}"]
    lines[-1] += f" of {bearer(effect)}"
    lines += [f"  source     {effect.source}", "", "  parameters"]
    name_width = max(len(parameter.name) for parameter in effect.parameters)
    unit_width = max(len(parameter.unit) for parameter in effect.parameters)
    for p in effect.parameters:
        off = "" if p.off is None else f"; off at {p.off:g}"
        line = f"    {p.name:<{name_width}}  {p.unit:<{unit_width}}  {p.nominal:<8g} {p.lower:g} … {p.upper:g}{off}"
        lines.append(line + (f"; {p.meaning}" if p.meaning else ""))
    return "\n".join(lines)


def effect_values(effect: Effect) -> dict[str, Any]:
    """One effect as plain values for JSON; infinite numbers as the text ``inf`` or ``-inf``."""
    return {
        "id": effect.id,
        "sentence": effect.sentence,
        "equation": effect.equation,
        "parameters": [_parameter_values(parameter) for parameter in effect.parameters],
        "signature": effect.signature,
        "source": effect.source,
        "seen_in": list(effect.experiments),
        "acts_on": [site.value for site in effect.acts],
        "rig": effect.rig,
    }


def _parameter_values(parameter: Parameter) -> dict[str, Any]:
    def plain(value: float | None) -> float | str | None:
        return value if value is None or math.isfinite(value) else str(value)

    return {
        "name": parameter.name,
        "unit": parameter.unit,
        "nominal": plain(parameter.nominal),
        "lower": plain(parameter.lower),
        "upper": plain(parameter.upper),
        "off": plain(parameter.off),
        "meaning": parameter.meaning,
    }


def draw(effect: Effect, path: Path, values: Mapping[str, float] | None = None) -> Path:
    """Simulate the effect beside the baseline and write the figure.

    Parameters
    ----------
    effect : Effect
    path : Path
        Ends in .png, .svg or .pdf; the folder is made.
    values : mapping of parameter to float
        Nominal where left out.

    Raises
    ------
    InputError
        Another ending, or the place cannot be written to.
    """
    from ssmr_ident.report import style
    from ssmr_ident.report.effect_figure import effect_figure
    from ssmr_ident.workflows.effects.panels import panels

    ending = path.suffix.removeprefix(".").lower()
    if ending not in ("png", "svg", "pdf"):
        raise InputError(str(path), f"ends in {path.suffix or 'nothing'!r}", "Write .png, .svg or .pdf")
    complete = effect.values(values)
    units = {p.name: p.unit for p in effect.parameters}
    given = ", ".join(
        f"{name} = {value:g}" + ("" if units[name] == "1" else f" {style.unit_text(units[name])}")
        for name, value in complete.items()
    )
    drawn = panels(effect, complete)
    if not drawn:
        raise InputError(effect.id, "acts on a rig alone, of which there is no drawing", "Leave -o out")
    figure = effect_figure(f"{effect.id} ({given})", effect.sentence, drawn)
    try:
        return style.save(figure, path.with_suffix(""), ending)
    except OSError as error:
        raise InputError(str(path), f"cannot be written: {error.strerror}", "Name another place") from None
