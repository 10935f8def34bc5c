"""A rig's session (``baseline: sdof``): all its recordings at once to mass, damping and stiffness."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, replace

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.doctor.left import beyond
from ssmr_ident.doctor.result import EXACTLY, baseline_covariance, conflicting, exported
from ssmr_ident.doctor.rules import OVER_NOISE
from ssmr_ident.doctor.table import over_noise
from ssmr_ident.estimate.baseline import fitted_baseline
from ssmr_ident.estimate.clipped import within_range
from ssmr_ident.estimate.model_error import under_model_error
from ssmr_ident.estimate.one_recording import oscillation
from ssmr_ident.estimate.pieces import FORCES
from ssmr_ident.estimate.problem import natural_hz, problem_of
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.lmfit_report import Variable
from ssmr_ident.identify.posterior.findings import trade_offs
from ssmr_ident.physics.rig import RIG_KEYS, rig_from_parameters
from ssmr_ident.physics.voltage_drive import DRIVE_KEYS
from ssmr_ident.report.text_fit import file_variables
from ssmr_ident.session.effects_block import in_rotary_units
from ssmr_ident.workflows.fit.after_hit import modes_after_a_hit
from ssmr_ident.workflows.fit.drive import told, with_friction
from ssmr_ident.workflows.fit.network import CORRELATED, LEARNT
from ssmr_ident.workflows.fit.result import SessionFit
from ssmr_ident.workflows.fit.rig_recordings import Found, Seen, recordings_of
from ssmr_ident.workflows.fit.small_motion import at_small_motion

ONE_MODE_LEAVES = 50.0
"""Percent of every recording that a single mode may leave; beyond, mass and stiffness are not those of the rig."""

ANOTHER = 0.2
"""Share by which a frequency may differ from the file's, before it is said that another mode may be meant."""


def fit_rig_session(campaign: Campaign, chosen: tuple[Measurement, ...], coulomb: bool) -> SessionFit:
    """Fit a rig with one degree of freedom; initial states, zeros and gains of each recording are eliminated."""
    known = campaign.parameters
    rig_from_parameters(known)  # says what is missing
    here = tuple(m for m in chosen if m.experiment.fitted_under(campaign.session.baseline))
    found = Found({m.name: (f"{m.entry.experiment}: not fitted on a rig",) for m in chosen if m not in here})
    found.findings.extend(campaign.found)
    if not here:
        found.findings.append("no recording here tells a parameter: all keep what the file says")
        return _answer(campaign, chosen, known, found)
    plain, clipped = within_range(problem_of(here, known), here)
    found.findings.extend(clipped)
    problem, fit = fitted_baseline(plain)
    rubbed = None if springs(fit) or not coulomb else with_friction(plain, fit)
    if rubbed is not None:
        problem, fit = rubbed
    fit = under_model_error(problem, fit)
    if rubbed is not None:
        found.findings.extend(told(problem, fit))
    far = beyond(problem, fit) if over_noise(problem, fit) >= OVER_NOISE else None
    if far is not None:
        found.findings.append(str(far))
    seen = recordings_of(problem, fit, known, here, found)
    if springs(fit):
        pushed = [m for m in here if not m.experiment.on_a_base and any(name in m.recording for name in FORCES)]
        found.findings.extend(modes_after_a_hit(pushed, found.lines, found.results))
    return _answer(campaign, chosen, _parameters(problem, fit, known, seen, found), found, fit)


def _parameters(problem: Problem, fit: Fit, known: ParameterSet, seen: Sequence[Seen], found: Found) -> ParameterSet:
    """The file with what the recordings tell; what they do not tell keeps what is known of it."""
    least = min(share for own in seen for share in own.unexplained.values())
    decays = any(one.drifts for one in seen) and all(one.free for one in seen)
    if least > ONE_MODE_LEAVES and not decays:
        found.findings.append(
            f"one mass on one spring leaves {least:.0f} % of the motion unexplained: another mode rules, or the sign "
            "of force or motion is turned; mass and spring are not taken from these recordings"
        )
        return known
    keys = RIG_KEYS["inertia_kg_m2" in known]
    if not any(p.driven and not p.based for p in problem.pieces):
        found.findings.append(
            f"without a measured force {keys[1]} and {keys[2]} are known only as ratios to {keys[0]}, which stays"
        )
    after = exported(fit, known)
    if decays:
        whole = ", ".join(f"{key} = {after.number(key):.4g} {after[key].unit}" for key in keys[1:])
        after = after.updated(at_small_motion(after, seen))
        found.findings.append(
            f"{keys[1]} and {keys[2]} are those of a small motion; the linear rig that follows the whole recordings "
            f"best, with which a diagnosis begins, has {whole}"
        )
    elif springs(fit):
        found.findings.extend(_another_mode(fit, known))
    untold = [c for c in fit.node.baseline if c.std > EXACTLY and (after[c.name].std or 0.0) > LEARNT * c.std * c.scale]
    found.findings.extend(f"{c.name} keeps its prior: these recordings do not tell it" for c in untold)
    held = [c for c in fit.node.baseline if c.std < EXACTLY and c.name in known and not known[c.name].fixed]
    stay = {
        c.name: replace(known[c.name], source=f"prior: {known[c.name].source}".removesuffix(": "))
        for c in (*untold, *held)
    }
    named = {id: in_rotary_units(block) for id, block in after.effects.items()} if known.rotary else after.effects
    return after.updated(stay, effects={**known.effects, **named})


def _another_mode(fit: Fit, known: ParameterSet) -> list[str]:
    """Whether the motion is at another frequency than the file's mass and stiffness mean."""
    hz, meant = oscillation(fit).omega_n / (2.0 * math.pi), natural_hz(known)
    if abs(hz / meant - 1.0) < ANOTHER:
        return []
    return [
        f"the recordings move at {hz:.4g} Hz, the file's mass and stiffness mean {meant:.4g} Hz: what was fitted is "
        "the mode that was recorded, which need not be the one that the file means"
    ]


def _answer(
    campaign: Campaign, chosen: Sequence[Measurement], after: ParameterSet, found: Found, fit: Fit | None = None
) -> SessionFit:
    known = campaign.parameters
    asked = (*RIG_KEYS["inertia_kg_m2" in known], *(key for key in DRIVE_KEYS[:-1] if key in known))
    keys = [key for key in asked if not known[key].fixed]
    statistics = [f"{len(chosen)} recordings, {len(keys)} parameters with priors"]
    correlations: list[tuple[str, str, float]] = []
    if fit is not None:
        statistics.append(f"ended: {fit.stop.value}")
        places = [k for k, c in enumerate(fit.node.baseline) if c.name in keys and c.upper < math.inf]
        names = [fit.node.baseline[k].name for k in places]
        covariance = baseline_covariance(fit, known)[np.ix_(places, places)]
        size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        matrix = covariance / np.outer(size, size)
        if all(c.std > EXACTLY for c in fit.node.baseline if c.name in known and c.name != DRIVE_KEYS[-1]):
            found.findings.extend(trade_offs(names, matrix))
        correlations = [
            (names[j], names[i], float(matrix[i, j]))
            for i in range(len(names))
            for j in range(i)
            if abs(matrix[i, j]) > CORRELATED
        ]
    return SessionFit(
        session=campaign.session.name,
        before=known,
        parameters=after,
        changed=tuple(keys),
        statistics=tuple(statistics),
        recordings=found.lines,
        results=found.results,
        correlations=tuple(correlations),
        findings=tuple(found.findings),
        conflicts=tuple(asdict(conflict) for conflict in conflicting(fit)) if fit is not None else (),
        variables=(*file_variables(known, after, keys), *_of_effects(known, after)),
        backbones=tuple(found.backbones),
    )


def _of_effects(known: ParameterSet, after: ParameterSet) -> list[Variable]:
    """What was fitted of an effect that the file has not."""
    return [
        Variable(f"{effect}.{name}", float(e.value), e.std, e.unit, source=e.source)
        for effect, block in after.effects.items()
        for name, e in (block.items() if effect not in known.effects else ())
        if not e.fixed
    ]


def springs(fit: Fit) -> bool:
    """Whether a rig has a spring."""
    return fit.node.baseline[2].upper < math.inf
