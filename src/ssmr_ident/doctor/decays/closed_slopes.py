"""A simulated linear model's slopes in closed form: a seventh of what differences between simulations cost.

The simulator's motions are small ones but for a few per cent, so that slopes by eigenvalues lead a fit to within a
fraction of a deviation of its optimum. Its states at the release are fewer than those of the closed form: branches hold
one share of what the release is displaced by, and slow sensors have met a share of the first acceleration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.doctor.decays.linear import design_of, linear_slopes, state_count
from ssmr_ident.doctor.decays.modes import SENSOR_STATES, Modes, modes_at, slopes_of, waves
from ssmr_ident.doctor.decays.recordings import Decay
from ssmr_ident.identify.body.response import sensor_gains
from ssmr_ident.identify.fitting.descent import Differentiated
from ssmr_ident.identify.fitting.joint import JointFit, Slopes, acting, differences, differentiate
from ssmr_ident.identify.trials.decay import OWN, SCALES, STATES, SWAYING
from ssmr_ident.physics.extended import BODY, LINEAR

Array = np.ndarray

SWAY = slice(STATES.index(SWAYING[0]), STATES.index(SWAYING[-1]) + 1)
LOADED, UNSEEN = (STATES.index(name) for name in OWN)


def closed_slopes(decays: Sequence[Decay]) -> Differentiated:
    """``joint.differentiate`` of models of these recordings, or of their first parts: what is linear in closed form,
    laws' own coordinates by differences, and all by differences where there are no modes."""

    def differentiated(fit: JointFit, shared: bool = True) -> JointFit:
        first, model = decays[0], fit.model
        linear = np.ones(len(fit.point), dtype=bool)
        for law in [name for name in fit.model.held if name not in LINEAR]:
            model, kept = model.without_effect(law)
            linear[linear] = kept
        modes = modes_at(first.builder, model, fit.point[linear], first.log_step)
        if modes is None:
            return differentiate(fit, shared)
        moved = slopes_of(modes, first.builder, model, fit.point[linear], first.log_step)
        beside = _laws_alone(fit, np.flatnonzero(~linear) if shared else (), modes)
        found = []
        for k, (whole, trial, nuisance) in enumerate(zip(decays, fit.trials, fit.nuisances, strict=True)):
            decay = replace(whole, trial=trial)
            sensed = decay.sensed(modes.kept, modes.bandwidth_hz, modes.of_sensor, bool(moved.by_band.any()))
            white = decay.whitened(waves(modes.kept, decay.first, decay.step, len(decay.times)))
            state, by = tied(modes, nuisance, decay.log_step)
            own = design_of(decay, white, modes, sensed) @ by
            slopes = np.zeros((len(own), len(fit.point)))
            slopes[:, linear] = linear_slopes(decay, white, modes, moved, sensed, state)
            if beside:
                slopes, own = slopes + beside[k].shared, own + beside[k].own
            found.append(Slopes(slopes, own))
        return replace(fit, slopes=tuple(found), exact=False)

    return differentiated


def _laws_alone(fit: JointFit, coordinates: Sequence[int] | Array, modes: Modes) -> tuple[Slopes, ...]:
    """Slopes by laws' coordinates, and by the nuisances that closed form has no part in."""
    closed = [*range(BODY), *(range(SWAY.start, SWAY.stop) if modes.sways else ())]
    closed += [LOADED] if modes.relaxes else []
    closed += [UNSEEN] if modes.slow else []
    others = {column for trial in fit.trials for column in acting(trial, fit.model)} - set(closed)
    if not len(coordinates) and not others:
        return ()
    return differences(fit, list(coordinates), others)


def tied(modes: Modes, nuisance: Array, log_step: float) -> tuple[Array, Array]:
    """The closed form's states at the release that a simulation begins with, SI, and their slopes by its nuisances."""
    by = np.zeros((state_count(modes), len(STATES)))
    by[:BODY, :BODY] = np.eye(BODY)
    at = BODY
    if modes.sways:
        by[at : at + 4, SWAY] = np.eye(4)
        at += 4
    known = nuisance * SCALES
    state = by @ known
    if modes.relaxes:
        by[at : at + 6, :6] = known[LOADED] * np.eye(6)
        by[at : at + 6, LOADED] = known[:6]
        state[at : at + 6] = known[LOADED] * known[:6]
        at += 6
    if modes.slow:
        over, by_new = _not_yet_met(modes, at, float(known[UNSEEN]), log_step)
        by[at:] += over @ by[:at]
        by[at:, UNSEEN] += by_new @ state[:at]
        state[at:] = over @ state[:at]
    return state, by * SCALES


def _not_yet_met(modes: Modes, count: int, new: float, log_step: float) -> tuple[Array, Array]:
    """Transients of slow sensors over the other states, and their slopes by the share of the first acceleration that
    is new to them: of the rest they have read a constant before the release."""
    kept, others = modes.kept, ~modes.of_sensor
    into, weight = modes.into[modes.keep][others, :count], modes.weight[others]
    read = modes.read[:, modes.keep][:, others] * weight

    def over(factor: Array) -> Array:
        return np.asarray(((read * factor) @ into).real)

    poles = kept[others]
    gains = sensor_gains(poles, modes.bandwidth_hz, log_step)
    first, size = over(np.ones_like(poles)), abs(modes.poles[-1])
    found, by_new = np.zeros((SENSOR_STATES, count)), np.zeros((SENSOR_STATES, count))
    found[0::2], found[1::2] = (1.0 - new) * first - over(gains), -over(gains * poles) / size
    by_new[0::2] = -first
    return found, by_new
