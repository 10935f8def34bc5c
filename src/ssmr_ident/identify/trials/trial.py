"""One recording as an inverse problem: what was measured, what a model says of it, and what may differ by trial."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ssmr_ident.experiments import Experiment
from ssmr_ident.physics.slots import Effects
from ssmr_ident.signals.noise import AutoregressiveNoise, Blocks, any_mains_lines, nuisance_columns, white_noise

Array = np.ndarray
Values = Mapping[str, float]
Runner = Callable[[Values, Effects, Array], Array]
Asked = tuple[Values, Effects, Array]


@dataclass(frozen=True, eq=False)
class Course:
    """A recording sample by sample, as it is compared and drawn.

    Parameters
    ----------
    times : (m,) float [s]
        The recording's own.
    measured : (m, c) float
    run : callable
        ``run(values, effects, nuisance)``, (m, c).
    units : tuple of str
    low_pass_hz : float or None
        Of the comparison; None as logged.
    """

    times: Array
    measured: Array
    run: Runner
    units: tuple[str, ...]
    low_pass_hz: float | None


@dataclass(frozen=True, eq=False)
class Trial:
    """A recording on the grid on which it is fitted.

    Parameters
    ----------
    name : str
    experiment : Experiment
    kind : str
        Motion of a decay, direction of a pull: recordings of one kind show the same.
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
        Their prior standard deviations about 0.
    course : Course
        All samples, beyond those that are fitted too.
    counts : (n, c) bool
        False for samples that say nothing (a converter at its end).
    facts : mapping of str to float
        Numbers about the recording, and of a rig or robot what its file says of it, where that is not fitted.
    blind : tuple of str
        How names of parameters begin that this recording does not depend on.
    coarse : float
        Factor on the steps of differences: where contacts slide and stick anew, small ones see only that.
    idle : mapping of str to tuple of str
        Nuisances that do nothing unless one of these effects is active.
    even : tuple of str
        Nuisances that a recording may depend on by their square alone: a difference to one side would take its
        rounding for a slope, and a step along it be as wide as the prior allows.
    searched : bool
        ``begin`` finds the nuisances by a search that does not get caught where a descent does.
    shorten : callable or None
        ``shorten(seconds)`` is the same recording up to there, for fits that are led from its beginning to its end.
    delay : callable or None
        ``delay(seconds)`` is the same recording from there on, for fits that are led from its end to its beginning.
    part : (float, float) or None [s]
        Times that count, where a lone recording is split into a part that is fitted and one that is kept back.
    quiet : bool
        The noise was taken from a stretch in which nothing moves.
    jolt : (float, float) or None [s]
        Times in which the apparatus shows more than what it tests: what is left there tells nothing missing.
    many : callable or None
        What ``run`` gives of many at once, (k, n, c), in one call that lets other threads go on.
    slides_from : float or None [s]
        When a robot that is pulled begins to slide as a whole; None where nothing slides, or in teeth.
    lined : bool
        The basis has the mains lines already.
    drift : (n, d) float or None
        How a channel's zero may drift, in its unit: columns of which it has a share of unit standard deviation.
    uneven : Trial or None
        The same recording of a robot that is not alike left and right, where this one takes it to be.
    abreast : bool
        ``many`` of a few costs hardly more than one.
    at_rest : (m, c) float or None
        Logged when the motion was over, on the same grid, zeros taken out: noise alone. Nothing is fitted to it.
    """

    name: str
    experiment: Experiment
    kind: str
    channels: tuple[str, ...]
    times: Array
    target: Array
    noises: tuple[AutoregressiveNoise, ...]
    basis: Array
    run: Runner
    begin: Callable[[Values, Effects], Array]
    nuisances: tuple[str, ...]
    scales: Array
    course: Course
    counts: Array | None = None
    facts: Mapping[str, float] = field(default_factory=dict)
    blind: tuple[str, ...] = ()
    coarse: float = 1.0
    idle: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    even: tuple[str, ...] = ()
    searched: bool = False
    shorten: Callable[[float], Trial] | None = None
    delay: Callable[[float], Trial] | None = None
    part: tuple[float, float] | None = None
    quiet: bool = False
    jolt: tuple[float, float] | None = None
    many: Callable[[Sequence[Asked]], Array] | None = None
    slides_from: float | None = None
    lined: bool = False
    drift: Array | None = None
    uneven: Trial | None = None
    abreast: bool = False
    at_rest: Array | None = None

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

    @cached_property
    def _removed(self) -> tuple[tuple[Array, Array], ...]:
        """What the whitened basis, and drifts of uncertain size, add to white noise, as a product (N, r) (r, N) per
        channel: drifts are made white again by I − U (1 − (1 + S²)^−½) U'."""
        found = []
        for index, projector in enumerate(self._projectors):
            if self.drift is None:
                found.append((projector, projector.T))
                continue
            columns = self._white(self.drift, index)
            u, size, _ = np.linalg.svd(columns - projector @ (projector.T @ columns), full_matrices=False)
            # u has nothing of the basis in it, so both go at once
            along = (1.0 - (1.0 + size**2) ** -0.5)[:, None] * u.T
            found.append((np.hstack([projector, u]), np.vstack([projector.T, along])))
        return tuple(found)

    def _white(self, columns: Array, index: int) -> Array:
        noise = self.noises[index]
        white = noise.whiten(columns)[self.lost - noise.order :]
        if self.counts is not None:
            white = white * self.counts[self.lost :, index].reshape((-1,) + (1,) * (columns.ndim - 1))
        return white

    def whitened(self, signal: Array) -> Array:
        """(n, c) or (n, c, k) to whitened channels one after the other, basis projected out, (N,) or (N, k)."""
        parts = []
        for index, (across, along) in enumerate(self._removed):
            white = self._white(signal[:, index], index)
            parts.append(white - across @ (along @ white))
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

    def runs(self, asked: Sequence[Asked]) -> Array:
        """``run`` for each of (values, effects, nuisance), one behind the other in the last axis; (n, c, k)."""
        if self.many is None:
            return np.stack([self.run(*one) for one in asked], axis=-1)
        return self.many(asked).transpose(1, 2, 0)

    def sees(self, name: str) -> bool:
        """False for a parameter that this recording does not depend on, whatever its value."""
        return not name.startswith(self.blind) if self.blind else True

    def with_noises(self, noises: tuple[AutoregressiveNoise, ...]) -> Trial:
        return replace(self, noises=noises)

    def as_it_is(self) -> Trial:
        """The same of a robot that need not be alike left and right; what was measured and what counts stays."""
        of = self.uneven
        return (
            self
            if of is None
            else replace(self, run=of.run, many=of.many, begin=of.begin, course=of.course, blind=of.blind, uneven=None)
        )

    def until(self, seconds: float) -> Trial:
        """Its first part, with the noise that it has; itself where it cannot be shortened."""
        if self.shorten is None or seconds >= float(self.times[-1] - self.times[0]):
            return self
        short = self.shorten(seconds)
        return replace(short, noises=self.noises, basis=self.basis[: len(short.times)], lined=self.lined)

    def since(self, seconds: float) -> Trial:
        """Its part from there on, with the noise that it has; itself where it cannot be cut."""
        if self.delay is None:
            return self
        late = self.delay(seconds)
        return replace(late, noises=self.noises, basis=self.basis[-len(late.times) :], lined=self.lined)

    def renoised(self, simulated: Array) -> Trial:
        """The same with each channel's noise taken from what a simulation leaves at its fastest: white noise shows in
        second differences, and a slow misfit hardly does."""
        rest = self.colour(simulated)
        found = []
        for noise, column in zip(self.noises, rest.T, strict=True):
            found.append(white_noise(column, noise.least, noise.filter))
        return self.with_noises(tuple(found))

    def blocks(self, simulated: Array) -> Blocks:
        """What a simulation leaves of the force after the jolt of a cable that tightens, as a load cell's noise is told
        from it."""
        after = self.times > (-np.inf if self.jolt is None else self.jolt[1])
        return Blocks(self.colour(simulated)[after if after.mean() >= 0.5 else slice(None), 0], self.step)

    def with_lines(self, residual: Array) -> Trial:
        """The same with the mains lines that stand out of a residual, (n, c), added to the basis."""
        lines = () if self.lined else any_mains_lines(residual, self.step, folds=True)
        if not lines:
            return self
        since = self.times - self.times[0]
        columns = np.hstack([self.basis, nuisance_columns(since, lines)[:, 1:]])
        return replace(self, basis=columns, lined=True)

    def colour(self, simulated: Array) -> Array:
        """Unwhitened residual, (n, c), its share of the basis taken out by least squares."""
        rest = self.target - simulated
        q = np.linalg.qr(self.basis)[0]
        result: Array = rest - q @ (q.T @ rest)
        return result
