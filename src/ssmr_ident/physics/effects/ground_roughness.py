"""A random floor."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.simd import floor, gathered
from ssmr_ident.physics.effect import Effect, Site

CELLS = 512
CELL = 0.004  # m; the floor repeats after about two metres


@lru_cache(maxsize=12)
def field(length: float, seed: int) -> np.ndarray:
    """A periodic random floor, Gaussian with an rms of 1 and the given correlation length [m]: (CELLS²,) float, row by
    row."""
    random = np.random.default_rng(seed)
    wave = 2.0 * np.pi * np.fft.fftfreq(CELLS, CELL)
    square = wave[:, None] ** 2 + wave[None, : CELLS // 2 + 1] ** 2
    shape = np.exp(-square * length**2 / 8.0)  # gives the correlation exp(-(r/length)²)
    shape[0, 0] = 0.0
    rough = np.fft.irfft2(np.fft.rfft2(random.standard_normal((CELLS, CELLS))) * shape, s=(CELLS, CELLS))
    return (rough / rough.std()).ravel()


@kernel
def height(fields, begin, x, y):
    """Height and slopes of the floor at (x, y), in units of its rms: (float, float, float), bilinear between cells.

    Parameters
    ----------
    fields : (k CELLS²,) float
        Row by row, one field behind the other.
    begin : float
        Place where the one in question begins.
    x, y : float [m]
    """
    u, v = x / CELL, y / CELL
    i, j = floor(u), floor(v)
    a, b = u - i, v - j
    i0, j0, i1, j1 = _within(i), _within(j), _within(i + 1.0), _within(j + 1.0)
    row0, row1 = begin + CELLS * i0, begin + CELLS * i1
    h00, h10 = gathered(fields, row0 + j0), gathered(fields, row1 + j0)
    h01, h11 = gathered(fields, row0 + j1), gathered(fields, row1 + j1)
    level = (1 - a) * ((1 - b) * h00 + b * h01) + a * ((1 - b) * h10 + b * h11)
    along_x = ((1 - b) * (h10 - h00) + b * (h11 - h01)) / CELL
    along_y = ((1 - a) * (h01 - h00) + a * (h11 - h10)) / CELL
    return level, along_x, along_y


@kernel
def _within(i):
    """A whole number in the field's period."""
    return i - CELLS * floor(i * (1.0 / CELLS))


EFFECT = Effect(
    id="ground_roughness",
    sentence="The floor is uneven at random.",
    equation=r"\langle h(\mathbf{r})\,h(\mathbf{r}+\mathbf{d})\rangle = h_{rms}^2\,e^{-(d/\ell)^2}",
    source="ISO 8608 in spirit; Gaussian field by Fourier synthesis",
    signature="broad bands that move up with speed",
    parameters=(
        Parameter("height_m", "m", 1e-4, 0.0, 0.02, "rms", off=0.0),
        Parameter("length_m", "m", 0.03, 0.006, 0.5, "correlation length"),
        Parameter("seed", "1", 1.0, 0.0, 1e9, "which floor"),
    ),
    experiments=("swivel", "straight"),
    acts={Site.GROUND: height},
)
