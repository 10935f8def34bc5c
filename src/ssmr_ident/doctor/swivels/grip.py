"""What swivels know of lambda_max, the slip at which the grip is used up (4.10)-(4.12): the thesis' open request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_ident.doctor.swivels.anchor import Anchor
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.explained import Explained, explained
from ssmr_ident.doctor.swivels.screen import given_way

PATH = "tire.lambda_max"
TRIED = (0.1, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0)
HARMLESS = 0.3
"""Up to it nothing changes in a swivel: the wheels slip by more than that all the time."""
ROUNDS_EACH = 2  # places that a value is simulated at
SCATTER = 2.0
"""Of log likelihoods by the chance of simulated runs: where lambda_max does nothing they differed by up to 6."""
SURE = 2.0  # standard deviations of chance
FOREIGN_DB = 3.5
"""Own error of a baseline from which on it is no model of this robot; fits to robots that it describes leave 3 dB."""
REACH = 60.0  # of log likelihood that slopes of its own may gain a value
DROP = 1.92  # of the log likelihood at the ends of a 95 % interval


@dataclass(frozen=True, eq=False)
class GripProfile(Shown):
    """Log likelihood over lambda_max, everything else giving way at each value.

    ``lower`` is None where every smaller value fits as well, ``upper`` where every larger one does; ``own_error_db``
    is the tau of the baseline, and ``anchor`` the baseline with the best value.
    """

    tried: np.ndarray
    log_likelihood: np.ndarray
    best: float
    lower: float | None
    upper: float | None
    own_error_db: float = 0.0
    anchor: Anchor | None = None

    def moves(self, baseline: Explained) -> bool:
        """Whether a value fits by more than another search would have gained the baseline with its own."""
        return self.lower is not None and float(self.log_likelihood.max()) - baseline.evidence > REACH

    def __str__(self) -> str:
        if self.own_error_db > FOREIGN_DB:
            return (
                f"lambda_max: {self.best:.2g} fits best, but the model is {self.own_error_db:.1f} dB off these spectra "
                "for reasons of its own, so no interval is given"
            )
        if self.lower is None and self.upper is None:
            return "lambda_max: these recordings cannot tell it; every value up to 1 fits as well"
        if self.lower is None:
            return f"lambda_max: below {self.upper:.2g} (95 %), and these recordings cannot tell smaller values apart"
        if self.upper is None:
            return f"lambda_max: above {self.lower:.2g} (95 %)"
        return f"lambda_max: {self.best:.2g}, between {self.lower:.2g} and {self.upper:.2g} (95 %)"


def grip_profile(
    baseline: Explained, slopes: np.ndarray | None, fitted_on: tuple[Condition, ...], advance: Callable[[], None]
) -> GripProfile:
    """Profile lambda_max on the recordings that the baseline was fitted on: everything else gives way at each value.

    What gives way makes up for much of a wrong lambda_max; held at one fit's values the interval would be far too
    narrow, and in the wrong place.

    Parameters
    ----------
    baseline : Explained
        As it was fitted.
    slopes : (n, p) float or None
        Of its residuals, by which it gives way.
    fitted_on : tuple of Condition
    advance : callable
        Called once per value.
    """
    own = baseline.anchor.bench.parameters.number(PATH, 0.0)
    fits = []
    for value in TRIED:
        held = own if value == TRIED[0] and 0.0 <= own <= HARMLESS else value
        fits.append(_beside(baseline, held, slopes, fitted_on))
        advance()
    found = profile(np.array(TRIED), np.array([one.evidence for one in fits]), 0.0, SCATTER)
    best = fits[int(np.argmax(found.log_likelihood))]
    return replace(found, own_error_db=best.target.tau_db, anchor=best.anchor)


def _beside(
    baseline: Explained, value: float, slopes: np.ndarray | None, fitted_on: tuple[Condition, ...]
) -> Explained:
    """The baseline with another lambda_max, where it stood or where it gives way to, whichever fits better."""
    anchor = replace(baseline.anchor, fixed={PATH: value})
    best = replace(baseline, anchor=anchor, evidence=-np.inf)
    for _ in range(ROUNDS_EACH):
        anchor.bench.prefetch((c, anchor.values, {}, seed) for c in fitted_on for seed in anchor.seeds)
        found = explained(anchor, None, {}, fitted_on)
        blocks = anchor.blocks(fitted_on, {}, 0.0)
        if found is None or blocks is None:
            break
        best = max(best, found, key=lambda one: one.evidence)
        if slopes is None:  # nothing can give way
            break
        residual = np.concatenate([block.residual for block in blocks])
        anchor = replace(anchor, z=given_way(anchor, residual, slopes))
    return best


def profile(
    tried: np.ndarray, log_likelihood: np.ndarray, own_error_db: float = 0.0, scatter: float = 0.0
) -> GripProfile:
    """The interval where the log likelihood is within 1.92 of its best, and what chance adds, between the values tried.

    Parameters
    ----------
    tried, log_likelihood : (n,) float
    own_error_db : float [dB]
    scatter : float
        Standard deviation of a log likelihood by the chance of simulated runs.
    """
    best = int(np.argmax(log_likelihood))
    limit = log_likelihood[best] - DROP - SURE * np.sqrt(2.0) * scatter

    def crossing(inside: int, outside: int) -> float:
        a, b = log_likelihood[inside], log_likelihood[outside]
        # a peak between values tried is no sharper than they lie apart
        share = 1.0 if not np.isfinite(b) else float(np.clip((a - limit) / (a - b), 0.5, 1.0))
        return float(tried[inside] + share * (tried[outside] - tried[inside]))

    allowed = np.flatnonzero(log_likelihood >= limit)
    first, last = int(allowed[0]), int(allowed[-1])
    lower = None if first == 0 else crossing(first, first - 1)
    upper = None if last == len(tried) - 1 else crossing(last, last + 1)
    return GripProfile(tried, log_likelihood, float(tried[best]), lower, upper, own_error_db)
