"""Where a search begins: joint distances and clipping levels that the recordings themselves speak for."""

from __future__ import annotations

import numpy as np

from ssmr_ident.doctor.swivels.anchor import Anchor
from ssmr_ident.doctor.swivels.candidates import pitches_heard
from ssmr_ident.doctor.swivels.conditions import Condition


def pitches(anchor: Anchor, targets: tuple[Condition, ...]) -> tuple[float, ...]:
    """Joint distances to try: what the excess over the baseline speaks for."""
    excess, speeds = [], []
    for c in targets:
        blocks = anchor.blocks((c,), {}, anchor.shares[0])
        run = anchor.bench.run(c, anchor.values, {}, anchor.seeds)
        if blocks is None or run is None:
            continue
        channels = blocks[0].residual.reshape(len(c.mean.frequency), -1)[:, : len(c.names)]
        excess.append(channels.mean(axis=1))
        speeds.append(abs(run.yaw_rate) * lever(anchor) if c.experiment.turns else _forward(c, anchor))
    frequency = min((c.mean.frequency for c in targets), key=len)
    return pitches_heard(frequency, [course[: len(frequency)] for course in excess], speeds)


def lever(anchor: Anchor) -> float:
    """Mean distance of the contacts from the centre of mass [m]."""
    points = np.asarray(anchor.bench.parameters["contact_points_m"].value, dtype=float)
    return float(np.hypot(points[:, 0], points[:, 1]).mean())


def _forward(c: Condition, anchor: Anchor) -> float:
    return float(np.abs(c.rates).mean()) * anchor.bench.parameters.number("tire.radius_m")


def ceilings(targets: tuple[Condition, ...]) -> tuple[float, ...]:
    """Levels at which a sensor may have clipped: near the largest readings of each channel."""
    levels = []
    for c in targets:
        n = len(c.names)
        top = np.maximum(
            c.mean.levels[:n] + np.exp(c.mean.levels[n : 2 * n]), np.exp(c.mean.levels[2 * n :]) - c.mean.levels[:n]
        )
        levels.append(np.abs(top))
    highest = np.max(levels, axis=0)
    return tuple(sorted({float(h * f) for h in highest for f in (0.93, 0.98, 1.03)}))
