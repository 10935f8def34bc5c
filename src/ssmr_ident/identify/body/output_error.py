"""Output error of free responses: the samples themselves against the model, nuisances eliminated per recording.

Each recording has its own starting state (12 numbers), offsets and mains lines. They enter linearly, so variable
projection removes them recording by recording (the Schur complement of the joint normal equations): what is left is
a small system in the physical parameters, and cost grows linearly with the number of recordings.
Source: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973), with Kaufman's step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.identify.body.free_decays import BodyDecay
from ssmr_ident.identify.body.response import BodyResponse, body_response, sensor_gains
from ssmr_ident.identify.decays.poles import solve_symmetric
from ssmr_ident.physics.robot import Robot
from ssmr_ident.signals.noise import long_run_variance, whiteness

Array = np.ndarray

START_SCALES = np.array([0.02, 0.02, 0.02, 0.1, 0.1, 0.1, 1.0, 1.0, 1.0, 4.0, 4.0, 4.0])
"""Standard deviations of the starting state (m, rad, m/s, rad/s), ten times what a push by hand gives: they only keep
the algebra regular where a recording does not show a motion at all."""

BLIND = ("tire.mu_", "cable.", "share at ", "share of ", "rope_")
"""How names of parameters begin that a body on sticking tires does not feel."""

LARGEST_GROWTH = 20.0
"""Exponent over the longest record beyond which a body counts as unstable, and fits nothing."""


@dataclass(frozen=True, eq=False)
class System:
    """Normal equations in the parameters, everything else eliminated.

    Parameters
    ----------
    cost : float
        Sum of squared whitened residuals.
    gradient : (p,) float
        Of half the cost, per unit of each parameter.
    information : (p, p) float
    meat : (p, p) float
        Variance of the gradient for residuals correlated in time.
    residuals : tuple of (n, c) float
        Whitened, per recording.
    starts : tuple of (12,) float
        Starting states.
    """

    cost: float
    gradient: Array
    information: Array
    meat: Array
    residuals: tuple[Array, ...]
    starts: tuple[Array, ...]

    @property
    def whiteness_p(self) -> float:
        """Least p-value over recordings and channels that the residual is white, times their number."""
        p_values = [whiteness(part[:, c]) for part in self.residuals for c in range(part.shape[1])]
        return min(1.0, min(p_values) * len(p_values))

    @property
    def misfit(self) -> float:
        """Largest ratio over recordings of the residual's variance in its first quarter to that in its second half."""
        ratios = []
        for part in self.residuals:
            early, late = part[: len(part) // 4], part[len(part) // 2 :]
            ratios.append(float(np.mean(early**2) / max(np.mean(late**2), 1e-300)))
        return max(ratios)


class DecaySamples:
    """Samples of free responses as evidence on a robot's parameters.

    Parameters
    ----------
    decays : sequence of BodyDecay
    builder : callable
        From parameter values to a Robot.
    defects : sequence of (n, c) float [m/s^2], optional
        Per decay, block averages of what the full simulator shows beyond small motions.
    """

    def __init__(
        self,
        decays: Sequence[BodyDecay],
        builder: Callable[[Mapping[str, float]], Robot],
        defects: Sequence[Array] | None = None,
    ) -> None:
        self.decays, self.builder = tuple(decays), builder
        self.bandwidth_hz = builder({}).accelerometer.bandwidth_hz
        keys = [(round(float(d.times[0]), 9), round(d.step, 9)) for d in self.decays]
        self.longest_s = max(float(d.times[-1]) for d in self.decays)
        longest = {key: max(len(d.times) for d, k in zip(self.decays, keys, strict=True) if k == key) for key in keys}
        self.grids = [(key, longest[key]) for key in keys]
        self.bases = [decay.nuisances() for decay in decays]
        self.targets = []
        for index, (decay, basis) in enumerate(zip(self.decays, self.bases, strict=True)):
            samples = decay.samples if defects is None else decay.samples - defects[index]
            white = decay.whitened(samples)
            self.targets.append(white - basis @ (basis.T @ white))

    def cost(self, values: Mapping[str, float]) -> float:
        """Sum of squared whitened residuals with the best nuisances."""
        return self.system(values, {}).cost

    def system(self, values: Mapping[str, float], moves: Mapping[str, float], correlated: bool = False) -> System:
        """Cost and its derivatives.

        Parameters
        ----------
        values : mapping of str to float
        moves : mapping of str to float
            Parameters to differentiate by, with the step of the central difference.
        correlated : bool
            Work ``meat`` out; otherwise it equals the information.
        """
        centre = _Evaluated(body_response(self.builder(values)), self)
        size = len(moves)
        if np.max(centre.response.poles.real) * self.longest_s > LARGEST_GROWTH:
            return System(np.inf, np.zeros(size), np.eye(size), np.eye(size), (), ())
        told = [k for k, name in enumerate(moves) if not name.startswith(BLIND)]
        pairs = []
        for name, move in moves.items():
            if name.startswith(BLIND):
                continue
            ahead = _Evaluated(body_response(self.builder({**values, name: values[name] + move})), self)
            behind = _Evaluated(body_response(self.builder({**values, name: values[name] - move})), self)
            pairs.append((ahead, behind, 2 * move))
        some = len(pairs)
        cost, gradient = 0.0, np.zeros(some)
        information, meat = np.zeros((some, some)), np.zeros((some, some))
        residuals, starts = [], []
        for index, decay in enumerate(self.decays):
            basis, target = self.bases[index], self.targets[index]
            design = np.concatenate([block * START_SCALES for block in centre.columns(index)])
            gram = design.T @ design + np.eye(12)
            flat = target.T.ravel()
            scaled = solve_symmetric(gram, design.T @ flat)
            rest = flat - design @ scaled
            cost += float(rest @ rest + scaled @ scaled)
            start = START_SCALES * scaled
            residuals.append(rest.reshape(target.T.shape).T)
            starts.append(start)
            if not some:
                continue
            slopes = np.column_stack([(a.signal(index, start) - b.signal(index, start)) / d for a, b, d in pairs])
            stacked = slopes.reshape(target.shape[1], len(basis), some)
            slopes = (stacked - basis @ (basis.T @ stacked)).reshape(-1, some)
            projected = slopes - design @ solve_symmetric(gram, design.T @ slopes)
            gradient -= slopes.T @ rest
            information += slopes.T @ projected
            if correlated:
                count = len(basis)
                slowest = float(np.min(np.abs(centre.response.poles)))
                bandwidth = min(round(1.5 * 2 * np.pi / slowest / decay.step), count // 4)
                for c in range(target.shape[1]):
                    rows = slice(c * count, (c + 1) * count)
                    meat += long_run_variance(projected[rows] * rest[rows, None], bandwidth)
        whole = np.zeros(size)
        whole[told] = gradient
        matrices = []
        for part in (information, meat if correlated else information):
            square = np.zeros((size, size))
            square[np.ix_(told, told)] = part
            matrices.append(square)
        return System(cost, whole, matrices[0], matrices[1], tuple(residuals), tuple(starts))


class _Evaluated:
    """A response on the grids of all decays; grids that agree share their exponentials."""

    def __init__(self, response: BodyResponse, samples: DecaySamples) -> None:
        self.response, self.samples = response, samples
        self._waves: dict[tuple[float, float], Array] = {}
        self._sensors: dict[tuple[float, int], Array] = {}

    def _parts(self, index: int) -> tuple[Array, Array]:
        """Exponentials on the decay's grid, (n, 2k), and gains of sensor, averaging and whitening, (c, k)."""
        decay = self.samples.decays[index]
        key, longest = self.samples.grids[index]
        if key not in self._waves:
            self._waves[key] = self.response.waves(decay.times[0] + decay.step * np.arange(longest))
        sampling = (decay.record.step, decay.block)
        poles = self.response.poles
        if sampling not in self._sensors:
            sensor = sensor_gains(poles, self.samples.bandwidth_hz, decay.record.step)
            self._sensors[sampling] = sensor * decay.averaging(poles)
        return self._waves[key][: len(decay.times)], decay.whitening(poles) * self._sensors[sampling]

    def columns(self, index: int) -> list[Array]:
        """Per channel, columns over the starting state, offset and mains line projected out, (n, 12)."""
        waves, gains = self._parts(index)
        basis = self.samples.bases[index]
        clean = waves - basis @ (basis.T @ waves)
        return [clean @ weight for weight in self.response.weights(gains, self.samples.decays[index].axes)]

    def signal(self, index: int, start: Array) -> Array:
        """All channels one after the other for a given start, nuisances still in, (n c,)."""
        waves, gains = self._parts(index)
        result: Array = (waves @ self.response.weights_of(gains, self.samples.decays[index].axes, start)).T.ravel()
        return result
