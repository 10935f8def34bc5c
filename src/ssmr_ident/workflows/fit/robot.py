"""A robot's session: decays, pulls, presses and drags, then one maximum a posteriori over all of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.experiments.pull import ROPE_STIFFNESS
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.decays.backbone import backbone
from ssmr_ident.identify.decays.fit import fit_decay
from ssmr_ident.identify.forces.observations import SHARES, with_shifts_unknown
from ssmr_ident.identify.posterior.findings import amplitude_findings, conflicts, posterior_findings
from ssmr_ident.identify.posterior.most_probable import Unknown, most_probable
from ssmr_ident.identify.robot.unknowns import (
    match_further,
    modal_observations,
    pick_mode,
    predicted_modes,
    robot_unknowns,
    set_aside,
)
from ssmr_ident.report.figures_fit import NamedBackbone
from ssmr_ident.workflows.fit.decay_table import decay_table, named_decay
from ssmr_ident.workflows.fit.result import SessionFit
from ssmr_ident.workflows.fit.robot_decays import body_statistics, fit_samples
from ssmr_ident.workflows.fit.robot_forces import (
    Gathered,
    floor_findings,
    floor_unknowns,
    gather_pull,
    gather_spinning,
    gather_wheel,
    share_unknowns,
    stick_slip_findings,
)
from ssmr_ident.workflows.fit.robot_result import ROPE, in_file, path_of, strongest, tables, updated, variables
from ssmr_ident.workflows.fit.speeds import rate_findings, slip_findings

SEEN_BY = {"roll": ("ay", "wx"), "pitch": ("ax", "wy"), "yaw": ("ay", "wz")}
"""Channels that show a motion best (5.8): a roll turns gravity into y, a pitch into x, a yaw moves the cube along y."""

MOST_MODES = 3
"""A robot's log may hold its own mode, the neighbour it is coupled to, and the faster one of the pair."""

ENOUGH_FOR_A_START = 30
"""Iterations over the modes when all samples follow. Six decays and a pull: 30 and 300 iterations lead the samples to
the same seven digits, in 5 s and 20 s; the modes alone walk a flat valley of mass, stiffness and friction to no end."""


def fit_robot_session(
    campaign: Campaign,
    chosen: tuple[Measurement, ...],
    method: str | None = None,
    seed: int = 0,
    step: Callable[[str, int, int], None] = lambda stage, done, total: None,
) -> SessionFit:
    """Fit a robot (``rigid6``) or the thesis' pure rotations (``decoupled``).

    Parameters
    ----------
    campaign : Campaign
    chosen : tuple of Measurement
    method : {"output-error", "modal"} or None
        How free responses are fitted: by their samples, or by the modes found in each. None takes samples wherever
        there are accelerations and the baseline has a simulator.
    seed : int
        Of the random starts.
    step : callable
        Called with what is being done, how much of it is done, and of how much.

    Raises
    ------
    InputError
        For output error of pure rotations, which have no simulator beyond their modes.
    """
    if method == "output-error" and campaign.session.baseline == "decoupled":
        raise InputError(
            f"{campaign.session.folder}/session.yaml: baseline",
            "decoupled: pure rotations are fitted by their modes (5.3), not by samples",
            "Leave --method out, or take baseline: rigid6",
        )
    builder = RobotBuilder.of(campaign.parameters)
    decoupled = campaign.session.baseline == "decoupled"
    expected = predicted_modes(builder({}), decoupled=False)
    contacts = campaign.parameters["contact_points_m"]
    gathered = Gathered(shift_std=0.0 if contacts.fixed else contacts.std or 0.0)
    for index, measurement in enumerate(chosen):
        step("each recording by itself", index, len(chosen))
        experiment = measurement.experiment
        if experiment.free:
            _decay(measurement, expected, gathered)
        elif experiment.of_one_wheel:
            gather_wheel(measurement, gathered)
        elif experiment.drags_everything and measurement.entry.wheel_rate_rad_s:
            gather_spinning(measurement, builder, gathered)
        elif experiment.drags_everything:
            gather_pull(measurement, builder, gathered)
        else:
            gathered.lines[measurement.name] = (f"{experiment.name}: not fitted here, its parameters keep their prior",)
            gathered.results[measurement.name] = {"experiment": experiment.name, "fitted": False}
    step("each recording by itself", len(chosen), len(chosen))
    step("all recordings together", 0, 1)
    gathered.findings += _structure_left(gathered.results)
    gathered.findings += stick_slip_findings(gathered)
    for floor, levels in gathered.slipping.items():
        gathered.findings += slip_findings(levels, floor)
    for what, springs in gathered.springs.items():
        gathered.findings += rate_findings(springs, what)
    known = robot_unknowns(campaign.parameters)
    known += floor_unknowns(known, gathered) + share_unknowns(gathered)
    if gathered.rope:
        known = (*known, Unknown(ROPE, "N/m", ROPE_STIFFNESS, None))
    if not gathered.modes:
        gathered.observations, known = with_shifts_unknown(gathered.observations, known, seed)
    unknowns = set_aside(known, gathered.modes) if decoupled else known
    modal = modal_observations(gathered.modes, builder, decoupled)
    if not gathered.observations and not modal:
        gathered.findings.append("no recording here tells a parameter: all keep what robot.yaml says")
    body = None
    if method != "modal" and not decoupled and gathered.modes:
        start = most_probable(unknowns, [*gathered.observations, *modal], max_iterations=ENOUGH_FOR_A_START)
        body = fit_samples(campaign, chosen, unknowns, gathered, start, seed)
    posterior = most_probable(unknowns, [*gathered.observations, *modal]) if body is None else body.posterior
    step("all recordings together", 1, 1)
    fitted = updated(campaign.parameters, posterior)
    gathered.findings += floor_findings(posterior, gathered)
    if gathered.rope:
        value, std = posterior[ROPE]
        gathered.findings.append(f"the rope stretches: {value:.4g} ± {std:.2g} N/m in series with the tires (3.9)")
    chapter_5 = tables(gathered.modes, builder)
    gathered.findings += posterior_findings(posterior, SHARES, known) + chapter_5[1]
    changed = tuple(dict.fromkeys(path_of(u.name) for u in unknowns if in_file(u.name)))
    numbers = sum(len(o.values) for o in gathered.observations) + (0 if body else 2 * len(modal))
    return SessionFit(
        session=campaign.session.name,
        before=campaign.parameters,
        parameters=fitted,
        changed=changed,
        statistics=(
            f"{len(chosen)} recordings, {numbers} measured numbers, {len(unknowns)} parameters with priors",
            f"chi-square of the measured numbers {posterior.chi_square:.3g}",
            *body_statistics(body),
        ),
        recordings=gathered.lines,
        results=gathered.results,
        tables=(*([decay_table(gathered.decays)] if gathered.decays else []), *chapter_5[0]),
        correlations=strongest(posterior),
        findings=tuple(gathered.findings),
        conflicts=tuple(conflicts(posterior, known)),
        variables=variables(posterior, known),
        backbones=tuple(gathered.backbones),
        decays=tuple(gathered.decays),
        pulls=tuple(gathered.drawn_pulls),
    )


def _structure_left(results: dict[str, dict[str, Any]]) -> list[str]:
    """One sentence on the decays that a sum of modes does not explain; a few percent above the noise is not named."""
    decays = {name: result for name, result in results.items() if "residual_white" in result}
    left = {name: r["misfit"] for name, r in decays.items() if not r["residual_white"] and r["misfit"] > 2.0}
    if not left:
        return []
    worst = max(left, key=lambda name: left[name])
    return [
        f"{len(left)} of {len(decays)} decays leave more than noise behind (up to {left[worst]:.1f} times its "
        f"variance, {worst}): decaying modes alone do not explain them"
    ]


def _decay(measurement: Measurement, expected: dict[str, tuple[float, float]], gathered: Gathered) -> None:
    entry, recording = measurement.entry, measurement.recording
    where = recording.provenance.file
    if entry.motion is None:
        raise InputError(f"{where}: motion", "is missing", "Say roll, pitch or yaw in session.yaml")
    channel = next((name for name in SEEN_BY[entry.motion] if name in recording), None)
    if channel is None:
        raise InputError(
            where,
            f"a {entry.motion} response needs {' or '.join(SEEN_BY[entry.motion])}; found {', '.join(recording.names)}",
            "Map the header in session.yaml under channels",
        )
    samples, unit = recording[channel], recording.channel(channel).unit
    try:
        fit = fit_decay(recording.time, samples, max_modes=MOST_MODES, unit=unit)
    except InputError as error:
        raise InputError(f"{where}: {channel}", error.problem, error.mend) from None
    mode = pick_mode(fit, expected.get(entry.motion))
    gathered.modes.setdefault(entry.motion, []).append(mode)
    further = match_further(fit.modes, mode, expected)
    for name, other in further.items():
        gathered.modes.setdefault(name, []).append(other)
    others = ", ".join(f"{m.frequency_hz:.2f} Hz" for m in fit.modes if m is not mode)
    lines = [
        f"{entry.motion} in {channel}: omega_n {mode.omega_n:.4f} +/- {mode.omega_n_std:.2g} rad/s, "
        f"xi {mode.xi:.5f} +/- {mode.xi_std:.2g}, f {mode.frequency_hz:.4f} Hz, lambda {mode.decay_rate:.4f} 1/s",
        f"from {fit.starts_s[0]:.3f} s, {len(fit.modes)} mode(s){', also ' + others if others else ''}"
        + (f", mains {fit.mains_amplitudes[0, 0]:.2g} {unit} removed" if fit.mains_hz[0] else ""),
    ]
    if not fit.adequate:
        lines.append(f"the residual holds structure: {fit.misfit:.3g} times the noise's variance")
    drawn = named_decay(measurement.name, entry.motion, recording.time, samples, unit, fit, mode)
    if drawn is not None:
        gathered.decays.append(drawn)
    trend = backbone(recording.time, samples, fit)
    if trend is not None:
        gathered.backbones.append(NamedBackbone(measurement.name, f"{entry.motion} in {channel}", unit, trend))
    if trend is not None and not fit.adequate:
        falls = trend.omega_n[0] < trend.omega_n[-1]
        small = f"{trend.small_omega_n / 2 / np.pi:.3f} Hz"
        p_values = {"omega": trend.omega_trend_p, "xi": trend.xi_trend_p}
        gathered.findings += amplitude_findings(measurement.name, p_values, falls, small)
    gathered.lines[measurement.name] = tuple(lines)
    gathered.results[measurement.name] = {
        "experiment": entry.experiment,
        "motion": entry.motion,
        "omega_n_rad_s": mode.omega_n,
        "omega_n_std_rad_s": mode.omega_n_std,
        "omega_n_bound_rad_s": mode.omega_n_bound,
        "xi": mode.xi,
        "xi_std": mode.xi_std,
        "xi_bound": mode.xi_bound,
        "frequency_Hz": mode.frequency_hz,
        "decay_rate_1_s": mode.decay_rate,
        "start_s": fit.starts_s[0],
        "modes": len(fit.modes),
        "misfit": fit.misfit,
        "residual_white": fit.adequate,
    }
