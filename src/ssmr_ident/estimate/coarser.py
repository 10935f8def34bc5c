"""A problem with fewer samples a period, on which a search is a fraction of the work."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ssmr_ident.estimate.pieces import Piece, blocks_of
from ssmr_ident.estimate.values import Problem
from ssmr_ident.signals.noise import AutoregressiveNoise

COARSE, STEPS = 20, 40
"""Samples and integration steps a period: means over a twentieth of one are off by some per mille of a force beside."""


def coarser(problem: Problem) -> Problem:
    """The same recordings in means of several samples each, under white noise; ``problem`` where it has few already."""
    fastest = max(problem.frequency, problem.fastest)
    # a motor is switched and limited from one sample to the next
    blocks = [1 if p.motor else blocks_of(p.rate, COARSE * fastest, p.band) for p in problem.pieces]
    if max(blocks) == 1:
        return problem
    pieces = tuple(_coarser(p, block, fastest) for p, block in zip(problem.pieces, blocks, strict=True))
    noises = tuple(
        tuple(AutoregressiveNoise(np.ones(1), noise.std / math.sqrt(block)) for noise in own)
        for own, block in zip(problem.noises, blocks, strict=True)
    )
    return replace(problem, pieces=pieces, noises=noises)


def _coarser(piece: Piece, block: int, fastest: float) -> Piece:
    if block == 1:
        return piece
    count = len(piece.y) // block
    y, counts, time = (_means(x, block) for x in (piece.y, piece.counts, piece.time[:, None]))
    every = max(1, math.ceil(STEPS * fastest * block / piece.rate))
    drive = piece.drive
    if piece.driven:  # averaged as the motion is, so that what is linear stays exact
        spread = (block - 1) * piece.every
        means = np.mean([drive[k * piece.every : len(drive) - spread + k * piece.every] for k in range(block)], axis=0)
        drive = np.interp(np.arange(count * every + 1) * (block * piece.every / every), np.arange(len(means)), means)
    return replace(
        piece, time=time[:, 0], y=y, counts=counts > 0.5, drive=drive, step=block * piece.every * piece.step / every,
        every=every, white=piece.white / math.sqrt(block),
        foot=_means(piece.foot, block) if len(piece.foot) > 1 else piece.foot,
    )  # fmt: skip


def _means(samples: np.ndarray, block: int) -> np.ndarray:
    count = len(samples) // block
    return np.asarray(samples[: count * block].reshape(count, block, -1).mean(axis=1))
