"""Which law the contacts of a session's swivels obey, where its parameter file names none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.turning.anchor import Anchor
from ssmr_ident.diagnose.turning.baseline import ROUNDS, anchored
from ssmr_ident.diagnose.turning.bench import Bench
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.wider import REACH
from ssmr_ident.physics.robot import contact_named

LAWS = {"cone": "Coulomb's cone, both axes together", "relay": "a relay on each axis (6.4)"}


def baseline_under_its_law(
    known: ParameterSet,
    fitted_on: tuple[Condition, ...],
    calibrated: bool,
    scale: np.ndarray,
    advance: Callable[[], None],
    seeds: tuple[int, ...],
) -> tuple[Anchor, tuple[str, ...]]:
    """The baseline under the law that the file names, or under that which the recordings prefer, and a note on which.

    Each law begins from its own grid; one that is further behind there than a fit was seen to add is not fitted.
    """
    named = contact_named(known)
    if named:
        return anchored(Bench(known), fitted_on, calibrated, scale, advance, seeds=seeds), ()
    benches = [Bench(replace(known, choices={**known.choices, "tire.contact": law})) for law in LAWS]
    begun = [anchored(b, fitted_on, calibrated, scale, lambda: None, 0, seeds) for b in benches]
    level = max(one.fit.log_likelihood for one in begun) - REACH
    fits = [
        anchored(one.bench, fitted_on, calibrated, scale, lambda: None, ROUNDS, seeds, starts=(one.z,))
        if one.fit.log_likelihood > level else one
        for one in begun
    ]  # fmt: skip
    advance()
    best = max(fits, key=lambda one: one.fit.log_likelihood)
    best.bench.work = sum(bench.work for bench in benches)
    apart = ", ".join(
        f"{words} to {one.fit.rms_db:.1f} dB (log likelihood {one.fit.log_likelihood:.0f})"
        for one, words in zip(fits, LAWS.values(), strict=True)
    )
    chosen = best.bench.parameters.choices["tire.contact"]
    return best, (f"the file names no law of contact; the baseline comes under {apart}: {chosen} is taken",)
