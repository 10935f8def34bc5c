"""What swivels know of lambda_max, the slip at which the grip is used up (4.10)-(4.12): the thesis' open request."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_ident.diagnose.turning.anchor import Anchor
from ssmr_ident.diagnose.turning.conditions import Condition

TRIED = (0.02, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0)
FOREIGN_DB = 3.5
"""Own error of a baseline from which on it is no model of this robot; fits to robots that it describes leave 3 dB."""
DROP = 1.92  # of the log likelihood at the ends of a 95 % interval


@dataclass(frozen=True, eq=False)
class GripProfile(Shown):
    """Log likelihood over lambda_max, everything else at the baseline's values.

    ``lower`` is None where every smaller value fits as well, ``upper`` where every larger one does; ``own_error_db``
    is the tau of the baseline.
    """

    tried: np.ndarray
    log_likelihood: np.ndarray
    best: float
    lower: float | None
    upper: float | None
    own_error_db: float = 0.0

    def __str__(self) -> str:
        if self.own_error_db > FOREIGN_DB:
            return (
                f"lambda_max: {self.best:.2g} fits best, but the model is {self.own_error_db:.1f} dB off these spectra "
                "for reasons of its own, so no interval is given"
            )
        if self.lower is None and self.upper is None:
            return "lambda_max: these recordings cannot tell it; every value from 0.02 to 1 fits as well"
        if self.lower is None:
            return f"lambda_max: below {self.upper:.2g} (95 %), and these recordings cannot tell smaller values apart"
        if self.upper is None:
            return f"lambda_max: above {self.lower:.2g} (95 %)"
        return f"lambda_max: {self.best:.2g}, between {self.lower:.2g} and {self.upper:.2g} (95 %)"


def grip_profile(anchor: Anchor, fitted_on: tuple[Condition, ...]) -> GripProfile:
    """Profile lambda_max on the recordings that the baseline was fitted on."""
    tried = np.array(TRIED)
    direct = Anchor(anchor.bench, anchor.scale, anchor.priors, anchor.z, (), anchor.fit, anchor.seeds)
    effects = [{"slip_coupling": {"weight": 1.0, "lambda_max": value}} for value in TRIED]
    anchor.bench.prefetch(
        (c, anchor.values, effect, seed) for effect in effects for c in fitted_on for seed in anchor.seeds
    )
    values = []
    for effect in effects:
        found = direct.score(fitted_on, effect)
        values.append(-np.inf if found is None else found[0].log_likelihood)
    return profile(tried, np.array(values), anchor.fit.tau_db)


def profile(tried: np.ndarray, log_likelihood: np.ndarray, own_error_db: float = 0.0) -> GripProfile:
    """The interval where the log likelihood is within 1.92 of its best, between the values tried."""
    best = int(np.argmax(log_likelihood))
    limit = log_likelihood[best] - DROP

    def crossing(inside: int, outside: int) -> float:
        a, b = log_likelihood[inside], log_likelihood[outside]
        share = 1.0 if not np.isfinite(b) else float(np.clip((a - limit) / (a - b), 0.0, 1.0))
        return float(tried[inside] + share * (tried[outside] - tried[inside]))

    allowed = np.flatnonzero(log_likelihood >= limit)
    first, last = int(allowed[0]), int(allowed[-1])
    lower = None if first == 0 else crossing(first, first - 1)
    upper = None if last == len(tried) - 1 else crossing(last, last + 1)
    return GripProfile(tried, log_likelihood, float(tried[best]), lower, upper, own_error_db)
