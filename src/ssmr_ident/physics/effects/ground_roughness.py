"""A random floor."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site

CELLS = 512
CELL = 0.004  # m; the floor repeats after about two metres


def field(height: float, length: float, seed: float) -> np.ndarray:
    """A periodic random floor, (CELLS, CELLS) float [m], Gaussian with the given rms and correlation length [m]."""
    return height * _unit_field(length, int(seed))


@lru_cache(maxsize=12)
def _unit_field(length: float, seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    wave = 2.0 * np.pi * np.fft.fftfreq(CELLS, CELL)
    square = wave[:, None] ** 2 + wave[None, : CELLS // 2 + 1] ** 2
    shape = np.exp(-square * length**2 / 8.0)  # gives the correlation exp(-(r/length)²)
    shape[0, 0] = 0.0
    floor = np.fft.irfft2(np.fft.rfft2(random.standard_normal((CELLS, CELLS))) * shape, s=(CELLS, CELLS))
    return floor / floor.std()


@kernel
def height(floor, x, y):
    """Height and slopes of the floor at (x, y): (float [m], float, float), bilinear between cells."""
    last = floor.shape[0] - 1  # of a power of two: a mask costs less than a remainder
    u, v = x / CELL, y / CELL
    i, j = int(np.floor(u)), int(np.floor(v))
    a, b = u - i, v - j
    i0, j0, i1, j1 = i & last, j & last, (i + 1) & last, (j + 1) & last
    h00, h10, h01, h11 = floor[i0, j0], floor[i1, j0], floor[i0, j1], floor[i1, j1]
    level = (1 - a) * ((1 - b) * h00 + b * h01) + a * ((1 - b) * h10 + b * h11)
    along_x = ((1 - b) * (h10 - h00) + b * (h11 - h01)) / CELL
    along_y = ((1 - a) * (h01 - h00) + a * (h11 - h10)) / CELL
    return level, along_x, along_y


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
