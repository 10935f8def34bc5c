"""Speed × frequency maps: recorded beside simulated, with the rates that a line could follow."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.diagnose.evidence import SpeedMap
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.likelihood import NEPER_DB
from ssmr_ident.doctor.swivels.outcome import Outcome
from ssmr_ident.doctor.swivels.spectral_distance import channel_logs
from ssmr_ident.doctor.swivels.starts import lever
from ssmr_ident.physics.slots import Effects

NARROW = 0.2  # of the logarithm of speed, over which a course can be told
UNSTEADY = 0.12  # of the logarithm of frequency about a power of speed: more is no one line


def speed_maps(
    outcome: Outcome, before: Mapping[str, float], after: Mapping[str, float], effects: Effects
) -> tuple[SpeedMap, ...]:
    """One map per channel over the speeds of all target and heldout conditions."""
    kinds = {c.kind: c for c in (*outcome.heldout, *outcome.targets)}  # a target before the end kept back of it
    conditions = sorted(kinds.values(), key=lambda c: abs(c.turning))
    names = conditions[0].names
    conditions = [
        c for c in conditions if c.names == names and len(c.mean.frequency) == len(conditions[0].mean.frequency)
    ]
    rows: list[list[np.ndarray]] = []
    path, fixed = [], []
    kept: list[Condition] = []
    for c in conditions:
        plain = outcome.bench.run(c, before, {}, (1,))
        added = outcome.bench.run(c, after, effects, (1,))
        if plain is None or added is None:
            continue
        recorded = channel_logs(c.mean)
        rows.append([recorded, channel_logs(plain.look, c.noise), channel_logs(added.look, c.noise)])
        path.append(abs(added.yaw_rate) * lever(outcome.anchor))
        strongest = c.mean.frequency[int(np.argmax(channel_logs(plain.look).sum(axis=1)))]
        fixed.append(float(strongest))
        kept.append(c)
    if not kept:
        return ()
    speed = np.array([abs(c.turning) for c in kept])
    wheel = np.array([float(np.abs(c.rates).mean()) / (2.0 * np.pi) for c in kept])
    lines = [("wheel rate", wheel), ("stick-slip of the baseline", np.array(fixed))]
    pitch = effects.get("ground_joints", {}).get("pitch_m")
    if pitch:
        lines.append((f"path speed over {1e3 * pitch:.3g} mm", np.array(path) / pitch))
    mast = effects.get("flexible_mast", {}).get("f_mast_Hz")
    if mast:
        lines.append(("mast on a held platform", np.full(len(kept), mast)))
    stacked = NEPER_DB * np.array(rows)  # (s, 3, k, c)
    return tuple(
        SpeedMap(
            name,
            speed,
            kept[0].mean.frequency,
            recorded=stacked[:, 0, :, j],
            before=stacked[:, 1, :, j],
            after=stacked[:, 2, :, j],
            lines=tuple(lines),
            names=tuple("held out" if c.role == "heldout" else c.role for c in kept),
        )
        for j, name in enumerate(names)
    )


def follows(speed: np.ndarray, line: np.ndarray) -> str:
    """How a line moves with speed: the exponent n of f ~ speed^n says whose it is.

    >>> follows(np.array([0.4, 0.6, 0.8]), np.array([5.0, 7.5, 10.0]))
    'in proportion to speed (exponent 1.00): the floor or the wheels'
    """
    if np.ptp(np.log(speed)) < NARROW:
        return "at too much the same speed to say whose it is"
    exponent, level = np.polyfit(np.log(speed), np.log(line), 1)
    if np.std(np.log(line) - exponent * np.log(speed) - level) > UNSTEADY:
        return "with no steady course over speed"
    if abs(exponent) < 0.25:
        return f"fixed (exponent {exponent:.2f}): the structure, or the stick-slip of the tires"
    if 0.75 < exponent < 1.25:
        return f"in proportion to speed (exponent {exponent:.2f}): the floor or the wheels"
    if exponent < 0.0:
        return f"falling with speed (exponent {exponent:.2f}): friction"
    return f"rising slower than speed (exponent {exponent:.2f})"
