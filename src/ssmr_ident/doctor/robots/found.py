"""What a search has fitted."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.doctor.decays.linear import LinearFit
from ssmr_ident.doctor.decays.recordings import Decay
from ssmr_ident.doctor.robots.members import Member
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import JointFit

Array = np.ndarray


def cost_of(fit: JointFit) -> float:
    """Sum of squares of a simulated fit, of its priors and its recordings' own; inf where it burst."""
    return fit.rss + fit.penalty if np.isfinite(fit.rss) else math.inf


@dataclass(frozen=True, eq=False)
class Found:
    """A model fitted to all of the recordings.

    Parameters
    ----------
    members : tuple of Member
        Beside the baseline, in the order in which they were found.
    linear : LinearFit or None
        In closed form.
    fit : JointFit or None
        By the simulator.
    gained : float
        Fall of the cost by the last step by differences between simulations; inf where none was made.
    """

    members: tuple[Member, ...]
    linear: LinearFit | None
    fit: JointFit | None
    gained: float = math.inf

    @property
    def cost(self) -> float:
        """By the simulator where that was asked."""
        if self.fit is not None:
            return cost_of(self.fit)
        assert self.linear is not None
        return self.linear.cost

    @property
    def chi2(self) -> float:
        if self.fit is not None:
            return self.fit.rss
        assert self.linear is not None
        return self.linear.chi2

    @property
    def model(self) -> Model:
        found = self.fit or self.linear
        assert found is not None
        return found.model

    @property
    def point(self) -> Array:
        found = self.fit or self.linear
        assert found is not None
        return found.point


@dataclass(eq=False)
class Search:
    """What has been fitted.

    Parameters
    ----------
    baseline : Found
    found : list of Found
        With effects beside it.
    decays : tuple of Decay
        Where there is nothing else, and what is linear has been fitted in closed form; else empty.
    looked_at : int
        Effects that were tried beside the baseline, by fits or a score test.
    has_laws : bool
        Whether laws were tried beside the baseline.
    """

    baseline: Found
    found: list[Found] = field(default_factory=list)
    decays: tuple[Decay, ...] = ()
    looked_at: int = 0
    has_laws: bool = False

    @property
    def all(self) -> list[Found]:
        return [self.baseline, *self.found]

    @property
    def best(self) -> Found:
        return min(self.all, key=lambda f: f.cost)

    @property
    def samples(self) -> int:
        assert self.baseline.fit is not None
        return self.baseline.fit.size

    def over(self, found: Found) -> float:
        """RMS of the whitened residuals: 1 for noise alone."""
        return math.sqrt(found.chi2 / self.samples)

    def put(self, found: Found, new: Found) -> None:
        """One in place of another."""
        if found is self.baseline:
            self.baseline = new
        self.found = [new if f is found else f for f in self.found]

    def add(self, found: Found) -> None:
        """Of one set of effects in one formula the better."""
        key = [(m.id, m.form) for m in found.members]
        same = [f for f in self.found if [(m.id, m.form) for m in f.members] == key]
        if not same or found.cost < same[0].cost:
            self.found = [f for f in self.found if f not in same] + [found]
