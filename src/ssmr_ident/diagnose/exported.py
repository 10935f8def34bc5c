"""A joint fit as a parameter file: values, standard deviations, sources, and effects with theirs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import FITTED, Estimate, ParameterSet
from ssmr_ident.diagnose.setup import twin
from ssmr_ident.identify.body.builder import HEIGHT, SENSOR, SHIFTS
from ssmr_ident.identify.fitting.descent import chatters
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.fitting.roughness import scatter_of
from ssmr_ident.physics.effects import CATALOGUE

UNINFORMED = 0.9
"""Posterior over prior standard deviation from which the recordings told nothing of a parameter."""


def exported(fit: JointFit, before: ParameterSet) -> ParameterSet:
    """The parameter set that a fit stands for.

    Parameters
    ----------
    fit : JointFit
        With slopes at its point.
    before : ParameterSet
        Whose keys, units and fixed values are kept.
    """
    model, point = fit.model, fit.point
    stds = np.sqrt(np.maximum(np.diag(scatter_of(fit)), 0.0))
    values, effects = model.split(point)
    changes: dict[str, Estimate] = {}
    contacts = np.array(before["contact_points_m"].value, float) if "contact_points_m" in before else None
    place = np.array(before["accelerometer.position_m"].value, float) if "accelerometer.position_m" in before else None
    widest: dict[str, list[tuple[float, float]]] = {}
    for index, unknown in enumerate(model.physics):
        value, std = values[unknown.name], unknown.std(float(point[index]), float(stds[index]))
        told = float(stds[index]) < UNINFORMED
        if unknown.name == HEIGHT and contacts is not None:
            contacts[:, 2] -= value - unknown.prior
            widest.setdefault("contact_points_m", []).append((std, float(told)))
        elif unknown.name in SHIFTS and contacts is not None:
            contacts[:, SHIFTS.index(unknown.name)] += value
            widest.setdefault("contact_points_m", []).append((std, float(told)))
        elif unknown.name in SENSOR and place is not None:
            place[SENSOR.index(unknown.name)] = value
            widest.setdefault("accelerometer.position_m", []).append((std, float(told)))
        else:
            # gains are in a file only once they have been fitted
            old = before.get(unknown.name) or Estimate(
                unknown.prior, unknown.prior_std, unknown.unit, "its sensitivity"
            )
            kept = None if unknown.prior_std is None and not told else std
            changes[unknown.name] = replace(old, value=value, std=kept, source=FITTED if told else _prior(old))
    for path in before:
        other = twin(path, before)
        if other in changes and path not in changes:
            changes[path] = replace(changes[other], unit=before[path].unit)
    for path, array in (("contact_points_m", contacts), ("accelerometer.position_m", place)):
        if path in widest and array is not None:
            source = FITTED if any(told for _, told in widest[path]) else _prior(before[path])
            changes[path] = replace(before[path], value=array, std=max(s for s, _ in widest[path]), source=source)
    return replace(before.updated(changes), effects=_effects(fit, effects, stds))


def _effects(fit: JointFit, effects: dict[str, dict[str, float]], stds: np.ndarray) -> dict[str, dict[str, Estimate]]:
    count = len(fit.model.physics)
    found: dict[str, dict[str, Estimate]] = {}
    for effect_id, values in effects.items():
        units = {p.name: p.unit for p in CATALOGUE[effect_id].parameters}
        found[effect_id] = {
            name: Estimate(float(value), None, units[name], "not fitted", fixed=True) for name, value in values.items()
        }
    for index, coordinate in enumerate(fit.model.free):
        name, unknown = coordinate.parameter.name, coordinate.unknown
        value = effects[coordinate.effect][name]
        std = unknown.std(float(fit.point[count + index]), float(stds[count + index]))
        spread = max(std, _place(fit, name), _between(fit, coordinate.effect, name, value))
        bound = value in (coordinate.parameter.lower, coordinate.parameter.upper)
        found[coordinate.effect][name] = Estimate(value, spread, unknown.unit, FITTED, at_bound=bound)
    return found


def _place(fit: JointFit, parameter: str) -> float:
    """What an offset of the centre of mass cannot be known better than: contacts and sensor, as far as they are known.

    Of contacts alone the recordings tell the sum of both. Slopes across contacts that let go are too rough to say so.
    """
    if not parameter.startswith("offset_"):
        return 0.0
    names = f"contact_shift_{parameter[7:]}", f"accelerometer.position_m.{parameter[7:-2]}"
    known = [u.prior_spread for u in fit.model.physics if u.name in names and u.prior_std is not None]
    return float(1.0 / np.sqrt(np.sum(1.0 / np.square(known)))) if known else 0.0


def _between(fit: JointFit, effect_id: str, parameter: str, value: float) -> float:
    """What a parameter cannot be known better than where saw-teeth come out of step: half of the way between the values
    it was begun at, for no descent leads from one to the next."""
    tried = np.array(CATALOGUE[effect_id].spans.get(parameter, ()))
    if len(tried) < 2 or not chatters(fit):
        return 0.0
    nearest = int(np.clip(np.searchsorted(tried, value), 1, len(tried) - 1))
    return float(0.5 * (tried[nearest] - tried[nearest - 1]))


def _prior(old: Estimate) -> str:
    return old.source if old.source.startswith("prior") else f"prior: {old.source}" if old.source else "prior"
