"""A dragged block's session (``baseline: drag``): friction, stiffness of the drive, no false teeth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.forces.curves import block_pull
from ssmr_ident.identify.forces.sawtooth import take_apart
from ssmr_ident.identify.posterior.findings import conflicts, posterior_findings
from ssmr_ident.identify.posterior.most_probable import Observation, Unknown, most_probable
from ssmr_ident.physics.rig import block_from_parameters
from ssmr_ident.physics.robot import GRAVITY
from ssmr_ident.workflows.fit.result import SessionFit


def fit_drag_session(campaign: Campaign, chosen: tuple[Measurement, ...]) -> SessionFit:
    """Fit a block pulled over a surface.

    The level of each run counts with its wander along the stroke, and with the load cell's zero where that is not
    known: a force that stands before the pull may be an offset or a taut cable, and the log cannot say which.
    """
    parameters = campaign.parameters
    block = block_from_parameters(parameters)
    weight = block.mass * GRAVITY
    lines: dict[str, tuple[str, ...]] = {}
    results: dict[str, dict[str, Any]] = {}
    findings: list[str] = []
    observations: list[Observation] = []
    stiffnesses, rates = [], []
    for measurement in chosen:
        recording, speed = measurement.recording, measurement.entry.speed_mm_s
        where = recording.provenance.file
        if "force" not in recording:
            raise InputError(where, "has no force channel", "Map the header in session.yaml under channels")
        if speed is None:
            raise InputError(where, "session.yaml gives no speed_mm_s", "Give speed_mm_s for this recording")
        force = recording["force"]
        pull = block_pull(recording.time, force)
        try:
            teeth = take_apart(recording.time * speed * 1e-3, force)
        except ValueError as error:
            raise InputError(where, f"no pull found: {error}", "Look at the log with ident inspect") from None
        mu_begin, mu_mean = (pull.level_begin - pull.zero) / weight, (pull.level - pull.zero) / weight
        stiffness = pull.force_rate / (speed * 1e-3)
        text = [
            f"mu {mu_begin:.3f} where sliding begins, {mu_mean:.3f} on average, after taking off {pull.zero:.2f} N; "
            f"it wanders by {pull.wander / weight:.3f} along the stroke",
            f"first rise {pull.force_rate:.3g} ± {pull.force_rate_std:.2g} N/s, so drive and cable give "
            f"{stiffness / 1e3:.3g} N/mm at {speed:g} mm/s",
            f"{len(teeth.teeth)} teeth: " + ("stick-slip" if teeth.stick_slip else "no stick-slip"),
        ]
        std = pull.level_std
        if not pull.zero_known:
            findings.append(
                f"{measurement.name}: {pull.zero:.2f} N stand before the pull, so the load cell's zero is unknown and "
                f"the level cannot be trusted to better than {abs(pull.zero) / weight:.3f} in mu"
            )
            std = float(np.hypot(std, pull.zero))
        if teeth.stick_slip:
            findings.append(f"{measurement.name}: stick-slip, {len(teeth.teeth)} teeth")
        stiffnesses.append(stiffness)
        rates.append(pull.force_rate)
        lines[measurement.name] = tuple(text)
        results[measurement.name] = {
            "experiment": measurement.entry.experiment,
            "mu_begin": mu_begin,
            "mu_mean": mu_mean,
            "mu_wander": pull.wander / weight,
            "zero_N": pull.zero,
            "zero_known": bool(pull.zero_known),
            "force_rate_N_s": pull.force_rate,
            "force_rate_std_N_s": pull.force_rate_std,
            "rise_stiffness_N_m": stiffness,
            "teeth": len(teeth.teeth),
            "stick_slip": teeth.stick_slip,
        }
        for key in ("mu_static", "mu_kinetic"):
            level = teeth.peak - pull.zero if key == "mu_static" and teeth.stick_slip else pull.level - pull.zero
            observations.append(
                Observation(
                    measurement.name,
                    (key,),
                    np.array([level / weight]),
                    np.array([[(std / weight) ** 2]]),
                    _reads(key),
                )
            )
    # Run differs from run by more than each wanders: each then counts with the scatter between them.
    observations = _with_scatter(observations)
    unknowns = tuple(
        Unknown(key, parameters[key].unit, float(parameters[key].value), parameters[key].std)
        for key in ("mu_static", "mu_kinetic")
        if key in parameters and not parameters[key].fixed
    )
    observations = [o for o in observations if o.labels[0] in {u.name for u in unknowns}]
    posterior = most_probable(unknowns, observations)
    changes: dict[str, Estimate] = {
        unknown.name: replace(
            parameters[unknown.name],
            value=float(posterior.values[index]),
            std=float(posterior.stds[index]),
            source="fit of the recordings" if posterior.information_share[index] > 0.19 else "prior",
        )
        for index, unknown in enumerate(unknowns)
    }
    if np.isinf(block.cable_stiffness) and np.all(np.isfinite(stiffnesses)):
        low, high = min(stiffnesses) / 1e3, max(stiffnesses) / 1e3
        findings.append(
            f"the force comes up at {min(rates):.3g} to {max(rates):.3g} N/s: drive, load cell and cable stretch with "
            f"{low:.3g} to {high:.3g} N/mm, though the file takes the cable as stiff"
        )
    findings += posterior_findings(posterior)
    return SessionFit(
        session=campaign.session.name,
        before=parameters,
        parameters=parameters.updated(changes),
        changed=tuple(unknown.name for unknown in unknowns),
        statistics=(f"{len(chosen)} recordings, weight {weight:.4g} N",),
        recordings=lines,
        results=results,
        findings=tuple(findings),
        conflicts=tuple(conflicts(posterior)),
    )


def _reads(key: str) -> Callable[[Mapping[str, float]], np.ndarray]:
    """A prediction that is the parameter itself."""
    return lambda values: np.array([values[key]])


def _with_scatter(observations: list[Observation]) -> list[Observation]:
    widened = []
    for key in ("mu_static", "mu_kinetic"):
        same = [o for o in observations if o.labels == (key,)]
        scatter = float(np.var([o.values[0] for o in same], ddof=1)) if len(same) > 1 else 0.0
        widened += [replace(o, covariance=np.maximum(o.covariance, scatter)) for o in same]
    return widened
