"""Every candidate over its starts, the best of them refined, the best few with the baseline set free beside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from ssmr_ident.diagnose.turning.anchor import Anchor, as_columns
from ssmr_ident.diagnose.turning.bench import COARSE, STEP
from ssmr_ident.diagnose.turning.candidates import Candidate, Values
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.likelihood import NEPER_DB, Score

REFINEMENTS = 10  # evaluations per free parameter
POLISH_STEPS = 3
GAINING = 3.0  # of evidence, below which slopes are worn out
REACH = 100.0  # of evidence that another start may gain by being fitted
PITCH = "pitch_m"
RATIOS = (0.5, 2.0 / 3.0, 0.75, 0.8, 1.25, 4.0 / 3.0, 1.5, 2.0, 3.0)
BEHIND = 40.0  # of evidence, from which on a second start is not followed
SPREAD_FACTOR = 3.0
"""Of the curvature's standard deviations, to what errors of simulated sessions need, whose baselines are fitted too."""
_STEP = 0.35  # of a logarithm, or of a hundredth of the bounds


@dataclass(frozen=True, eq=False)
class Explained:
    """One explanation at its best.

    Parameters
    ----------
    candidate : Candidate or None
        None is the baseline.
    values : dict
        Of the candidate's free parameters.
    anchor : Anchor
        Baseline that it goes with.
    target : Score
    share : float
        Of what the anchor misses on calibration recordings, carried over.
    evidence : float
        Log likelihood of targets and calibration, less what free parameters cost.
    spread : (p,) float or None
        Standard deviations of the free parameters on the scales of the search.
    slopes : (n, q) float or None
        Of log densities of calibration and targets over the baseline's parameters, where it was last set free.
    """

    candidate: Candidate | None
    values: Values
    anchor: Anchor
    target: Score
    share: float
    evidence: float
    spread: np.ndarray | None = None
    slopes: np.ndarray | None = None

    @property
    def id(self) -> str:
        return "baseline" if self.candidate is None else self.candidate.id

    @property
    def effects(self) -> dict[str, Values]:
        return {} if self.candidate is None else self.candidate.effects(self.values)


def cost(candidate: Candidate | None, targets: tuple[Condition, ...]) -> float:
    """Half the logarithm of the number of independent values per free parameter (BIC)."""
    if candidate is None:
        return 0.0
    values = sum(c.mean.cross.shape[0] * len(c.names) / 2.0 for c in targets)
    return 0.5 * max(len(candidate.free), 1) * float(np.log(values))


def explained(
    anchor: Anchor, candidate: Candidate | None, values: Values, targets: tuple[Condition, ...]
) -> Explained | None:
    """Score one explanation with one set of values."""
    effects = {} if candidate is None else candidate.effects(values)
    found = anchor.score(targets, effects)
    if found is None:
        return None
    evidence = found[0].log_likelihood + anchor.fit.log_likelihood * bool(anchor.calibration)
    evidence -= 0.0 if anchor.calibration else 0.5 * float(anchor.z @ anchor.z)
    return Explained(candidate, values, anchor, found[0], found[1], evidence - cost(candidate, targets))


def screened(
    anchor: Anchor, candidate: Candidate, targets: tuple[Condition, ...], advance: Callable[[], None]
) -> list[Explained]:
    """The best one or two starts, best first: all on one run at the slowest and fastest speed, these on everything."""
    order = sorted(targets, key=lambda c: abs(c.turning))
    few = tuple({c.kind: c for c in (order[0], order[-1])}.values())
    coarse = replace(anchor, seeds=anchor.seeds[:1], step=COARSE)
    starts = list(candidate.starts)
    if len(starts) > 2:
        jobs = ((c, anchor.values, candidate.effects(start), coarse.seeds[0]) for start in starts for c in few)
        anchor.bench.prefetch(jobs, COARSE)
        rough = [(explained(coarse, candidate, start, few), start) for start in starts]
        ranked = sorted(((one.evidence, i) for i, (one, _) in enumerate(rough) if one is not None), reverse=True)
        starts = [starts[i] for value, i in ranked[:2] if value > ranked[0][0] - BEHIND]
    advance()
    anchor.bench.prefetch(
        (c, anchor.values, candidate.effects(start), seed) for start in starts for c in targets for seed in anchor.seeds
    )
    found = [one for one in (explained(anchor, candidate, start, targets) for start in starts) if one is not None]
    advance()
    return sorted(found, key=lambda one: one.evidence, reverse=True)


def refined(start: Explained, targets: tuple[Condition, ...], advance: Callable[[], None]) -> Explained:
    """Nelder-Mead over the candidate's own parameters, from its best start."""
    candidate = start.candidate
    if candidate is None or not candidate.free:
        return start
    best = [start]

    def objective(position: np.ndarray) -> float:
        effects = candidate.effects(candidate.values(position))
        start.anchor.bench.prefetch(
            (c, start.anchor.values, effects, seed) for c in targets for seed in start.anchor.seeds
        )
        found = explained(start.anchor, candidate, candidate.values(position), targets)
        advance()
        if found is None:
            return 1e9
        if found.evidence > best[0].evidence:
            best[0] = found
        return -found.evidence

    centre = candidate.position(start.values)
    simplex = [centre]
    for i, free in enumerate(candidate.free):
        corner = centre.copy()
        corner[i] += _STEP if free.log else 0.04 * free.span
        if free.log and free.outward(corner[i]) >= free.upper:
            corner[i] = centre[i] - _STEP
        simplex.append(corner)
    minimize(
        objective, centre, method="Nelder-Mead",
        options={"initial_simplex": np.array(simplex), "maxfev": REFINEMENTS * len(candidate.free), "xatol": 5e-3,
                 "fatol": 0.05},
    )  # fmt: skip
    return best[0]


def polished(best: Explained, targets: tuple[Condition, ...], advance: Callable[[], None]) -> Explained:
    """The winner once more from other distances, where it has one: lines of one comb fall on those of others."""
    for values in other_pitches(best, targets):
        again = explained(best.anchor, best.candidate, values, targets)
        if again is not None and again.evidence > best.evidence - REACH:
            found = freed(replace(again, slopes=best.slopes), targets, POLISH_STEPS, lambda: None, STEP)
            if found.evidence > best.evidence:
                best = found
    advance()
    return best


def other_pitches(best: Explained, targets: tuple[Condition, ...]) -> list[Values]:
    """The two best distances of which some lines fall on those of the one found; none for effects without."""
    if best.candidate is None or PITCH not in best.values:
        return []
    coarse = replace(best.anchor, step=COARSE)
    others = [{**best.values, PITCH: ratio * best.values[PITCH]} for ratio in RATIOS]
    jobs = [
        (c, coarse.values, best.candidate.effects(v), seed) for v in others for c in targets for seed in coarse.seeds
    ]
    coarse.bench.prefetch(jobs, COARSE)
    scored = [(one.evidence, i) for i, v in enumerate(others)
              if (one := explained(coarse, best.candidate, v, targets)) is not None]  # fmt: skip
    return [others[i] for _, i in sorted(scored, reverse=True)[:2]]


def freed(
    start: Explained, targets: tuple[Condition, ...], steps: int, advance: Callable[[], None], step: float = COARSE
) -> Explained:
    """Baseline and effect together by Gauss-Newton on calibration and target recordings.

    Slopes over the baseline's parameters cost most: they serve for as long as a step with them gains something. Those
    over the effect's own are simulated for every step. ``step`` [s] is that of the simulations that slopes come from.
    """
    now = start
    for done in range(steps):
        after = _together(now, targets, step)
        if after is None and now.slopes is not None:
            after = _together(replace(now, slopes=None), targets, step)
        advance()
        if after is None:
            for _ in range(done + 1, steps):
                advance()
            break
        gained = after.evidence - now.evidence
        now = after if gained > GAINING else replace(after, slopes=None)
    return now


def _together(now: Explained, targets: tuple[Condition, ...], step: float) -> Explained | None:
    anchor, candidate = now.anchor, now.candidate
    own = np.zeros(0) if candidate is None else candidate.position(now.values)
    steps = np.array([] if candidate is None else [0.1 if f.log else 0.01 * f.span for f in candidate.free])
    size = len(anchor.priors)
    z = np.concatenate([anchor.z, own])
    difference = np.concatenate([np.full(size, 0.7), steps])

    def split(at: np.ndarray):
        effects = {} if candidate is None else candidate.effects(candidate.values(at[size:]))
        return anchor.at(at[:size]), effects

    def jobs(at: np.ndarray):
        values, effects = split(at)
        pairs = [(c, {}) for c in anchor.calibration] + [(c, effects) for c in targets]
        return [(c, values, active, seed) for c, active in pairs for seed in anchor.seeds]

    def residual(at: np.ndarray, dt: float) -> np.ndarray | None:
        values, effects = split(at)
        direct = replace(anchor, calibration=(), step=dt)
        parts = [direct.blocks(anchor.calibration, {}, 0.0, values), direct.blocks(targets, effects, 0.0, values)]
        if any(part is None for part in parts):
            return None
        return np.concatenate([block.residual for part in parts if part is not None for block in part])

    first = 0 if now.slopes is None else size
    ahead = [z + difference * (np.arange(len(z)) == i) for i in range(first, len(z))]
    anchor.bench.prefetch([job for at in [z, *ahead] for job in jobs(at)], step)
    base, rough = residual(z, anchor.step), residual(z, step)
    if base is None or rough is None:
        return None
    columns = [residual(at, step) for at in ahead]
    fresh = [np.zeros_like(base) if c is None else (c - rough) / d
             for c, d in zip(columns, difference[first:], strict=True)]  # fmt: skip
    jacobian = as_columns([*(() if now.slopes is None else now.slopes.T), *fresh], len(base))
    tau = max(now.target.tau_db, 0.8) / NEPER_DB
    known = np.concatenate([np.ones(size), 0.05 / np.maximum(steps, 1e-9) ** 2])
    pull = np.concatenate([anchor.z, np.zeros(len(own))])

    weight = 1.0 / (6.0 * (0.05 + tau**2))
    curvature = weight * jacobian.T @ jacobian + np.diag(known)
    change = np.linalg.solve(curvature, -weight * jacobian.T @ base - pull)
    spread = np.sqrt(np.diag(np.linalg.inv(curvature)))[size:]
    for length in (1.0, 0.5, 0.2):  # the first that helps: which of several helps most is half chance
        at = z + length * change
        anchor.bench.prefetch(jobs(at))
        values, _ = split(at)
        fit = replace(anchor, calibration=()).score(anchor.calibration, {}, values) if anchor.calibration else None
        prior = 0.5 * float(at[:size] @ at[:size])
        if anchor.calibration and fit is None:
            continue
        moved = replace(
            anchor, z=at[:size],
            fit=anchor.fit if fit is None else Score(fit[0].log_likelihood - prior, fit[0].tau_db, fit[0].rms_db),
        )  # fmt: skip
        found = explained(moved, candidate, {} if candidate is None else candidate.values(at[size:]), targets)
        if found is not None and found.evidence > now.evidence:
            return replace(found, spread=spread, slopes=jacobian[:, :size])
    return None
