"""The next recording of a rig or a network: what it can do, simulated under every explanation that is left.

Every plan stays within the session: no larger force, motion or reading, no other band and no longer than what was
recorded.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.diagnose.deciding import advice, best_of, chance_of_deciding
from ssmr_ident.diagnose.quantity import prefixed
from ssmr_ident.diagnose.words import readable
from ssmr_ident.doctor.decide import Decision
from ssmr_ident.doctor.table import Row
from ssmr_ident.estimate.exact import polish
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.simulated import Compiled, motions
from ssmr_ident.estimate.values import Fit, Problem, Start

Array = np.ndarray

LEFT = 3
"""Explanations that are held against each other at the most."""

SHARES = {1.0: "", 0.5: "half", 0.25: "a quarter of", 0.125: "an eighth of"}
"""Of the largest motion or force so far."""

NEAREST = 3
"""Plans that are looked at with all that a rival may move."""

QUIET = 3.0
"""Sizes of white noise that a plan's motion has at least."""

STEPS = 8
"""Of a rival's way to what another explanation predicts."""

SWEEP = 4.0
"""Times a sweep differs from what was recorded: as much as a quarter of the size."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A recording that has not been made.

    Parameters
    ----------
    words : str
        What to do, beginning with a capital letter.
    index : int
        Of the recorded piece that it is a variant of.
    drive : (n·every + 1,) float
    share : float
        Of the recorded start.
    change : float
        By how much it differs from what was recorded, at least 1.
    """

    words: str
    index: int
    drive: Array
    share: float
    change: float


def next_recording(problem: Problem, rows: Sequence[Row], decision: Decision, undetermined: bool) -> str:
    """One experiment in one sentence; empty where nothing is left to tell apart.

    Parameters
    ----------
    problem : Problem
        As it was fitted.
    rows : sequence of Row
        The table, best first.
    decision : Decision
    undetermined : bool
        Whether nothing was named.
    """
    left = _explanations(rows, decision, undetermined)
    if len(left) < 2:
        return ""
    fits = [row.fit for row in left if row.fit is not None]
    evidence = np.array([row.log_evidence for row in left])
    every = [plan for index in _loudest(problem) for plan in _plans(problem, fits[0], index)]
    rough = [_distances(problem, fits, plan, held=True) for plan in every]
    seen = [k for k, far in enumerate(rough) if far is not None]
    order = sorted(seen, key=lambda k: -_nearest(rough[k]))[:NEAREST]
    found = [(every[k], apart) for k in order if (apart := _distances(problem, fits, every[k], held=False)) is not None]
    if not found:
        return ""
    chances = np.array([chance_of_deciding(evidence, apart) for _, apart in found])
    best = best_of(chances, np.array([plan.change for plan, _ in found]))
    names = tuple(dict.fromkeys(readable("+".join(row.ids)) if row.ids else "no further physics" for row in left))
    return advice(found[best][0].words, names, float(chances[best])) if len(names) > 1 else ""


def _explanations(rows: Sequence[Row], decision: Decision, undetermined: bool) -> list[Row]:
    """Rows that are left, the chosen one first: its ties by their best fits; without a name, the likeliest few."""
    fitted = [row for row in rows if row.fit is not None and math.isfinite(row.log_evidence)]
    if undetermined:
        own = list({row.ids: row for row in reversed(fitted) if not row.generic and len(row.ids) < 2}.values())
        return sorted(own, key=lambda row: -row.log_evidence)[:LEFT]
    if decision.chosen is None or not decision.ties:
        return []
    best: dict[tuple[str, ...], Row] = {}
    for row in fitted:
        if not row.generic and set(row.ids) - set(decision.chosen.ids) and set(row.ids) <= _names(decision):
            best.setdefault(row.ids, row)
    return [decision.chosen, *sorted(best.values(), key=lambda row: -row.log_evidence)][:LEFT]


def _names(decision: Decision) -> set[str]:
    assert decision.chosen is not None
    return {*decision.chosen.ids, *decision.ties}


def _loudest(problem: Problem) -> list[int]:
    """The loudest piece that begins where its recording does, let go and driven."""
    found: dict[tuple, int] = {}
    for index, piece in enumerate(problem.pieces):
        key = (piece.driven, piece.based, piece.into, piece.channels)
        if key not in found or piece.sizes[-1] > problem.pieces[found[key]].sizes[-1]:
            found[key] = index
    return list(found.values())


def _plans(problem: Problem, fit: Fit, index: int) -> Iterator[Plan]:
    piece = problem.pieces[index]
    loud = float(np.min(piece.y.std(axis=0) / piece.white))
    for share, how in SHARES.items():
        if share * loud < QUIET and share != 1.0:
            continue
        words = _released(problem, fit, index, share, how) if not piece.driven else _driven(piece, share, how)
        yield Plan(words, index, share * piece.drive, share, 1.0 / share)
    if piece.driven and piece.motor is None:
        yield from _sweep(problem, fit, index)


def _released(problem: Problem, fit: Fit, index: int, share: float, how: str) -> str:
    piece = problem.pieces[index]
    again = f"with {how} the motion of {piece.name}" if how else f"as in {piece.name} once more"
    lasts = f"and record {piece.time[-1] - piece.time[0]:.2g} s"
    if len(problem.layout.bodies) > 1:
        return f"Let it go {again} {lasts}"
    state = fit.nuisances[index]
    size = share * math.hypot(state[0], state[1] / (2.0 * math.pi * problem.frequency))
    turns = any(c.name.endswith("inertia_kg_m2") for c in problem.baseline)
    return f"Let it go {again}, from {f'{math.degrees(size):.2g}°' if turns else prefixed(size, 'm')}, {lasts}"


def _driven(piece: Piece, share: float, how: str) -> str:
    what = "signal of the motor" if piece.motor else "motion of the foot" if piece.based else "force"
    lasts = f"and record {piece.time[-1] - piece.time[0]:.2g} s"
    return (
        f"Drive it with {how} the {what} of {piece.name} {lasts}"
        if how
        else f"Drive it as in {piece.name} once more {lasts}"
    )


def _sweep(problem: Problem, fit: Fit, index: int) -> Iterator[Plan]:
    """A slow sine through the band that drove so far, as large as force and readings have been."""
    piece = problem.pieces[index]
    time = piece.step * np.arange(len(piece.drive))
    power = np.cumsum(np.abs(np.fft.rfft(piece.drive - piece.drive.mean())) ** 2)
    hz = np.interp([0.02, 0.98], power / max(power[-1], 1e-300), np.fft.rfftfreq(len(time), piece.step))
    phase = 2.0 * np.pi * (hz[0] * time + 0.5 * (hz[1] - hz[0]) * time**2 / time[-1])
    shown = np.max([np.abs(p.y).max(axis=0) for p in problem.pieces if p.channels == piece.channels], axis=0)
    size = float(np.abs(piece.drive).max())
    for _ in range(3):
        plan = Plan("", index, size * np.sin(phase), 0.0, SWEEP)
        y = _simulated(problem, fit, plan)
        if y is None:
            return
        over = float(np.max(np.abs(y) / shown))
        if over <= 1.0:
            break
        size /= 1.05 * over
    unit = "m/s²" if piece.based else "N m" if piece.units[0].startswith("rad") else "N"
    words = (
        f"Sweep the {'foot' if piece.based else 'force'} from {hz[0]:.2g} to {hz[1]:.2g} Hz in {time[-1]:.2g} s, at an "
        f"amplitude of {prefixed(size, unit)}"
    )
    yield replace(plan, words=words)


def _piece(problem: Problem, plan: Plan) -> Piece:
    piece = problem.pieces[plan.index]
    motor = replace(piece.motor, signal=plan.share * piece.motor.signal) if piece.motor else None
    return replace(piece, drive=plan.drive, motor=motor, counts=np.ones_like(piece.counts))


def _begun(fit: Fit, plan: Plan) -> Array:
    """States that grow with the plan; the drive's zero, gain and the channels' own stay out."""
    own = np.zeros_like(fit.nuisances[plan.index])
    states = slice(0, fit.node.states)
    own[states] = plan.share * fit.nuisances[plan.index][states]
    return own


def _simulated(problem: Problem, fit: Fit, plan: Plan) -> Array | None:
    """Channels, (n, c) float; None where the simulation leaves the finite numbers, or nothing moves."""
    piece = _piece(problem, plan)
    (y,) = motions(Compiled.of(problem, fit.node, fit.point, (piece,)), [_begun(fit, plan)])
    return y if np.all(np.isfinite(y)) and np.any(y) else None


def _distances(problem: Problem, fits: Sequence[Fit], plan: Plan, held: bool) -> Array | None:
    """(m, m) float: how far each one's prediction is from the nearest that the others come to it, in noise.

    ``held`` moves nothing but the start of the new recording; otherwise all that the recordings so far leave open moves
    with it.
    """
    apart = np.zeros((len(fits), len(fits)))
    noise = problem.noises[plan.index]
    for i, truth in enumerate(fits):
        y = _simulated(problem, truth, plan)
        if y is None:
            return None
        new = replace(_piece(problem, plan), y=y)
        alone = replace(problem, pieces=(new,), noises=(noise,))
        whole = replace(problem, pieces=(*problem.pieces, new), noises=(*problem.noises, noise))
        for j, rival in enumerate(fits):
            if i == j:
                continue
            if held:
                start = Start(rival.point, (_begun(rival, plan),))
                found = polish(alone, rival.node, start, STEPS, freeze=range(len(rival.point)))
                cost = found.chi2
            else:
                start = Start(rival.point, (*rival.nuisances, _begun(rival, plan)))
                cost = polish(whole, rival.node, start, STEPS).cost - rival.cost
            apart[i, j] = math.sqrt(max(cost, 0.0)) if math.isfinite(cost) else math.inf
    return apart


def _nearest(apart: Array | None) -> float:
    assert apart is not None
    return float(apart[~np.eye(len(apart), dtype=bool)].min())
