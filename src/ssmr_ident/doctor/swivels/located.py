"""Where targets differ from what the baseline makes of calibration: channel, band, speed, as sentences."""

from __future__ import annotations

import numpy as np
from scipy.stats import norm

from ssmr_ident.diagnose.diagnosis import Located
from ssmr_ident.doctor.swivels.likelihood import NEPER_DB
from ssmr_ident.doctor.swivels.outcome import Outcome

ALARM = 0.01  # probability that chance alone marks any bin of a session
LEAST_DB = 2.0


def located(outcome: Outcome, most: int = 8) -> tuple[Located, ...]:
    """Bands of neighbouring bins that chance does not reach, by their share of the squared misfit."""
    found, total = [], 0.0
    anchor = outcome.anchor
    for c in outcome.targets:
        blocks = anchor.blocks((c,), {}, 1.0)
        if blocks is None:
            continue
        n = len(c.names)
        residual = blocks[0].residual.reshape(len(c.mean.frequency), -1)[:, :n]
        total += float(np.sum(residual**2))
        sure = np.sqrt(blocks[0].variance) * _quantile(residual.size * len(outcome.targets))
        limit = max(sure, LEAST_DB / NEPER_DB)
        for j, name in enumerate(c.names):
            for first, last in _bands(np.abs(residual[:, j]) > limit):
                part = residual[first : last + 1, j]
                low, high = float(c.mean.frequency[first]) - 0.5, float(c.mean.frequency[last]) + 0.5
                mean_db = float(part.mean()) * NEPER_DB
                fitted = "the file's robot" if outcome.unread else "the fitted baseline"
                reference = "the calibration" if outcome.calibrated else fitted
                chance = float(np.sqrt(blocks[0].variance)) * NEPER_DB
                speed = f"{np.degrees(abs(c.turning)):.3g} deg/s"
                sentence = (
                    f"at {speed} {name} holds {abs(mean_db):.1f} dB {'more' if mean_db > 0 else 'less'} power "
                    f"between {low:g} and {high:g} Hz than {reference} "
                    f"(chance: {chance:.1f} dB)"
                )
                found.append(
                    Located(
                        c.recordings[0], name, (0.0, c.duration), (low, high), f"turning at {speed}",
                        float(np.sum(part**2)), sentence,
                    )
                )  # fmt: skip
    found.sort(key=lambda place: place.share, reverse=True)
    scaled = [
        Located(p.recording, p.channel, p.time_s, p.band_hz, p.region, p.share / total, p.sentence) for p in found
    ]
    return tuple(scaled[:most])


def _quantile(looks: int) -> float:
    return float(norm.isf(0.5 * ALARM / max(looks, 1)))


def _bands(above: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], above.astype(int), [0]])))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
