"""What only several recordings at different speeds tell: friction over slip speed, and springs that feel the rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.forces.speed_knee import speed_knee


@dataclass(frozen=True)
class AtSpeed:
    """A result and the speed that it holds at.

    Parameters
    ----------
    name : str
        Of the recording.
    speed : float [m/s]
    value, std : float
    """

    name: str
    speed: float
    value: float
    std: float


def slip_findings(levels: Sequence[AtSpeed], floor: str = "") -> list[str]:
    """Friction coefficient over slip speed: its fall, and the knee from which it is flat (section 3.3).

    Parameters
    ----------
    levels : sequence of AtSpeed
        Coefficient of each pull whose wheels spun.
    floor : str
        That all of them were made on.
    """
    if not levels:
        return []
    on = f" on {floor}" if floor else ""
    speeds = np.array([level.speed for level in levels])
    values = np.array([level.value for level in levels])
    if len(np.unique(speeds)) < 5:
        order = np.argsort(speeds)
        listed = ", ".join(f"{values[k]:.3f} at {speeds[k]:.3g} m/s" for k in order)
        return [f"friction over slip speed{on}: {listed}; five speeds or more would tell the knee"]
    knee = speed_knee(speeds, values)
    return [
        f"friction{on} falls with slip speed from {knee.at_rest:.3f} ± {knee.at_rest_std:.2g} to a flat "
        f"{knee.flat:.3f} ± {knee.flat_std:.2g} beyond {knee.knee:.3g} ± {knee.knee_std:.2g} m/s"
    ]


def rate_findings(springs: Sequence[AtSpeed], what: str) -> list[str]:
    """Does a spring get stiffer with speed? Then it is no spring alone: rubber relaxes.

    Parameters
    ----------
    springs : sequence of AtSpeed
        Stiffness [N/m] at each speed, with the standard deviation of its slope alone.
    what : str
        ``pressed down`` or ``dragged sideways``.
    """
    known = [spring for spring in springs if np.isfinite(spring.speed)]
    if len({spring.speed for spring in known}) < 2:
        return []
    slow, fast = min(known, key=lambda s: s.speed), max(known, key=lambda s: s.speed)
    sigmas = (fast.value - slow.value) / float(np.hypot(fast.std, slow.std))
    # Two slopes at two places of one tire may differ by a percent or two without any rate in it.
    if abs(sigmas) < 3 or abs(fast.value / slow.value - 1) < 0.02:
        return []
    kind = "a relaxing (viscoelastic) tire" if sigmas > 0 else "drift of the load cell, or a creeping hold,"
    return [
        f"{what}, {slow.value / 1e3:.4g} N/mm at {1e3 * slow.speed:g} mm/s but {fast.value / 1e3:.4g} N/mm at "
        f"{1e3 * fast.speed:g} mm/s ({sigmas:+.1f} sigma): {kind} does that, a spring does not"
    ]
