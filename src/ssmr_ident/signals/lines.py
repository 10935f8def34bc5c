"""A peak's frequency between the bins: a line, damped or not, fitted to the bins around it.

Samples of A exp(-a t) cos(2 pi f t + phi) over a whole window have a transform known in closed form, a geometric sum.
It is fitted to the bins around a peak as it is, with the mirror image at -f, so that no window function and no
correction of its bias are needed. What lies further away (other lines, the trend, slow motion) runs smoothly through
these few bins and is a straight line there, beside the transform of a ramp; a line that lies among them is fitted too,
where it pays for its four numbers by Akaike's criterion for few numbers (Hurvich and Tsai, Biometrika 76, 1989).

In white noise this is the maximum of the likelihood of these bins. The error is that of Cramer and Rao, the curvature
there times the noise that the same bins are left with: a quarter above that of a lone line in all samples (Rife and
Boorstyn, IEEE Trans. Inf. Theory 20, 1974; Yoshida and others, IEEE Trans. Instrum. Meas. 30, 1981, for damped lines).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.shown import Shown
from ssmr_ident.signals.peaks import Peaks
from ssmr_ident.signals.spectra import Spectrum

REACH = 6
"""Bins on either side of a peak: a line has 98 % of its power within them."""
FARTHEST = 100
MOST_LINES = 3
ROUNDS = 25
SETTLED = 0.01
"""Of a step, in errors of what it moves."""
ANOTHER = 0.4
"""Share of what is left in three neighbouring bins from which another line is tried; a line has 85 % there."""
CERTAIN = 3.0
WIDE_BINS = 0.5
"""A line whose half-power width is more than this many bins decays within the window: its peak is broad."""


@dataclass(frozen=True, eq=False)
class Lines(Shown):
    """Peaks read between the bins.

    Parameters
    ----------
    frequency : (k,) float [Hz]
        Of the line, damped where it decays; of its bin where the bins around it do not look like a line.
    frequency_std : (k,) float [Hz]
    width, width_std : (k,) float [Hz]
        Between the half-power points, a/pi for a decay exp(-a t), and its error; 0 where it is no line.
    amplitude : (k,) float [unit of the samples]
        Of the peak in the spectrum, on its bin.
    resolution : float [Hz]
        Distance of two bins.
    """

    frequency: np.ndarray
    frequency_std: np.ndarray
    width: np.ndarray
    width_std: np.ndarray
    amplitude: np.ndarray
    resolution: float

    def __len__(self) -> int:
        return len(self.frequency)

    def wide(self, rank: int) -> bool:
        """Whether a peak is broad because its line decays within the window."""
        width, std = float(self.width[rank]), float(self.width_std[rank])
        return width > WIDE_BINS * self.resolution and width > CERTAIN * std

    def __str__(self) -> str:
        if not len(self):
            return "no peak"
        each = zip(self.frequency, self.frequency_std, self.amplitude, strict=True)
        return ", ".join(f"{f:.{places(std)}f} ± {std:.1g} Hz ({a:.3g})" for f, std, a in each)


def places(std: float) -> int:
    """Decimal places at which a frequency with this error is printed: to its error's first digit, two at least.

    >>> places(0.3), places(0.0004), places(0.0)
    (2, 4, 6)
    """
    return 6 if std <= 1e-6 else max(2, -math.floor(math.log10(std)))


def read_lines(samples: np.ndarray, spectrum: Spectrum, peaks: Peaks) -> Lines:
    """Each peak's frequency between the bins, with its error.

    Parameters
    ----------
    samples : (n,) float [any unit]
        Of which the spectrum was taken.
    spectrum : Spectrum
    peaks : Peaks
        Found in it.
    """
    n, bin_hz = spectrum.count, spectrum.resolution
    transform = np.fft.rfft(np.asarray(samples, dtype=float))
    found = [_line(transform, n, round(f / bin_hz)) for f in peaks.frequency]
    frequency, std, width, width_std = np.array(found).reshape(-1, 4).T * bin_hz
    return Lines(frequency, std, width, width_std, peaks.amplitude, bin_hz)


def _line(transform: np.ndarray, n: int, peak: int) -> tuple[float, float, float, float]:
    """Frequency and half-power width of the line at a bin, each with its error behind it [bins]."""
    start = np.array([complex(0.0, _between(transform, peak))])
    found = _among(transform, n, peak, REACH, start)
    # a peak that is broader than the bins looked at says little by its top: wider then, until they hold it
    reach = REACH
    while 2 * reach < FARTHEST and found[2] > reach / 3:
        reach *= 2
        found = _among(transform, n, peak, reach, np.array([complex(-0.5 * found[2], found[0])]))
    return found


def _among(
    transform: np.ndarray, n: int, peak: int, reach: int, poles: np.ndarray
) -> tuple[float, float, float, float]:
    """The same from the bins within reach, begun with these poles."""
    bins = np.arange(max(1, peak - reach), min(len(transform) - 1, peak + reach) + 1)
    values, rows = transform[bins], 2 * len(bins)
    best, best_cost = (float(peak), 1.0 / math.sqrt(12.0), 0.0, 0.0), math.inf
    for count in range(1, MOST_LINES + 1):
        fitted = _fitted(values, bins, n, poles)
        unknowns = 4 * count + 5
        if fitted is None or rows - unknowns < 4:
            break
        poles, left, std = fitted
        power = float(np.sum(np.abs(left) ** 2)) + 1e-26 * float(np.sum(np.abs(values) ** 2))
        cost = rows * math.log(power) + 2.0 * unknowns * rows / (rows - unknowns - 1.0)
        if cost >= best_cost:
            break
        best_cost = cost
        own = int(np.argmin(np.abs(poles.imag - peak)))
        at, error, width = float(poles[own].imag), float(std[own].imag), 2.0 * abs(float(poles[own].real))
        # a maximum is at most a bin from a line that makes it, or somewhere on its top: else it is another's slope
        if abs(at - peak) <= 1.0 + 0.5 * width and error < max(0.5, 0.5 * width):
            best = at, error, width, 2.0 * float(std[own].real)
        three = np.convolve(np.abs(left) ** 2, np.ones(3), "same")
        if np.max(three) < ANOTHER * power:
            break
        poles = np.append(poles, complex(0.0, bins[int(np.argmax(three))]))
    return best


def _between(transform: np.ndarray, peak: int) -> float:
    """Where an undamped line lies between a bin and its higher neighbour, by their heights [bins]."""
    last = len(transform) - 1
    beside = max((k for k in (peak - 1, peak + 1) if 0 < k <= last), key=lambda k: float(abs(transform[k])))
    own, other = float(abs(transform[peak])), float(abs(transform[beside]))
    return peak + (beside - peak) * other / (own + other) if own > 0.0 else float(peak)


def _fitted(
    values: np.ndarray, bins: np.ndarray, n: int, poles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Poles (decay + i·turning, in 2 pi/n a sample), what they leave, and errors of their parts.

    Gauss and Newton, amplitudes and background solved with the steps; None where it does not come to rest.
    """
    scale = float(np.max(np.abs(values)))
    if scale == 0.0:
        return None
    wanted = np.r_[values.real, values.imag] / scale
    background = _background(bins, n)
    before, share = math.inf, 1.0
    for _ in range(ROUNDS):
        basis, slopes = _columns(bins, n, poles)
        linear = np.column_stack([basis, background])
        weights, left, _ = _solved(linear, wanted)
        power = float(left @ left)
        amplitudes = weights[: 2 * len(poles)].reshape(-1, 2)
        moving = np.einsum("mkpc,kc->mkp", slopes, amplitudes).reshape(len(wanted), -1)
        step, _, variance = _solved(np.column_stack([moving, linear]), left)
        moved = step[0 : 2 * len(poles) : 2] + 1j * step[1 : 2 * len(poles) : 2]
        # of Student's distribution: the noise is known from few bins; two more numbers of freedom are left out
        each = np.sqrt(variance[: 2 * len(poles)] * power / max(len(wanted) - len(step) - 2, 1))
        std = each[::2] + 1j * each[1::2]
        if bool(np.all(np.abs(moved) <= np.maximum(SETTLED * std.imag, 1e-9))):
            return poles, (left[: len(bins)] + 1j * left[len(bins) :]) * scale, std
        share = 0.5 * share if power > before else min(1.0, 2.0 * share)
        before = power
        poles = poles + moved * share * min(1.0, 0.5 / float(np.max(np.abs(moved))))
        if float(np.max(np.abs(poles.real))) > 4.0 * len(bins):
            return None
    return None


def _solved(matrix: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Least squares: numbers, what they leave, and the numbers' variances at unit noise."""
    size = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
    left, singular, right = np.linalg.svd(matrix / size, full_matrices=False)
    keep = singular > 1e-10 * singular[0]
    inverse = (right[keep].T / singular[keep]) / size[:, None]
    numbers = inverse @ (left[:, keep].T @ wanted)
    return numbers, wanted - matrix @ numbers, np.sum(inverse**2, axis=1)


def _columns(bins: np.ndarray, n: int, poles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Transforms of each pole's cosine and sine, (2m, 2p), and their slopes in decay and turning, (2m, p, 2, 2)."""
    m, turn = len(bins), 2.0 * math.pi / n
    basis, slopes = np.empty((2 * m, 2 * len(poles))), np.empty((2 * m, len(poles), 2, 2))
    for k, pole in enumerate(poles):
        (own, own_slope), (image, image_slope) = (
            _geometric((s - 1j * bins) * turn, n) for s in (pole, pole.conjugate())
        )
        # of c exp(s t) + conj(c exp(s t)), real and imaginary part of c
        for column, (a, b) in enumerate(((1.0, 1.0), (1j, -1j))):
            basis[:, 2 * k + column] = _stacked(a * own + b * image)
            slopes[:, k, 0, column] = _stacked((a * own_slope + b * image_slope) * turn)
            slopes[:, k, 1, column] = _stacked((1j * a * own_slope - 1j * b * image_slope) * turn)
    return basis / n, slopes / n


def _geometric(q: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Sum of exp(q j) over j = 0 … n - 1, and its slope in q."""
    flat = np.abs(q) * n < 1e-6
    safe = np.where(flat, 1e-6 / n, q)
    top, below = np.expm1(safe * n), np.expm1(safe)
    total = top / below
    slope = (n * (top + 1.0) - total * (below + 1.0)) / below
    return np.where(flat, n + 0j, total), np.where(flat, 0.5 * n * (n - 1.0) + 0j, slope)


def _background(bins: np.ndarray, n: int) -> np.ndarray:
    """A straight line of complex numbers over the bins, and the transform of a ramp; (2m, 5)."""
    run = (bins - bins.mean()) / len(bins)
    ramp = 1.0 / np.expm1(-2j * math.pi * bins / n)
    columns = (np.ones(len(bins)), 1j * np.ones(len(bins)), run, 1j * run, ramp / abs(ramp[0]))
    return np.column_stack([_stacked(column) for column in columns])


def _stacked(column: np.ndarray) -> np.ndarray:
    return np.concatenate([column.real, column.imag])
