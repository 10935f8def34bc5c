"""Parameter files written: bit for bit what was known, each key explained."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.documents import plain
from ssmr_ident.core.parameter import Estimate, ParameterSet, effect_and_element
from ssmr_ident.session.network_block import BETWEEN, BODIES, SPRINGS
from ssmr_ident.session.schema import KEYS

SCHEMA = "ssmr-ident/parameters/1"


def write_parameters(path: str | Path, parameters: ParameterSet) -> None:
    """Write a parameter file; reading it back gives the same numbers bit for bit.

    Each key is followed by a comment with its meaning. The file appears at once or not at all.
    """
    write_text(path, parameters_text(parameters))


def parameters_text(parameters: ParameterSet) -> str:
    """The YAML text of a parameter set."""
    lines = [f"schema: {SCHEMA}", f"name: {_scalar(parameters.name)}"]
    open_blocks: list[str] = []
    for key, entry in _grouped(parameters):
        parts = key.split(".")
        while open_blocks and parts[: len(open_blocks)] != open_blocks:
            open_blocks.pop()
        while len(open_blocks) < len(parts) - 1:
            lines.append(f"{'  ' * len(open_blocks)}{_key(parts[len(open_blocks)])}:")
            open_blocks.append(parts[len(open_blocks)])
        indent = "  " * (len(parts) - 1)
        meaning = f"  # {KEYS[key].meaning}" if key in KEYS else ""
        lines.append(f"{indent}{parts[-1]}: {_entry(entry)}{meaning}")
    if parameters.effects:
        lines += ["effects:", *_effects(parameters.effects)]
    text = "\n".join(lines) + "\n"
    if parameters.provenance:
        text += yaml.safe_dump({"provenance": plain(parameters.provenance)}, sort_keys=False, allow_unicode=True)
    return text


def _effects(effects: Mapping[str, Mapping[str, Estimate]]) -> Iterator[str]:
    """The block's lines; an effect at several springs of a network is a list."""
    places: dict[str, list[list[str]]] = {}
    for key, entries in effects.items():
        effect, element = effect_and_element(key)
        said = [f"element: {_key(element)}"] if element else []
        places.setdefault(effect, []).append(said + [f"{name}: {_flow(e)}" for name, e in entries.items()])
    for effect, blocks in places.items():
        yield f"  {effect}:" if blocks[0] else f"  {effect}: {{}}"
        for lines in blocks:
            several = len(blocks) > 1
            yield from (f"    {'' if not several else '- ' if k == 0 else '  '}{line}" for k, line in enumerate(lines))


Entry = Estimate | str | tuple[str, str]


def _entry(entry: Entry) -> str:
    if isinstance(entry, Estimate):
        return _flow(entry)
    return entry if isinstance(entry, str) else f"[{', '.join(map(_key, entry))}]"


def _key(name: str) -> str:
    """A name, in quotes where YAML would read another thing (yes, null)."""
    return name if yaml.safe_load(name) == name else f'"{name}"'


def _grouped(parameters: ParameterSet) -> list[tuple[str, Entry]]:
    """Keys of one block side by side, blocks in the order of their first key."""
    joins: dict[str, Entry] = {f"{SPRINGS}.{name}.{BETWEEN}": ends for name, ends in parameters.between.items()}
    bodies = {key: estimate for key, estimate in parameters.estimates.items() if key.startswith(f"{BODIES}.")}
    entries: dict[str, Entry] = {**bodies, **joins, **parameters.estimates, **parameters.choices}
    order: dict[str, int] = {}
    for key in entries:
        parts = key.split(".")
        for depth in range(1, len(parts) + 1):
            order.setdefault(".".join(parts[:depth]), len(order))
    path_order = lambda key: [order[".".join(key.split(".")[: d + 1])] for d in range(len(key.split(".")))]  # noqa: E731
    return [(key, entries[key]) for key in sorted(entries, key=path_order)]


def _flow(estimate: Estimate) -> str:
    fields: dict[str, Any] = {"value": estimate.value}
    if estimate.std is not None:
        fields["std"] = estimate.std
    fields["unit"] = estimate.unit
    if estimate.fixed:
        fields["fixed"] = True
    if estimate.at_bound:
        fields["at_bound"] = True
    if estimate.source:
        fields["source"] = estimate.source
    return "{" + ", ".join(f"{name}: {_scalar(plain(value))}" for name, value in fields.items()) + "}"


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        if math.isinf(value):
            return ".inf" if value > 0 else "-.inf"
        return repr(value)  # the shortest text that reads back to the same bits
    if isinstance(value, list):
        return "[" + ", ".join(_scalar(item) for item in value) + "]"
    text = yaml.safe_dump(value, allow_unicode=True, default_style='"', width=10**6)
    return text.strip()
