"""Force over deflection of one wheel: contact, loaded part, law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.forces.sawtooth import machine_moves
from ssmr_ident.identify.forces.stiffness import StiffnessChoice, compare_laws
from ssmr_ident.signals.noise import force_noise

Array = np.ndarray


@dataclass(frozen=True)
class LoadCurve:
    """One press or one rise.

    Parameters
    ----------
    stiffness, stiffness_std : float [N/m]
        Of the straight line; the standard deviation counts how far the halves' slopes differ.
    choice : StiffnessChoice
        Straight, two slopes, or cubic.
    force_from, force_to : float [N]
        Range of the loaded part.
    zero : float [N]
        Force before contact, ``nan`` where the log begins in contact.
    """

    stiffness: float
    stiffness_std: float
    choice: StiffnessChoice
    force_from: float
    force_to: float
    zero: float


def load_curve(position: Array, force: Array) -> LoadCurve:
    """Stiffness and law of a press (vertical compression, or a wheel dragged until it lets go).

    Parameters
    ----------
    position : (n,) float [m]
    force : (n,) float [N]
        Rising with position.

    Raises
    ------
    ValueError
        When the force never leaves the noise.
    """
    moving = machine_moves(position)
    position, force = np.asarray(position)[moving], np.asarray(force)[moving]
    if len(force) < 30:
        raise ValueError("the machine hardly moves")
    noise = force_noise(force)
    width = max(1, len(force) // 300)
    smooth = np.convolve(force, np.ones(width) / width, mode="same")
    inner = slice(width, len(force) - width)
    highest = int(np.argmax(smooth[inner])) + width
    start_level = float(np.median(force[: max(5, len(force) // 100)]))
    span = smooth[highest] - start_level
    if span < 10 * noise:
        raise ValueError("the force never leaves the noise")
    # Where the wheel slides at last the force stays at its top, and that is no spring any more.
    top = int(np.argmax(smooth[: highest + 1] >= start_level + 0.97 * span))
    # From a twentieth of the range on: the first touch of a tire is no spring yet.
    begin = int(np.flatnonzero(smooth[: top + 1] < start_level + 0.05 * span)[-1]) + 1
    x, y = position[begin : top - width], force[begin : top - width]
    if len(x) < 20:
        raise ValueError("the loaded part has fewer than 20 samples")
    choice = compare_laws(x, y)
    line = next(law for law in choice.laws if law.name == "linear")
    half = len(x) // 2
    slopes = [float(np.polyfit(x[part], y[part], 1)[0]) for part in (slice(0, half), slice(half, None))]
    # Two halves of a curve that bends evenly differ by half of its whole range of slopes; the std of a uniform
    # distribution over that range is range/√12.
    bend = 2 * abs(slopes[1] - slopes[0]) / np.sqrt(12.0)
    bent = choice.best.name != "linear" and choice.decisive
    std = float(np.hypot(line.stds["stiffness"], bend if bent else 0.0))
    before = force[: begin // 2]
    zero = float(np.mean(before)) if len(before) > 10 and float(np.ptp(before)) < 12 * noise else np.nan
    return LoadCurve(line.values["stiffness"], std, choice, float(y[0]), float(y[-1]), zero)
