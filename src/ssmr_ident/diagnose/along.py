"""Where to begin an effect on a rig: at what its law makes of the path that was measured.

A law that is not there yet bends a simulation far from the recording, and from there no slope leads home. Along the
measured path nothing need be simulated, and how far a law is off shows in proportion. Play with soft corners (bank
5117) was answered as a hardening that left 4.7 % where noise leaves 0.8, and leaves 0.85 % when it is begun here. Noise
biases what is found, so that decides nothing: refits begin there.
Source: Masri and Caughey, J. Appl. Mech. 46 (1979) 433; Ljung, System Identification (1999), section 7.3 (equation
error).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from ssmr_ident.compare.recorded import follow
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.explain import with_suspect
from ssmr_ident.diagnose.path import Path, path_of
from ssmr_ident.diagnose.residual_force import Oscillator
from ssmr_ident.diagnose.scan import Suspect, smaller
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.rig import RIG_KEYS

Array = np.ndarray

REACH = 3.0
"""Prior standard deviations within which the rig's own mass, damping and stiffness are looked for."""

SHARES = (1.0, 0.3, 0.1, 0.03)
"""Of a probe, of which the nearest is where the law's parameters are begun."""

EVALUATIONS = 40
STEP = 1e-3
"""Of differences in scaled coordinates."""

FEW = 2
"""Terms of `unlisted` that go on."""

FARTHEST = 50.0
"""Scaled coordinates of a law's parameters stay within this, which their own bounds come before."""


@dataclass(frozen=True, eq=False)
class Along:
    """A model without its simulation: spring, law and what is linear, over all paths.

    Parameters
    ----------
    fit : JointFit
        Whose paths they are.
    keys : (str, str, str)
        Names of the rig's mass, damping and stiffness.
    rig : Oscillator
        With which the unexplained forces were worked out.
    paths : tuple of Path
    """

    fit: JointFit
    keys: tuple[str, str, str]
    rig: Oscillator
    paths: tuple[Path, ...]

    @property
    def columns(self) -> tuple[int, ...]:
        """Of acceleration and velocity, what the fit may add: a rig that is let go does not tell its mass."""
        known = {unknown.name for unknown in self.fit.model.physics}
        driven = any(trial.experiment.driven for trial in self.fit.trials)
        return tuple(k for k in (0, 1) if self.keys[k] in known and (driven or k > 0))

    def begun(self, suspect: Suspect) -> tuple[float, Model, Array]:
        """A model with a suspect's effect, at the point that explains the paths best, after how much is left there:
        infinitely much where its force is no number."""
        model, _ = with_suspect(self.fit, suspect)
        own = self._moved(model)
        weights = [1.0 / max(float(np.std(path.unexplained)), 1e-300) for path in self.paths]
        effect = CATALOGUE[suspect.effect]
        sizes = [replace(suspect, at=smaller(effect, suspect.at, share)) for share in SHARES]
        starts = [np.concatenate([self.fit.point, self._of(model, one)]) for one in sizes]
        point = min(starts, key=lambda start: float(np.sum(self._rest(model, start, weights) ** 2)))
        if not np.isfinite(self._unexplained(model, point, weights)).all():
            return np.inf, model, point
        for _ in range(2):
            point = self._descended(model, point, own, weights)
            # then every recording by what is left of it
            parts = np.split(self._rest(model, point, weights), self._cuts)
            stds = [max(float(np.std(rest)) / w, 1e-300) for w, rest in zip(weights, parts, strict=True)]
            weights = [1.0 / std for std in stds]
        return float(np.sum(np.log(stds))), model, self._with_linear(model, point, weights)

    def _of(self, model: Model, suspect: Suspect) -> Array:
        """Coordinates of a suspect's own parameters."""
        own = [c for c in model.free if c.effect == suspect.effect]
        return np.array([c.unknown.scaled(suspect.at[c.parameter.name]) for c in own])

    @property
    def _cuts(self) -> Array:
        return np.cumsum([len(path.unexplained) for path in self.paths])[:-1]

    def _moved(self, model: Model) -> list[int]:
        """Columns of a point that are looked for: the stiffness and all parameters of effects."""
        physics = [k for k, unknown in enumerate(model.physics) if unknown.name == self.keys[2]]
        return [*physics, *range(len(model.physics), len(model.unknowns))]

    def _descended(self, model: Model, point: Array, own: Sequence[int], weights: Sequence[float]) -> Array:
        reach = np.where(np.array(own) < len(model.physics), REACH, FARTHEST)

        def rest(part: Array) -> Array:
            at = point.copy()
            at[own] = part
            return self._rest(model, at, weights)

        start = np.clip(point[own], -0.99 * reach, 0.99 * reach)
        found = least_squares(rest, start, bounds=(-reach, reach), diff_step=STEP, max_nfev=EVALUATIONS)
        moved = point.copy()
        moved[own] = found.x
        return moved

    def _unexplained(self, model: Model, point: Array, weights: Sequence[float]) -> Array:
        values, effects = model.split(point)
        stiffness = values.get(self.keys[2], self.rig.stiffness)
        return np.concatenate(
            [
                w * (p.unexplained - p.force(stiffness, effects) - (stiffness - self.rig.stiffness) * p.linear[:, 2])
                for w, p in zip(weights, self.paths, strict=True)
            ]
        )

    def _linear(self, weights: Sequence[float]) -> Array:
        return np.concatenate([w * p.linear[:, self.columns] for w, p in zip(weights, self.paths, strict=True)])

    def _rest(self, model: Model, point: Array, weights: Sequence[float]) -> Array:
        """What is left, mass and damping at their best; far more than anything where a law's force is no number."""
        rest = self._unexplained(model, point, weights)
        if not np.isfinite(rest).all():
            return np.full(len(rest), FARTHEST)
        q = np.linalg.qr(self._linear(weights))[0]
        return rest - q @ (q.T @ rest)

    def _with_linear(self, model: Model, point: Array, weights: Sequence[float]) -> Array:
        """A point with the mass and damping that go with it, within what is known of them."""
        added = np.linalg.lstsq(self._linear(weights), self._unexplained(model, point, weights), rcond=None)[0]
        found = point.copy()
        for column, more in zip(self.columns, added, strict=True):
            index = next(k for k, unknown in enumerate(model.physics) if unknown.name == self.keys[column])
            unknown = model.physics[index]
            value = unknown.value(float(point[index]))
            least = unknown.value(-REACH)
            found[index] = np.clip(unknown.scaled(max(value + float(more), least)), -REACH, REACH)
        return found


def begun_along(fit: JointFit, suspects: Sequence[Suspect]) -> list[JointFit]:
    """Every law among the suspects, in each of its formulas, begun where it explains the measured paths best."""
    values = {**fit.trials[0].facts, **fit.model.split(fit.point)[0]}
    keys = next((keys for keys in RIG_KEYS.values() if values.get(keys[2], 0.0) > 0.0), None)
    if keys is None or any(trial.channels == ("force",) for trial in fit.trials):
        return []
    rig = Oscillator(*(values[key] for key in keys))
    laws = [suspect for suspect in suspects if is_law(suspect)]
    # in an order of their own: sums over recordings in another one round differently
    paths = sorted((path_of(fit, k, rig) for k in range(len(fit.trials))), key=lambda p: float(np.std(p.unexplained)))
    along = Along(fit, keys, rig, tuple(paths))

    best: dict[tuple[object, ...], tuple[float, Model, Array]] = {}
    for suspect, found in zip(laws, side_by_side(along.begun, laws), strict=True):
        form = (suspect.effect, *sorted(suspect.at))
        if found[0] < (best[form][0] if form in best else np.inf):
            best[form] = found
    ordered = sorted(best.items(), key=lambda item: item[1][0])
    crowd = [form for form, _ in ordered if form[0] == "unlisted"][FEW:]
    few = [(model, point) for form, (_, model, point) in ordered if form not in crowd]
    begun = side_by_side(lambda one: follow(fit.trials, *one, fit.nuisances), few)
    return [one for one in begun if np.isfinite(one.rss)]


def without_laws(groups: Sequence[Sequence[Suspect]]) -> list[list[Suspect]]:
    """Suspects by effect, without those that are begun along the paths."""
    left = [[suspect for suspect in group if not is_law(suspect)] for group in groups]
    return [group for group in left if group]


def is_law(suspect: Suspect) -> bool:
    """Whether a suspect is a law of a rig's spring that may be worked out along a path.

    A mass that rides on a spring of its own is none; and what differs in a frequency alone a straight line tells.
    """
    effect = CATALOGUE[suspect.effect]
    by_frequency = len(suspect.at) == 3 and any(set(suspect.at) == set(probe) for probe in effect.rig_probes)
    return Site.ELEMENT in effect.acts and not by_frequency
