"""A drive without a spring: Coulomb friction where the recordings have it, and what of it is the force's zero."""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.doctor.laws import FORMS, proposals
from ssmr_ident.doctor.named import begun
from ssmr_ident.doctor.rules import CERTAIN
from ssmr_ident.doctor.table import FRICTION, log_evidence
from ssmr_ident.estimate.baseline import BOTH_WHITE, STEPS, on_every_sample, on_few_samples, under_own_noise
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.generic import STATIC
from ssmr_ident.estimate.network import paths_of
from ssmr_ident.estimate.values import Fit, Problem, Start


def with_friction(problem: Problem, fit: Fit) -> tuple[Problem, Fit] | None:
    """Dry friction beside mass and damper, under the noise that it leaves; None where it is not certainly better.

    Parameters
    ----------
    problem : Problem
        Under the noise that is known before any fit.
    fit : Fit
        The baseline's.

    Notes
    -----
    Noise stays white, at the sensor and in the force: of what a model leaves that is wrong in small things an
    autoregressive model of many terms makes noise where these things are, and friction is then read elsewhere.
    """
    few, base, begins, _ = on_few_samples(problem)
    form = next(f for f in FORMS if f.effect == FRICTION and f.kind == STATIC)
    # along the baseline's own motion the baseline leaves no force at all
    (offer,) = proposals(few, base, paths_of(few, base.node, base.point), forms=[form])
    found = on_every_sample(problem, few, begun(few, offer, base), begins)
    quiet, found = under_own_noise(problem, found, BOTH_WHITE)
    plain = polish(quiet, fit.node, Start(fit.point, fit.nuisances), STEPS)
    gained = log_evidence(found, quiet.samples) - log_evidence(plain, quiet.samples)
    return (quiet, found) if gained > CERTAIN else None


def told(problem: Problem, fit: Fit) -> list[str]:
    """What is said of friction that was fitted."""
    unit = "N m" if problem.pieces[0].units[0].startswith("rad") else "N"
    k = next(k for k, c in enumerate(fit.node.coordinates) if c.name == "F_c_N")
    friction = float(fit.node.values(fit.point)[k])
    std = math.sqrt(max(float(fit.covariance[k, k]), 0.0)) * abs(float(fit.node.slopes(fit.point)[k]))
    said = [f"dry friction of {friction:.4g} ± {std:.2g} {unit} was fitted beside mass and damper: it is not in the "
            "baseline model"]  # fmt: skip
    zeros = [float(n[fit.node.states]) for n, p in zip(fit.nuisances, problem.pieces, strict=True) if p.driven]
    if zeros:
        zero = float(np.mean(zeros))
        said.append(
            f"the force's zero is {zero:+.3g} {unit} off; friction {2.0 * abs(zero):.3g} {unit} larger one way "
            "than the other would do the same: these recordings tell the two only together"
        )
    return said
