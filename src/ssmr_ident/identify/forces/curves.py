"""Force over deflection of one wheel or one cable: contact, loaded part, law, rate of the first rise."""

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


@dataclass(frozen=True)
class BlockPull:
    """A block pulled over a surface at constant speed.

    Parameters
    ----------
    force_rate, force_rate_std : float [N/s]
        Of the first rise, between 20 and 80 % of it.
    level_begin : float [N]
        Force where sliding begins: median over the first 2 % of the stroke after the rise.
    level, level_std, wander : float [N]
        Mean over all sliding, its uncertainty, and the slow change along the stroke.
    zero : float [N]
        Force before the pull.
    zero_known : bool
        False where the log does not begin with a slack cable at zero: the level then cannot be trusted.
    slides_from : int
        First sample of sliding.
    """

    force_rate: float
    force_rate_std: float
    level_begin: float
    level: float
    level_std: float
    wander: float
    zero: float
    zero_known: bool
    slides_from: int


def block_pull(time: Array, force: Array) -> BlockPull:
    """First rise and sliding level of a block's pull.

    Parameters
    ----------
    time : (n,) float [s]
    force : (n,) float [N]

    Notes
    -----
    The force before the pull is taken as zero only within five standard deviations of its noise: a load cell
    whose zero differs from run to run, or a cable that was not slack, leaves the level unknown by as much.
    """
    noise = force_noise(force)
    head = force[: max(8, len(force) // 1000)]
    zero = float(np.median(head))
    settled = float(np.median(force[len(force) // 100 : max(len(force) // 20, len(force) // 100 + 10)]))
    rise = settled - zero
    if abs(rise) < 10 * noise:
        return BlockPull(np.nan, np.nan, np.nan, *_level(force), zero, abs(zero) < 5 * noise, 0)
    high = int(np.argmax(force - zero > 0.8 * rise))
    low = int(np.flatnonzero(force[: high + 1] - zero < 0.2 * rise)[-1]) if high else 0
    x, y = time[low : high + 1], force[low : high + 1]
    if len(x) > 3:
        centred = x - x.mean()
        rate = float(centred @ y / (centred @ centred))
        residual = y - y.mean() - rate * centred
        std = float(np.sqrt(residual @ residual / (len(x) - 2) / (centred @ centred)))
    else:
        rate, std = float((y[-1] - y[0]) / max(x[-1] - x[0], 1e-12)), np.nan
    # Sliding from the moment at which the rise would have met the level, and half as long again.
    slides = min(int(high + 0.75 * (high - low) + 1), len(force) - 10)
    begin = force[slides : slides + max(10, len(force) // 50)]
    level, level_std, wander = _level(force[slides:])
    return BlockPull(rate, std, float(np.median(begin)), level, level_std, wander, zero, abs(zero) < 5 * noise, slides)


def _level(force: Array) -> tuple[float, float, float]:
    """Mean, its standard deviation by 10 batches that go together, and the wander of those batches."""
    batches = np.array([float(np.mean(part)) for part in np.array_split(force, 10)])
    spread = float(np.std(batches, ddof=1))
    # A trend along the stroke does not average out: the mean is known no better than one batch.
    return float(np.mean(force)), spread, float(np.ptp(batches))
