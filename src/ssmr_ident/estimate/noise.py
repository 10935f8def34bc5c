"""Noise of a rig's channels, from what a fit leaves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import ss2tf

from ssmr_ident.estimate.motor import drive_of
from ssmr_ident.estimate.node import stepped
from ssmr_ident.estimate.pieces import Piece, white_of
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.signals.noise import AutoregressiveNoise, burg_noise, process_noise

Array = np.ndarray

LARGEST_ORDER = 12
"""Of the autoregressive noise."""


FAST = 0.02
"""Share of a channel's size, in its loudest recording, beyond which differences are taken to see the motion as well as
noise, until a fit has told the two apart."""

LEAST = 1e-4
"""The same below which a log has no digits: in a stretch that stands still differences show nothing at all."""


def first_white(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """The same pieces with white noise as it is known before any fit: a channel's in its quietest recording, for
    differences show noise and motion together."""
    density: dict[str, float] = {}
    size: dict[str, float] = {}
    for piece in pieces:
        for name, white, spread in zip(piece.channels, piece.white, piece.y.std(axis=0), strict=True):
            density[name] = min(density.get(name, math.inf), float(white) / math.sqrt(piece.rate))
            size[name] = max(size.get(name, 0.0), float(spread))
    found = []
    for piece in pieces:
        shown = [density[name] * math.sqrt(piece.rate) for name in piece.channels]
        white = [min(max(w, LEAST * size[n]), FAST * size[n]) for w, n in zip(shown, piece.channels, strict=True)]
        found.append(replace(piece, white=np.array(white)))
    return tuple(found)


def own_noise(
    problem: Problem, fit: Fit, largest_order: int = LARGEST_ORDER
) -> tuple[tuple[AutoregressiveNoise, ...], ...]:
    """What a fit leaves, recording by recording and channel by channel, as noise: its own, and what comes
    through the rig from a force that was measured with noise, or not at all; both white if ``largest_order`` is 0."""
    found: dict[int, tuple[AutoregressiveNoise, ...]] = {}
    recordings = {p.recording for p in problem.pieces}
    for recording in recordings:
        own = [k for k, p in enumerate(problem.pieces) if p.recording == recording]
        spent = round(fit.dof / len(recordings)) + 2 * len(own)
        parts = [problem.pieces[k].counted(fit.residuals[k]) for k in own]
        channels = range(parts[0].shape[1])
        if problem.pieces[own[0]].band is not None:  # frequencies there are other ones than the rig's
            whole = np.vstack([part - part.mean(axis=0) for part in parts])
            found[recording] = tuple(burg_noise(whole[:, c], largest_order, spent) for c in channels)
            continue
        systems = from_force(problem.pieces[own[0]], fit)
        found[recording] = tuple(
            process_noise([part[:, c] for part in parts], *systems[c], largest_order, spent) for c in channels
        )
    return tuple(found[p.recording] for p in problem.pieces)


def from_force(piece: Piece, fit: Fit) -> list[tuple[Array, Array]]:
    """Numerator and denominator from what drives a piece, or a force where nothing does, to each channel, in falling
    powers of z, by a fit's masses, dampings and stiffnesses alone."""
    bare = replace(fit.node, members=())
    values = fit.node.values(fit.point)[: len(bare.baseline)]
    motor = drive_of(values) if piece.motor is not None else None
    if motor is not None and piece.motor is not None:  # it brakes, and its controller holds
        values[1] += motor.braking
        values[2] += motor.gain * piece.motor.gain
    (transition, now, later, *_), (rows, by_drive, *_) = stepped(bare, values, piece.seen, 1.0 / piece.rate)
    # a drive in straight lines enters with its next value: that part belongs to the output
    entering = (now + transition @ later)[:, None]
    through = (rows @ later + by_drive)[:, None]
    numerators, denominator = ss2tf(transition, entering, rows, through)
    return [(numerator, denominator) for numerator in numerators]


def left_white(problem: Problem, fit: Fit) -> Problem:
    """White noise from what a fit leaves, whose differences the motion itself is not in."""
    together: dict[int, list[Array]] = {}
    for piece, rest in zip(problem.pieces, fit.residuals, strict=True):
        together.setdefault(piece.recording, []).append(rest)
    pieces, noises = [], []
    for piece in problem.pieces:
        least = 1e-2 * piece.white  # a log has no more digits than its converter
        left = np.vstack(together[piece.recording])
        white = np.maximum(white_of(left, piece.rate, piece.band), least)
        pieces.append(replace(piece, white=white))
        noises.append(tuple(AutoregressiveNoise(np.ones(1), float(w)) for w in white))
    return replace(problem, pieces=tuple(pieces), noises=tuple(noises))
