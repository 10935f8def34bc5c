"""One recording as an inverse problem: what was measured, what a model says of it, and what may differ by trial."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ssmr_ident.identify.noise import AutoregressiveNoise
from ssmr_ident.physics.slots import Effects

Array = np.ndarray
Values = Mapping[str, float]
Runner = Callable[[Values, Effects, Array], Array]


@dataclass(frozen=True, eq=False)
class Trial:
    """A recording on the grid on which it is fitted.

    Parameters
    ----------
    name, experiment : str
    channels : tuple of str
    times : (n,) float [s]
        The recording's own.
    target : (n, c) float
        Measured, SI.
    noises : tuple of AutoregressiveNoise
        Per channel.
    basis : (n, b) float
        Columns that each channel may have a share of without saying anything of the physics: its zero, mains lines.
    run : callable
        ``run(values, effects, nuisance)`` simulates the channels, (n, c).
    begin : callable
        ``begin(values, effects)`` is a good start of the nuisances, (k,).
    nuisances : tuple of str
        What is fitted per trial beside the physics: state at the release, slack, force zero.
    scales : (k,) float
        Their prior standard deviations about 0 (or about ``begin`` where ``centred``).
    counts : (n, c) bool
        False for samples that say nothing (a converter at its end).
    """

    name: str
    experiment: str
    channels: tuple[str, ...]
    times: Array
    target: Array
    noises: tuple[AutoregressiveNoise, ...]
    basis: Array
    run: Runner
    begin: Callable[[Values, Effects], Array]
    nuisances: tuple[str, ...]
    scales: Array
    counts: Array | None = None
    facts: Mapping[str, float] = field(default_factory=dict)

    @property
    def step(self) -> float:
        return float(self.times[1] - self.times[0])

    @cached_property
    def lost(self) -> int:
        """Samples that the whitening filters' start-up takes."""
        return max(noise.order for noise in self.noises)

    @cached_property
    def _projectors(self) -> tuple[Array, ...]:
        """Orthonormal columns of the whitened basis, per channel."""
        return tuple(np.linalg.qr(self._white(self.basis, index))[0] for index in range(len(self.channels)))

    def _white(self, columns: Array, index: int) -> Array:
        noise = self.noises[index]
        white = noise.whiten(columns)[self.lost - noise.order :]
        if self.counts is not None:
            white = white * self.counts[self.lost :, index].reshape((-1,) + (1,) * (columns.ndim - 1))
        return white

    def whitened(self, signal: Array) -> Array:
        """(n, c) or (n, c, k) to whitened channels one after the other, basis projected out, (N,) or (N, k)."""
        parts = []
        for index, projector in enumerate(self._projectors):
            white = self._white(signal[:, index], index)
            parts.append(white - projector @ (projector.T @ white))
        return np.concatenate(parts)

    @cached_property
    def white_target(self) -> Array:
        return self.whitened(self.target)

    @property
    def size(self) -> int:
        """Numbers that count."""
        if self.counts is None:
            return len(self.channels) * (len(self.times) - self.lost)
        return int(self.counts[self.lost :].sum())

    def by_channel(self, residual: Array) -> Array:
        """(N,) back to (n − lost, c)."""
        return residual.reshape(len(self.channels), -1).T

    def with_noises(self, noises: tuple[AutoregressiveNoise, ...]) -> Trial:
        return replace(self, noises=noises)

    def colour(self, simulated: Array) -> Array:
        """Unwhitened residual, (n, c), its share of the basis taken out by least squares."""
        rest = self.target - simulated
        q = np.linalg.qr(self.basis)[0]
        return rest - q @ (q.T @ rest)
