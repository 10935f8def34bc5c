"""What an answer says besides its verdict: how much is left and of what sort, and what came nearest."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ssmr_ident.diagnose.diagnosis import PredictionQuality
from ssmr_ident.doctor.decide import MISSING, NOTHING, Decision
from ssmr_ident.doctor.left import beyond, wandering
from ssmr_ident.doctor.rules import FORMULA, HALVED, OVER_NOISE
from ssmr_ident.doctor.table import Row
from ssmr_ident.estimate.values import Problem

NOT_QUITE = "its form, or a smaller effect beside it, is not quite the world's"

NO_FILE = "no parameter file holds a force of any shape: after.yaml is before.yaml, and the curve is in diagnosis.yaml"


def notes_on(
    problem: Problem, rows: Sequence[Row], decision: Decision, chosen: Row, heldout: PredictionQuality
) -> tuple[str, ...]:
    """Notes on a rig's answer, those of its search aside."""
    base = next(r for r in rows if not r.ids)
    far = beyond(problem, base.fit) if base.over >= OVER_NOISE and base.fit is not None else None
    return (
        *_nearest(decision, rows, base),
        *_left(problem, decision, chosen, heldout),
        *_colour(decision, base),
        *(() if far is None else (str(far),)),
        *wandering_zeros(problem, chosen),
    )


def wandering_zeros(problem: Problem, chosen: Row) -> tuple[str, ...]:
    """Channels whose zero wanders."""
    if problem.drifts or chosen.over < OVER_NOISE or chosen.fit is None:
        return ()
    return tuple(
        f"most of what is left in {name} lies below {hz:.2g} Hz, slower than anything that moves there: the zero of "
        "its sensor wanders"
        for name, hz in wandering(problem, chosen.fit)
    )


def _nearest(decision: Decision, rows: Sequence[Row], base: Row) -> tuple[str, ...]:
    """What of a force of any shape a file can hold, and the law that comes nearest to what no listed one makes."""
    if decision.verdict != MISSING or decision.listed:
        return ()
    least = min(r.chi2 for r in rows if math.isfinite(r.chi2))
    laws = [r for r in rows if len(r.ids) == 1 and not r.generic and "unlisted" not in r.ids]
    nearest = min(laws, key=lambda r: r.chi2, default=base)
    share = (base.chi2 - nearest.chi2) / max(base.chi2 - least, 1e-300)
    near = (f"the nearest law is {nearest.name}, which takes {100 * share:.0f} % of it",) if share > HALVED else ()
    return (NO_FILE, *near)


def _left(problem: Problem, decision: Decision, chosen: Row, heldout: PredictionQuality) -> tuple[str, ...]:
    if problem.drifts:
        said = (
            "no spring holds the mass, so that whatever pushed it beside the logged force has added up: the noise "
            "floor is that of the sensor alone, and no model comes near it",
        )
        if decision.verdict != MISSING or not decision.listed or decision.left < FORMULA:
            return said
        return (
            *said,
            f"{chosen.name} leaves {100 * decision.left:.0f} % of what a force of any shape takes: {NOT_QUITE}",
        )
    if decision.verdict == MISSING and heldout.after > OVER_NOISE * heldout.noise_floor:
        return (
            f"{chosen.name} still leaves {heldout.after / heldout.noise_floor:.1f} times the noise floor: {NOT_QUITE}",
        )
    return ()


def _colour(decision: Decision, base: Row) -> tuple[str, ...]:
    if decision.verdict != NOTHING or base.over < OVER_NOISE:
        return ()
    return (
        f"what is left is {base.over:.1f} times what is white in it; it does not follow the motion, so it is taken for "
        "noise of another colour",
    )
