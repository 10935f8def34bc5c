"""Parameter files read: robot.yaml as a user writes it, and the same schema as ``ident fit`` exports it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.session.parameters_text import SCHEMA
from ssmr_ident.session.schema import BLOCKS, KEYS, canonical_unit
from ssmr_ident.session.yaml_file import load_mapping

_FIELDS = {"value", "std", "unit", "source", "fixed", "at_bound"}
_TOP = {"schema", "name", "effects", "provenance"}


def bundled_robots() -> tuple[str, ...]:
    """Names that ``robot:`` accepts without a file."""
    folder = resources.files("ssmr_ident.session") / "robots"
    return tuple(sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml")))


def read_parameters(path: str | Path) -> ParameterSet:
    """Read a parameter file, or a bundled robot by its name.

    Raises
    ------
    InputError
        With file and key, for an unknown key, a wrong unit, a value that is no number or out of bounds.
    """
    if str(path) in bundled_robots():
        path = Path(str(resources.files("ssmr_ident.session") / "robots" / f"{path}.yaml"))
    path = Path(path)
    content = load_mapping(path)
    schema = content.get("schema", SCHEMA)
    if schema != SCHEMA:
        raise InputError(str(path), f"schema is {schema!r}, expected {SCHEMA!r}", "Is this the right file?")
    estimates: dict[str, Estimate] = {}
    for key, block in content.items():
        if key not in _TOP:
            _collect(path, str(key), block, estimates)
    effects = _effects(path, content.get("effects") or {})
    provenance = content.get("provenance") or {}
    if not isinstance(provenance, Mapping):
        raise InputError(f"{path}: provenance", "must be a mapping")
    return ParameterSet(str(content.get("name", path.stem)), estimates, effects, provenance, str(path))


def _collect(path: Path, key: str, block: Any, estimates: dict[str, Estimate]) -> None:
    where = f"{path}: {key}"
    if isinstance(block, Mapping) and "value" not in block:
        if key in KEYS and key not in BLOCKS:
            raise InputError(
                where, "has no value", f"Write {key.rsplit('.', 1)[-1]}: {{value: …, unit: {KEYS[key].unit}}}"
            )
        if key not in BLOCKS:
            raise InputError(where, "is not a known key", did_you_mean(key, {*KEYS, *BLOCKS}))
        for name, inner in block.items():
            _collect(path, f"{key}.{name}", inner, estimates)
        return
    if key not in KEYS and not key.startswith("noise."):
        raise InputError(where, "is not a known key", did_you_mean(key, KEYS))
    estimates[key] = _estimate(where, key, block)


def _estimate(where: str, key: str, block: Any, unit: str = "1") -> Estimate:
    declared = KEYS.get(key)
    unit = declared.unit if declared else unit
    entry = dict(block) if isinstance(block, Mapping) else {"value": block}
    for name in entry:
        if name not in _FIELDS:
            raise InputError(where, f"has an unknown field {name!r}", did_you_mean(str(name), _FIELDS))
    given = canonical_unit(entry.get("unit", unit))
    if declared and given != unit:
        raise InputError(where, f"unit is {given!r}, expected {unit!r}", f"Convert the value and write unit: {unit}")
    value = _number(where, "value", entry["value"], declared.shape if declared else None)
    std = entry.get("std")
    if std is not None:
        std = float(_number(where, "std", std, ()))
        if not std >= 0:
            raise InputError(where, f"std is {std}, expected a number ≥ 0")
        std = None if math.isinf(std) else std
    if declared and bool(np.any(np.asarray(value) < declared.lower)):
        raise InputError(where, f"value is {value}, expected ≥ {declared.lower:g}")
    fixed = entry.get("fixed", False)
    if not isinstance(fixed, bool):
        raise InputError(where, f"fixed is {fixed!r}, expected true or false")
    return Estimate(value, std, given, str(entry.get("source", "")), fixed, bool(entry.get("at_bound", False)))


def _number(where: str, name: str, value: Any, shape: tuple[int, ...] | None) -> Any:
    """A float, or an array of the declared shape; text such as '1e6' counts as a number, true does not."""
    try:
        if isinstance(value, bool) or (isinstance(value, list) and any(isinstance(v, bool) for v in value)):
            raise ValueError
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(where, f"{name} is {value!r}, expected a number", "Use a decimal point, no unit") from None
    if np.isnan(array).any():
        raise InputError(where, f"{name} is not a number (NaN)")
    if shape is not None and array.shape != shape:
        expected = "a number" if shape == () else f"{' × '.join(map(str, shape))} numbers"
        raise InputError(where, f"{name} has shape {array.shape}, expected {expected}")
    return float(array) if array.shape == () else array


def _effects(path: Path, block: Any) -> dict[str, dict[str, Estimate]]:
    if not isinstance(block, Mapping):
        raise InputError(f"{path}: effects", "must be a mapping of effect ids")
    result: dict[str, dict[str, Estimate]] = {}
    for effect, parameters in block.items():
        if not isinstance(parameters, Mapping):
            raise InputError(f"{path}: effects.{effect}", "must be a mapping of its parameters")
        result[str(effect)] = {
            str(key): _estimate(f"{path}: effects.{effect}.{key}", f"effects.{effect}.{key}", entry)
            for key, entry in parameters.items()
            if not isinstance(entry, Mapping) or "value" in entry or _no_value(path, effect, key)
        }
    return result


def _no_value(path: Path, effect: Any, key: Any) -> bool:
    raise InputError(f"{path}: effects.{effect}.{key}", "has no value", "Write {value: …, unit: …}")
