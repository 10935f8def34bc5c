"""The table of explanations: each fit in one unit, log evidence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.doctor.left import Left
from ssmr_ident.doctor.rules import GRAIN, LOOP, SEEN
from ssmr_ident.estimate.generic import SMOOTH
from ssmr_ident.estimate.node import MEMORY, Member
from ssmr_ident.estimate.simulated import GEARS
from ssmr_ident.estimate.values import Fit, Problem

FRICTION, UNLISTED = "dry_friction", "unlisted"
SHARE = "c"
"""Of the load, in the friction of gears."""


@dataclass(frozen=True, eq=False)
class Row:
    """A fitted node.

    Parameters
    ----------
    ids : tuple of str
        Effects, in the order in which they were found; empty for the baseline.
    kinds : tuple of str
    name : str
        With formulas.
    generic : bool
        Whether a member of it takes any shape.
    log_evidence : float
        Natural; of the baseline 0.
    chi2 : float
        Of the whitened residuals.
    samples : float
        Number of them.
    over : float
        RMS of the residuals in sizes of the channels' white noise.
    left : Left
        What is left, window by window; of the baseline and of two named effects.
    heldout : float
        Error on what was kept back, in the metric; nan where nothing was, or it was not asked for.
    innovations : float
        RMS of what is left there under the noise of the recordings fitted, where no spring holds the mass and a run
        from its start adds up what no model knows; else nan.
    fit : Fit or None
    kept : Fit or None
        The same with starts and zeros of what was kept back.
    variables : tuple of str
        Of which alone each member is a function; empty where it is of several, or is no static force.
    smooth : bool
        Whether a shape of it has no step where the motion turns.
    equal : tuple of str
        The same effects by other names, where another law makes the same force; else empty.
    """

    ids: tuple[str, ...]
    kinds: tuple[str, ...]
    name: str
    generic: bool
    log_evidence: float
    chi2: float
    samples: float
    over: float = 1.0
    left: Left = field(default_factory=lambda: Left(math.inf))
    heldout: float = math.nan
    innovations: float = math.nan
    fit: Fit | None = None
    kept: Fit | None = None
    variables: tuple[str, ...] = ()
    smooth: bool = False
    equal: tuple[str, ...] = ()

    @property
    def unseen(self) -> float:
        """Error on what was kept back, by which two models are compared."""
        return self.heldout if math.isnan(self.innovations) else self.innovations


def grain(rows: Sequence[Row]) -> float:
    """Log evidence that is not to be believed: what ``GRAIN`` of the baseline's misfit amounts to."""
    base = next(r for r in rows if not r.ids)
    return 0.5 * GRAIN * max(base.chi2 - min(r.chi2 for r in rows if math.isfinite(r.chi2)), 0.0)


def log_evidence(fit: Fit, samples: float) -> float:
    """Schwarz's (1978) approximation, with the parameters that the data decide in place of their number."""
    return -0.5 * fit.cost - 0.5 * fit.dof * math.log(samples)


def row_of(fit: Fit, problem: Problem, zero: float = 0.0) -> Row:
    members = fit.node.members
    return Row(
        tuple(_called(fit, m) for m in members), tuple(m.kind for m in members), fit.node.name, fit.node.generic,
        log_evidence(fit, problem.samples) - zero, fit.left, problem.samples, over_noise(problem, fit), fit=fit,
        variables=tuple(m.variable for m in members), smooth=any(m.form == SMOOTH for m in members),
        equal=_equal(fit, problem.size),
    )  # fmt: skip


def _called(fit: Fit, member: Member) -> str:
    """A member's law; friction of gears in which no load is seen is dry friction."""
    if member.id != GEARS:
        return member.id
    at = next(k for k, c in enumerate(fit.node.coordinates) if c.name == SHARE and c in member.coordinates)
    share, slope = fit.node.values(fit.point)[at], fit.node.slopes(fit.point)[at]
    return GEARS if share > SEEN * abs(slope) * math.sqrt(max(fit.covariance[at, at], 0.0)) else FRICTION


def _equal(fit: Fit, size: float) -> tuple[str, ...]:
    """Friction whose travel is as large as the motion is a loop by another name."""
    names = [m.id for m in fit.node.members]
    for k, member in enumerate(fit.node.members):
        if member.id == FRICTION and member.kind == MEMORY:
            own = fit.node.of(member, fit.point)
            if own["F_c_N"] > LOOP * size * own["element_stiffness_N_m"]:
                names[k] = "hysteresis"
    return tuple(names) if names != [m.id for m in fit.node.members] else ()


def over_noise(problem: Problem, fit: Fit) -> float:
    """RMS of the residuals in sizes of white noise, which is what they show from sample to sample at the least."""
    total, count = 0.0, 0
    for piece, rest in zip(problem.pieces, fit.residuals, strict=True):
        own = piece.counted(rest - rest.mean(axis=0))
        total += float(np.sum((own / piece.white) ** 2))
        count += piece.samples()
    return math.sqrt(total / max(count, 1))
