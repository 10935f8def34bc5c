"""A parameter set as the text or bytes of another tool's file."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.workflows.export.mjcf import mjcf_of
from ssmr_ident.workflows.export.urdf import urdf_of


def csv_of(parameters: ParameterSet) -> str:
    """``parameter,value,std,unit,source``, one row a number; entries of an array carry their place in brackets."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(("parameter", "value", "std", "unit", "source"))
    for path, estimate in _all(parameters):
        std = "" if estimate.std is None else repr(float(estimate.std))
        for place, value in np.ndenumerate(np.asarray(estimate.value, dtype=float)):
            name = path + (f"[{','.join(map(str, place))}]" if place else "")
            writer.writerow((name, repr(float(value)), std, estimate.unit, estimate.source))
    return stream.getvalue()


def mat_of(parameters: ParameterSet) -> bytes:
    """MATLAB 5 file with one struct ``parameters``: blocks are structs, ends have ``value``, ``std``, ``unit``."""
    from scipy.io import savemat

    tree: dict[str, Any] = {"name": parameters.name}
    for path, estimate in _all(parameters):
        *blocks, end = (re.sub(r"\W", "_", part) for part in path.split("."))
        inner = tree
        for block in blocks:
            inner = inner.setdefault(block, {})
        std = np.nan if estimate.std is None else estimate.std
        inner[end] = {"value": estimate.value, "std": std, "unit": estimate.unit, "source": estimate.source}
    stream = io.BytesIO()
    savemat(stream, {"parameters": tree}, long_field_names=True)
    return stream.getvalue()


PARAMETER_FORMATS: dict[str, Callable[[ParameterSet], str | bytes]] = {
    "mjcf": mjcf_of,
    "urdf": urdf_of,
    "mat": mat_of,
    "csv": csv_of,
}


def parameters_as(parameters: ParameterSet, form: str) -> bytes:
    """The file's bytes.

    Parameters
    ----------
    parameters : ParameterSet
    form : str
        Of ``PARAMETER_FORMATS``.
    """
    made = PARAMETER_FORMATS[form](parameters)
    return made if isinstance(made, bytes) else made.encode()


def _all(parameters: ParameterSet) -> list[tuple[str, Estimate]]:
    effects = [(f"effects.{id}.{key}", e) for id, block in parameters.effects.items() for key, e in block.items()]
    return [*parameters.items(), *effects]
