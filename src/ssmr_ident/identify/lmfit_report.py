"""Results in lmfit's own printed form, with units: value, standard deviation, percent, correlations."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from ssmr_ident.core.frame import frame

if TYPE_CHECKING:
    import lmfit
    import pandas as pd

LEAST_CORRELATION = 0.5


@dataclass(frozen=True)
class Variable:
    """One fitted quantity.

    Parameters
    ----------
    name : str
    value : float
    std : float or None
    unit : str
    before : float or None
        What was known beforehand, or the starting value.
    before_std : float or None
    source : str
        Where the value comes from, ``data`` or ``prior``; empty for neither.
    """

    name: str
    value: float
    std: float | None
    unit: str
    before: float | None = None
    before_std: float | None = None
    source: str = ""


def variables_frame(variables: Sequence[Variable]) -> pd.DataFrame:
    """A row a variable, by its name; NaN for a number that is not known."""
    columns = tuple(field.name for field in fields(Variable))
    known = ({name: math.nan if value is None else value for name, value in vars(v).items()} for v in variables)
    return frame(known, columns, "name")


def as_parameters(
    variables: Sequence[Variable], correlations: Mapping[tuple[str, str], float] | None = None
) -> tuple[lmfit.Parameters, dict[str, str]]:
    """lmfit parameters with standard deviations and correlations, and the given name of each.

    Parameters
    ----------
    variables : sequence of Variable
    correlations : mapping of (name, name) to float, optional

    Notes
    -----
    lmfit names must be those of Python variables, so dots and blanks become underscores.
    """
    import lmfit  # it brings pandas: what prints no report of it need not wait

    parameters = lmfit.Parameters()
    names = {variable.name: re.sub(r"\W", "_", variable.name) for variable in variables}
    for variable in variables:
        name = names[variable.name]
        parameters.add(name, value=variable.value)
        parameters[name].stderr = variable.std
        parameters[name].init_value = variable.before
        parameters[name].correl = {}
    for (first, second), size in (correlations or {}).items():
        if first in names and second in names:
            parameters[names[first]].correl[names[second]] = size
            parameters[names[second]].correl[names[first]] = size
    return parameters, {short: full for full, short in names.items()}


def variables_report(
    variables: Sequence[Variable],
    correlations: Mapping[tuple[str, str], float] | None = None,
    least: float = LEAST_CORRELATION,
) -> list[str]:
    """Lines of lmfit's report on variables and correlations, units and priors added.

    Parameters
    ----------
    variables : sequence of Variable
    correlations : mapping of (name, name) to float, optional
    least : float
        Smallest correlation shown.
    """
    parameters, full = as_parameters(variables, correlations)
    from lmfit import fit_report

    text = fit_report(parameters, show_correl=True, min_correl=least, sort_pars=False)
    if correlations and "[[Correlations]]" not in text:
        text += f"\n[[Correlations]] (unreported correlations are < {least:.3f})"
    by_name = {variable.name: variable for variable in variables}
    width = max((len(variable.name) for variable in variables), default=0) + 1
    lines = []
    for line in text.splitlines():
        match = re.match(r"^    (\w+): +(.*)$", line)
        variable = by_name.get(full.get(match[1], "")) if match else None
        if match is None or variable is None:
            # lmfit's short names back to the given ones, in C(first, second) = number
            lines.append(re.sub(r"\b\w+\b", lambda word: full.get(word[0], word[0]), line) if "C(" in line else line)
            continue
        number = re.sub(r" *\(init = .*\)", "", match[2]).rstrip()
        lines.append(f"    {variable.name + ':':<{width}} {number:<38} {variable.unit:<8} {_known(variable)}".rstrip())
    return lines


def _known(variable: Variable) -> str:
    source = f"  [{variable.source}]" if variable.source else ""
    if variable.before is None:
        return source.strip()
    spread = "" if variable.before_std is None else f" ± {variable.before_std:.2g}"
    return f"(init = {variable.before:.6g}{spread}){source}"


def matrix_correlations(names: Sequence[str], covariance: np.ndarray) -> dict[tuple[str, str], float]:
    """Correlations of all pairs from a covariance or correlation matrix, (n, n) float."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return {
        (names[j], names[i]): float(covariance[i, j] / scale[i] / scale[j]) for i in range(len(names)) for j in range(i)
    }
