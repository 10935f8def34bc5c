"""The baseline on calibration recordings, fitted to the end before anything is asked of the targets.

Slopes between runs of stick-slip end in the first hollow, and there lambda_max is found where it is not: calibration of
a robot with 0.1 was left 5.4 dB off, with 0.6 in its place 3.6 dB, and beside that baseline the effect that acted was
8 dB off with its true size. An ensemble brought the calibration to 0.2 dB, and that effect to 1.1 dB.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ssmr_ident.diagnose.turning.anchor import Anchor
from ssmr_ident.diagnose.turning.baseline import anchored
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.ensemble import ALIKE, ROUNDS, TAU_DB, settled
from ssmr_ident.diagnose.turning.search import explained
from ssmr_ident.diagnose.turning.wider import FAR_DB

STAGES = 2 * ROUNDS  # rounds of ensembles at most
POLISHED = 2  # steps by slopes of the place's own, which say what a fit leaves open


def firm(
    anchor: Anchor, calibration: tuple[Condition, ...], seed: int, final: tuple[int, ...], advance: Callable[[], None]
) -> Anchor:
    """The anchor where ensembles lead it; as it was where slopes left no more than simulations are off anyway.

    Parameters
    ----------
    anchor : Anchor
        As slopes left it.
    calibration : tuple of Condition
        What it is fitted on.
    seed : int
        Of the draws, and of the simulated floors.
    final : tuple of int
        Floors over which places are compared.
    advance : callable
        Called once per round.
    """
    now = explained(replace(anchor, calibration=(), slopes=None), None, {}, calibration)
    if now is None or now.target.tau_db <= TAU_DB[0]:
        return anchor
    begun = now
    now = settled(begun, calibration, seed, final, advance, everywhere=begun.target.tau_db > FAR_DB)
    if now.target.tau_db > FAR_DB and now.evidence > begun.evidence + ALIKE:
        now = settled(now, calibration, seed + 1, final, advance)
    if now is begun:
        return anchor
    return anchored(
        anchor.bench, calibration, bool(anchor.calibration), anchor.scale, lambda: None, POLISHED, anchor.seeds,
        anchor.fixed, (now.anchor.z, anchor.z),
    )  # fmt: skip
