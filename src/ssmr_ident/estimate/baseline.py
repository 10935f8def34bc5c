"""The linear rig or network on its recordings: what ``ident fit`` says, and what a diagnosis begins with."""

from __future__ import annotations

import numpy as np

from ssmr_ident.estimate.coarser import coarser
from ssmr_ident.estimate.earlier import earlier
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.network import paths_of
from ssmr_ident.estimate.node import Node
from ssmr_ident.estimate.noise import LARGEST_ORDER, left_white, own_noise
from ssmr_ident.estimate.regression import regressed
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.stretches import sampled
from ssmr_ident.estimate.values import Fit, Problem, Start, with_noises
from ssmr_ident.physics.network import ONE

STEPS = 25
"""Gauss-Newton steps."""

BOTH_WHITE = 0
"""Order of autoregressive noise where the sensor's noise and what comes through the rig are both taken as white."""

IN_TURN = 2
"""Times that noise and fit follow from each other (iterated generalised least squares): what a fit under white noise
leaves is not yet the noise of the fit under its own."""


def baseline_fit(problem: Problem) -> Fit:
    """Multiple shooting from paths, then the exact motion.

    A rig begins at a regression of the force along its path, whatever the file says, and a network at what is known.
    """
    node = Node(problem.baseline, layout=problem.layout)
    known = np.array([c.mean for c in problem.baseline])
    paths = paths_of(problem, node, known)
    begin = regressed(problem, paths, node) if problem.layout == ONE else known
    return polish(problem, node, shot(problem, node, Start(begin, paths=tuple(paths))), STEPS)


def on_few_samples(problem: Problem) -> tuple[Problem, Fit, tuple[int, ...], float]:
    """What a search begins with: means of several samples in stretches of long recordings, the baseline's fit of them,
    the number of each recording's first stretch, and what share of the motion they are.

    Where no spring holds the mass nothing is averaged, for friction turns as fast as the force does, and the noise
    comes through the mass.
    """
    few, begins, share = sampled(problem if problem.drifts else coarser(problem))
    fit = baseline_fit(few)
    if few.drifts:
        few, fit = under_own_noise(few, fit, BOTH_WHITE)
    return few, fit, begins, share


def fitted_baseline(problem: Problem) -> tuple[Problem, Fit]:
    """The baseline on every sample under the noise that it leaves, and the problem with that noise.

    It begins as a search does.
    """
    few, fit, begins, _ = on_few_samples(problem)
    order = BOTH_WHITE if problem.drifts else LARGEST_ORDER
    return under_own_noise(problem, on_every_sample(problem, few, fit, begins), order)


def on_every_sample(problem: Problem, few: Problem, fit: Fit, begins: tuple[int, ...]) -> Fit:
    """A fit of fewer samples to its end on all; ``begins`` are the numbers of each recording's first stretch.

    Where no spring holds the mass it goes on under the noise of the fewer.
    """
    if problem.drifts:
        problem = with_noises(problem, [few.noises[first] for first in begins])
    return polish(problem, fit.node, earlier(few, fit, problem, begins), STEPS)


def under_own_noise(problem: Problem, fit: Fit, largest_order: int = LARGEST_ORDER) -> tuple[Problem, Fit]:
    """The problem under the noise that its fit leaves, and that fit."""
    own = problem
    for _ in range(IN_TURN):
        white = left_white(problem, fit)
        own = with_noises(white, own_noise(white, fit, largest_order))
        fit = polish(own, fit.node, Start(fit.point, fit.nuisances), STEPS)
    return own, fit
