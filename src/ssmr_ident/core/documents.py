"""Answers as JSON and YAML text. Neither can fail: numpy's numbers are Python's, and what is not finite is null."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import yaml


def plain(value: Any) -> Any:
    """numpy numbers and arrays, tuples and paths as what JSON and YAML have of their own."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(inner) for inner in value]
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)


def finite(value: Any) -> tuple[Any, list[str]]:
    """A value with null in place of infinite numbers and NaN.

    Parameters
    ----------
    value : any
        As ``plain`` leaves it, or not yet.

    Returns
    -------
    value : any
    places : list of str
        Where null stands for such a number, and for which.

    >>> finite({"a": [1.0, float("inf")]})
    ({'a': [1.0, None]}, ['a[1]: inf'])
    """
    places: list[str] = []
    return _finite(plain(value), "", places), places


def _finite(value: Any, way: str, places: list[str]) -> Any:
    if isinstance(value, dict):
        return {key: _finite(inner, f"{way}.{key}".lstrip("."), places) for key, inner in value.items()}
    if isinstance(value, list):
        return [_finite(inner, f"{way}[{index}]", places) for index, inner in enumerate(value)]
    if isinstance(value, float) and not math.isfinite(value):
        places.append(f"{way}: {value}")
        return None
    return value


def note_of(places: list[str]) -> str:
    """A sentence on what ``finite`` replaced; empty for nothing."""
    if not places:
        return ""
    more = f" and {len(places) - 3} more" if len(places) > 3 else ""
    return f"null stands for what is no finite number: {'; '.join(places[:3])}{more}"


def json_text(value: Any, indent: int | None = None) -> str:
    """JSON without NaN and infinity."""
    return json.dumps(finite(value)[0], ensure_ascii=False, indent=indent, allow_nan=False)


def yaml_text(value: Any) -> str:
    """YAML in the order given; its last line is a comment where null stands for a number that is not finite."""
    content, places = finite(value)
    text = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=110)
    return text + (f"# {note_of(places)}\n" if places else "")
