"""A rig's session (``baseline: sdof``): forced records and free decays to mass, spring and damper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.posterior.findings import conflicts, posterior_findings
from ssmr_ident.identify.posterior.most_probable import Observation, Posterior, Unknown, most_probable
from ssmr_ident.identify.rigs.frequency_domain import DERIVATIVES, ForcedRecord, RigFit, fit_rig
from ssmr_ident.identify.rigs.inverse_dynamics import fit_drive
from ssmr_ident.physics.rig import RIG_KEYS, rig_from_parameters
from ssmr_ident.report.figures_fit import NamedBackbone
from ssmr_ident.workflows.fit.result import SessionFit
from ssmr_ident.workflows.fit.rig_base import base_driven
from ssmr_ident.workflows.fit.rig_decays import free_decay, modes_after_a_hit

ONE_MODE_LEAVES = 50.0
"""Percent of a forced record that a single mode may leave; beyond, mass and stiffness are not those of the rig."""


def fit_rig_session(campaign: Campaign, chosen: tuple[Measurement, ...], coulomb: bool) -> SessionFit:
    """Fit a rig with one degree of freedom."""
    parameters = campaign.parameters
    rig = rig_from_parameters(parameters)
    keys = RIG_KEYS[rig.rotary]
    unknowns = tuple(
        Unknown(key, parameters[key].unit, float(parameters[key].value), parameters[key].std, positive=key == keys[0])
        for key in keys
        if not parameters[key].fixed
    )
    fixed = {key: float(parameters[key].value) for key in keys if parameters[key].fixed}
    lines: dict[str, tuple[str, ...]] = {}
    results: dict[str, dict[str, Any]] = {}
    findings = list(campaign.found)
    backbones: list[NamedBackbone] = []
    observations: list[Observation] = []
    based = [m for m in chosen if m.experiment.on_a_base]
    forced = [m for m in chosen if m.experiment.driven and m not in based]
    free = [m for m in chosen if m.experiment.free]
    others = [m for m in chosen if m not in (*forced, *free, *based)]
    lines |= {m.name: (f"{m.entry.experiment}: not fitted on a rig",) for m in others}
    if forced:
        drive = rig.stiffness == 0.0 and keys[2] in fixed
        fit = _drive(forced, coulomb) if drive else _forced(forced, parameters, (rig.mass, rig.damping, rig.stiffness))
        observations += _forced_result(forced, fit, keys, fixed, lines, results, findings)
        if not drive:
            findings += modes_after_a_hit(forced, lines, results)
    if based:
        observations.append(base_driven(based, rig, keys, fixed, lines, results, findings))
    for measurement in free:
        observations.append(free_decay(measurement, keys, fixed, lines, results, findings, backbones))
    if not observations:
        findings.append("no recording here tells a parameter: all keep what the file says")
    if free and not forced and keys[0] not in fixed:
        findings.append(
            f"a free decay gives {keys[1]} and {keys[2]} only as ratios to {keys[0]}, which keeps its prior"
        )
    posterior = most_probable(unknowns, observations)
    findings += posterior_findings(posterior)
    fitted = _updated(parameters, posterior)
    if forced and drive:
        fitted = _with_friction(fitted, fit)
    return SessionFit(
        session=campaign.session.name,
        before=parameters,
        parameters=fitted,
        changed=tuple(unknown.name for unknown in unknowns),
        statistics=(f"{len(chosen)} recordings, {len(unknowns)} parameters with priors",),
        recordings=lines,
        results=results,
        correlations=tuple(
            (unknowns[j].name, unknowns[i].name, float(posterior.correlations[i, j]))
            for i in range(len(unknowns))
            for j in range(i)
            if abs(posterior.correlations[i, j]) > 0.5
        ),
        findings=tuple(findings),
        conflicts=tuple(conflicts(posterior)),
        backbones=tuple(backbones),
    )


def _with_friction(parameters: ParameterSet, fit: RigFit) -> ParameterSet:
    """Friction that was fitted goes into the file as an effect, so that simulation and comparison have it too."""
    if fit.friction <= 3.0 * fit.friction_std:
        return parameters
    estimate = Estimate(fit.friction, fit.friction_std, "N", "fit of the recordings")
    return replace(parameters, effects={**parameters.effects, "dry_friction": {"F_c_N": estimate}})


def _forced(forced: list[Measurement], parameters: ParameterSet, start: tuple[float, float, float]) -> RigFit:
    records = []
    for measurement in forced:
        recording = measurement.recording
        motions = {name: recording[name] for name in DERIVATIVES if name in recording}
        force = recording["force" if "force" in recording else "torque"]
        records.append(ForcedRecord(1.0 / recording.sample_rate, force, motions))
    bandwidth = None
    if any("acceleration" in record.motions for record in records) and "accelerometer.bandwidth_hz" in parameters:
        bandwidth = parameters.number("accelerometer.bandwidth_hz")
    return fit_rig(records, start, bandwidth)


def _drive(forced: list[Measurement], coulomb: bool) -> RigFit:
    positions, forces = [], []
    for measurement in forced:
        recording = measurement.recording
        name = next((n for n in ("position", "angle", "velocity", "angular_rate") if n in recording), None)
        if name is None:
            raise InputError(
                recording.provenance.file,
                f"a drive without a spring needs position or velocity; found {', '.join(recording.names)}",
                "Map the header in session.yaml under channels",
            )
        motion = recording[name]
        if DERIVATIVES[name] == 1:
            motion = np.cumsum(motion) / recording.sample_rate
        positions.append(motion)
        forces.append(recording["force" if "force" in recording else "torque"])
    return fit_drive(positions, forces, 1.0 / forced[0].recording.sample_rate, coulomb)


def _forced_result(
    forced: list[Measurement],
    fit: RigFit,
    keys: tuple[str, ...],
    fixed: Mapping[str, float],
    lines: dict[str, tuple[str, ...]],
    results: dict[str, dict[str, Any]],
    findings: list[str],
) -> list[Observation]:
    stds = fit.stds
    lines["all forced"] = tuple(str(fit).splitlines())
    for number, measurement in enumerate(forced):
        share = {
            name.split(" ", 2)[-1]: value
            for name, value in fit.unexplained_percent.items()
            if name.startswith(f"record {number + 1} ") or name == "force"
        }
        results[measurement.name] = {"experiment": measurement.entry.experiment, "unexplained_percent": share}
    results["all forced"] = {
        "method": fit.method,
        **{key: value for key, value in zip(keys, (fit.mass, fit.damping, fit.stiffness), strict=True)},
        **{f"{key}_std": float(std) for key, std in zip(keys, stds, strict=True)},
        "coulomb_friction_N": fit.friction,
        "coulomb_friction_std_N": fit.friction_std,
        "force_offset_N": fit.offset,
        "force_offset_std_N": fit.offset_std,
    }
    if fit.friction_std and fit.friction > 3 * fit.friction_std:
        findings.append(
            f"dry friction of {fit.friction:.4g} ± {fit.friction_std:.2g} N and a force offset of {fit.offset:.3g} ± "
            f"{fit.offset_std:.2g} N were fitted beside mass and damper; neither is in the baseline model"
        )
    if fit.whiteness_p < 1e-3:
        findings.append(
            "the residual of the forced records holds structure: mass, damping and stiffness are those of the best "
            "linear rig, and their standard deviations do not say how far that is from the true one"
        )
    if fit.mass <= 0:
        findings.append(
            "the motion answers against the force: the sign of force or motion is turned, or another mode rules; "
            "mass and spring are not taken from the forced records"
        )
        return []
    if min(fit.unexplained_percent.values()) > ONE_MODE_LEAVES:
        findings.append(
            f"one mass on one spring leaves {min(fit.unexplained_percent.values()):.0f} % of the motion unexplained: "
            "mass and spring are not taken from the forced records"
        )
        return []
    free = [index for index, key in enumerate(keys) if key not in fixed]
    names = [keys[index] for index in free]
    values = np.array([fit.mass, fit.damping, fit.stiffness])[free]
    covariance = fit.covariance[np.ix_(free, free)] + np.diag((1e-6 * np.abs(values)) ** 2)

    def predict(now: Mapping[str, float]) -> np.ndarray:
        return np.array([now[name] for name in names])

    return [Observation("forced records", tuple(names), values, covariance, predict)]


def _updated(parameters: ParameterSet, posterior: Posterior) -> ParameterSet:
    changes = {}
    for index, unknown in enumerate(posterior.unknowns):
        before = parameters[unknown.name]
        informed = posterior.information_share[index] > 0.19
        source = "fit of the recordings" if informed else f"prior: {before.source}" if before.source else "prior"
        # An unknown std stays unknown where nothing was learnt: the wide prior's own width is no knowledge.
        std = float(posterior.stds[index]) if informed or before.std is not None else None
        changes[unknown.name] = replace(before, value=float(posterior.values[index]), std=std, source=source)
    return parameters.updated(changes)
