"""Which sessions stand apart from others of the same robot."""

from __future__ import annotations

from statistics import NormalDist

import pandas as pd

NORMAL = 1.0 / NormalDist().inv_cdf(0.75)
"""Standard deviation of normally distributed values over their median absolute deviation."""
ENOUGH = 5
"""Sessions of one robot from which their median and spread say something."""


def farthest(parameters: pd.DataFrame) -> pd.DataFrame:
    """For each session the fitted parameter that stands farthest from the median over the sessions of its robot.

    Distances are in standard deviations: of the values' spread (from the median absolute deviation) and of the value's
    own uncertainty together. Robots with fewer than ``ENOUGH`` sessions are left out.

    Parameters
    ----------
    parameters : DataFrame
        As ``Results.parameters``.

    Returns
    -------
    DataFrame
        Index ``session``; columns ``parameter``, ``value``, ``median``, ``unit``, ``deviations`` (signed).
    """
    fitted = parameters[parameters.source == "fit"].copy()
    groups = fitted.groupby(["robot", "parameter"]).value
    fitted["median"] = groups.transform("median")
    spread = NORMAL * (fitted.value - fitted["median"]).abs().groupby([fitted.robot, fitted.parameter]).transform(
        "median"
    )
    width = (spread**2 + fitted["std"].fillna(0.0) ** 2) ** 0.5
    fitted["deviations"] = ((fitted.value - fitted["median"]) / width).where(width > 0.0)
    known = fitted[(groups.transform("size") >= ENOUGH) & fitted.deviations.notna()]
    order = known.deviations.abs().sort_values(ascending=False, kind="stable").index
    first = known.loc[order].drop_duplicates("session").set_index("session")
    return first[["parameter", "value", "median", "unit", "deviations"]]
