"""Loops of other exponents and shapes against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from ssmr_ident.physics.effects import hysteresis


@pytest.mark.parametrize("shape", [-0.7, 0.0, 0.3])
def test_a_loop_of_exponent_one_follows_the_exponentials_of_its_shape(shape: float) -> None:
    """z = y/c (1 - e^(-c s/y)) on the way out, c = γ + ½; on the way back dz/ds = 1 - (γ - ½) z/y."""
    width, reach, parts = 3e-4, 5e-4, 400
    z, way = 0.0, []
    for direction in (1.0, -1.0):
        for _ in range(parts):
            z = hysteresis.advance(z, direction * reach, 1.0 / parts, width, 1.0, shape)
            way.append(z)
    c, back = shape + 0.5, shape - 0.5
    s = reach * np.arange(1, parts + 1) / parts
    out = width / c * (1.0 - np.exp(-c * s / width))
    assert way[:parts] == pytest.approx(out, rel=1e-9)
    returned = width / back * (1.0 + (back / width * out[-1] - 1.0) * np.exp(back * s / width))
    pressed = returned > 0.0
    assert np.array(way[parts:])[pressed] == pytest.approx(returned[pressed], abs=1e-9 * width)


def test_the_exact_loop_and_the_general_one_meet_at_their_border() -> None:
    random = np.random.default_rng(5)
    z, other, width = 0.0, 0.0, 2e-4
    for v in 1e-3 * random.standard_normal(2000).cumsum():
        z = hysteresis.advance(z, v, 1e-3, width, 2.0, 0.5)
        other = hysteresis.advance(other, v, 1e-3, width, 2.0, 0.5 + 1e-12)
        assert other == pytest.approx(z, abs=2e-3 * width)
