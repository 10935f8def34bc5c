"""What is kept back, and how a fit is held against it."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from ssmr_ident.doctor.fitted import FAR_OFF, carried
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.generic import BY_RECORDING
from ssmr_ident.estimate.network import paths_of
from ssmr_ident.estimate.pieces import Piece, cut
from ssmr_ident.estimate.regression import starts_of
from ssmr_ident.estimate.shooting import shot
from ssmr_ident.estimate.stretches import moving
from ssmr_ident.estimate.values import Fit, Problem, Start, with_noises

STRETCHES, EVERY_THIRD = 6, 3
"""A lone recording is cut into as many; every third is kept back."""

PERIODS = 2.0
"""That a stretch holds at least."""

STEPS = 12
"""Gauss-Newton steps of starts and zeros."""


def interleaved(problem: Problem) -> tuple[Problem, Problem | None]:
    """Stretches of a lone recording where it moves: some to fit, some kept back; None where there is too little."""
    fitted: list[Piece] = []
    kept: list[Piece] = []
    for piece in problem.pieces:
        span = moving(piece)
        shortest = int(PERIODS * piece.rate / problem.frequency)
        count = min(STRETCHES, span // max(shortest, 8))
        if count < EVERY_THIRD:
            fitted.append(piece)
            continue
        edges = np.linspace(0, span, count + 1).astype(int)
        parts = [cut(piece, a, b) for a, b in itertools.pairwise(edges)]
        if span < len(piece.y) - shortest:
            parts.append(cut(piece, span, len(piece.y)))
        for k, part in enumerate(parts):
            held = k % EVERY_THIRD == EVERY_THIRD - 1 and k < count
            (kept if held else fitted).append(part)
    if not kept:
        return problem, None
    return _of(problem, fitted), _of(problem, kept)


def with_motion(kept: Problem, fitted: Problem) -> Problem | None:
    """What moves above the noise that a fit of other recordings left, up to where it comes to rest; None where nothing
    does: there is nothing to foretell."""
    density: dict[str, float] = {}
    for piece in fitted.pieces:
        for name, white in zip(piece.channels, piece.white / math.sqrt(piece.rate), strict=True):
            density[name] = max(density.get(name, 0.0), float(white))
    parts = []
    for piece in kept.pieces:
        known = np.array([density[name] * math.sqrt(piece.rate) for name in piece.channels])
        span = len(piece.y) if piece.driven else moving(replace(piece, white=known))
        if span:
            parts.append(piece if span == len(piece.y) else cut(piece, 0, span))
    return _of(kept, parts) if parts else None


def _of(problem: Problem, pieces: list[Piece]) -> Problem:
    noise = dict(zip((id(p.white) for p in problem.pieces), problem.noises, strict=True))
    return replace(problem, pieces=tuple(pieces), noises=tuple(noise[id(p.white)] for p in pieces))


def innovations(kept: Problem, held: Fit, fitted: Problem) -> float:
    """RMS of what a model leaves of other recordings under the noise of those that it was fitted to.

    nan where a spring holds the mass, or no recording fitted has the rate of one kept back. ``held`` : its fit on them.
    """
    noises = {round(p.rate, 6): noise for p, noise in zip(fitted.pieces, fitted.noises, strict=True)}
    if not kept.drifts or any(round(p.rate, 6) not in noises for p in kept.pieces):
        return math.nan
    noisy = with_noises(kept, [noises[round(p.rate, 6)] for p in kept.pieces])
    again = polish(noisy, held.node, Start(held.point, held.nuisances), STEPS, freeze=range(len(held.point)))
    return math.sqrt(again.left / max(noisy.samples, 1))


def held_fit(kept: Problem, fit: Fit, near: Fit | None = None) -> Fit | None:
    """A fit's model on other recordings, their starts and zeros alone refitted.

    None for a law by recording, and for one that leaves the finite numbers. ``near`` : another fit on the same ones,
    whose starts are begun from.
    """
    if any(BY_RECORDING in m.form for m in fit.node.members):
        return None
    paths = Start(fit.point, paths=tuple(paths_of(kept, fit.node, fit.point)))
    begun = tuple(starts_of(kept, fit.node, paths)) if near is None else carried(fit.node, near)
    still = range(len(fit.point))
    found = polish(kept, fit.node, Start(fit.point, begun), STEPS, freeze=still)
    if found.chi2 / _count(found) > FAR_OFF * fit.chi2 / _count(fit):  # from there it has lost its way
        joined = shot(kept, fit.node, paths, held=True)
        found = min(found, polish(kept, fit.node, joined, STEPS, freeze=still), key=lambda f: f.cost)
    return found if math.isfinite(found.cost) else None


def _count(fit: Fit) -> int:
    """Of samples that a fit is held against."""
    return sum(rest.size for rest in fit.residuals)
