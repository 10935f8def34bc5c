"""What a format of another tool cannot hold of a parameter set, as lines of a comment in its file."""

from __future__ import annotations

from collections.abc import Container

from ssmr_ident.core.parameter import ParameterSet


def xml_comment(parameters: ParameterSet, held: Container[str], form: str) -> str:
    """Name of the set, and every value that is not among those held.

    Parameters
    ----------
    parameters : ParameterSet
    held : container of str
        Dotted paths, ``effects.ID.KEY`` for effects'.
    form : str
        Name of the format, for the sentence.
    """
    left = [f"{path} = {estimate}" for path, estimate in parameters.items() if path not in held]
    left += [
        f"{id}.{key} = {estimate}"
        for id, block in parameters.effects.items()
        for key, estimate in block.items()
        if f"effects.{id}.{key}" not in held
    ]
    lines = [f"Identified parameters of {parameters.name}, SI units."]
    if left:
        lines += [f"Of these {form} holds nothing:", *(f"  {line}" for line in left)]
    text = "\n  ".join(lines).replace("--", "‐‐")  # two hyphens may not stand in a comment
    return f"<!-- {text} -->\n"
