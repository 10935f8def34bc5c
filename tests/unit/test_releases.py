"""Releases and hits in a log of a free response: found to a few samples, and none where there is none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import fftconvolve

from ssmr_ident.signals.releases import find_releases

RATE = 500.0


def _rings(starts: tuple[float, ...], sizes: tuple[float, ...], seconds: float, hertz: float, xi: float, lead: float):
    """Decays that begin at ``starts`` with the phase ``lead``; a cosine (0) is let go, a sine (π/2) is struck."""
    time = np.arange(round(seconds * RATE)) / RATE
    omega = 2 * math.pi * hertz
    samples = np.zeros_like(time)
    for start, size in zip(starts, sizes, strict=True):
        since = np.maximum(time - start, 0.0)
        samples += (time >= start) * size * np.exp(-xi * omega * since) * np.cos(omega * since - lead)
    return time, samples


@pytest.mark.parametrize("hertz", [3.0, 11.0, 40.0])
@pytest.mark.parametrize("noise", [0.003, 0.05])
@pytest.mark.parametrize("lead", [0.0, math.pi / 2])
def test_quiet_before_the_release(hertz: float, noise: float, lead: float) -> None:
    start = 1.234
    time, ring = _rings((start,), (1.0,), 6.0, hertz, 0.02, lead)
    (found,) = find_releases(time, ring + noise * np.random.default_rng(1).normal(size=len(time)))
    # a blow begins with no motion: where it leaves the noise, not where it fell, is what a log can show
    unsure = 0.0 if lead == 0.0 else math.asin(min(1.0, 8 * noise)) / (2 * math.pi * hertz)
    assert abs(found.at_s - start) <= unsure + 3 / RATE
    assert found.settled_s >= found.at_s


def test_held_aside_and_let_go_in_position() -> None:
    """A position leaves its place along a parabola: the release lies before what stands out of the noise."""
    start, omega = 0.9, 2 * math.pi * 1.3
    time = np.arange(4000) / RATE
    since = np.maximum(time - start, 0.0)
    swing = 0.6 * np.exp(-0.02 * omega * since) * np.cos(omega * since)
    (found,) = find_releases(time, swing + 0.003 * np.random.default_rng(2).normal(size=len(time)))
    assert found.at_s == pytest.approx(start, abs=0.02)


def test_every_hit_of_several_while_it_still_rings() -> None:
    time, ring = _rings((0.7, 2.2, 4.1), (20.0, 25.0, 18.0), 7.0, 24.0, 0.01, math.pi / 2)
    found = find_releases(time, ring + 0.1 * np.random.default_rng(3).normal(size=len(time)))
    assert [one.at_s for one in found] == pytest.approx([0.7, 2.2, 4.1], abs=0.01)


def test_a_hammer_that_touches_for_a_while_is_waited_for() -> None:
    """A pulse of 12 ms on a mass of 1 kg, by its exact response: free from its end on."""
    time = np.arange(3000) / RATE
    omega, xi, start, width = 2 * math.pi * 9.0, 0.02, 1.0, 0.012
    fine = np.arange(round(6.0 * 20000)) / 20000
    force = np.where((fine >= start) & (fine < start + width), np.sin(math.pi * (fine - start) / width), 0.0)
    damped = omega * math.sqrt(1 - xi**2)
    kernel = np.exp(-xi * omega * fine) * np.sin(damped * fine) / damped
    position = fftconvolve(force, kernel)[: len(fine)] / 20000
    acceleration = np.gradient(np.gradient(position, fine), fine)
    log = np.interp(time, fine, acceleration) + 2e-4 * np.random.default_rng(4).normal(size=len(time))
    (found,) = find_releases(time, log)
    assert found.at_s == pytest.approx(start, abs=0.004)
    assert start + width - 0.004 <= found.settled_s <= start + width + 0.02


@pytest.mark.parametrize("kind", ["decay", "beat", "noise", "line", "still"])
def test_where_nothing_is_let_go_nothing_is_found(kind: str) -> None:
    rng = np.random.default_rng(5)
    time = np.arange(3000) / RATE
    made = {
        "decay": np.exp(-time) * np.cos(50 * time),
        "beat": np.exp(-0.2 * time) * (np.cos(50 * time) - np.cos(53 * time)),
        "noise": rng.normal(size=len(time)),
        "line": 0.1 * np.cos(2 * np.pi * 60 * time),
        "still": np.zeros(len(time)),
    }[kind]
    assert find_releases(time, made + 0.01 * rng.normal(size=len(time))) == ()
