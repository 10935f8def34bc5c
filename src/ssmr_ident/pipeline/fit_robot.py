"""A robot's session: decays, pulls, presses and drags, then one maximum a posteriori over all of them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ssmr_ident.campaign import Campaign, Measurement
from ssmr_ident.core.errors import InputError
from ssmr_ident.identify.backbone import backbone
from ssmr_ident.identify.curves import load_curve
from ssmr_ident.identify.decay import fit_decay
from ssmr_ident.identify.decay_result import Mode
from ssmr_ident.identify.findings import amplitude_findings, conflicts, posterior_findings
from ssmr_ident.identify.friction import friction_of, gripping_load
from ssmr_ident.identify.posterior import Observation, Unknown, most_probable
from ssmr_ident.identify.robot_map import (
    RobotBuilder,
    friction_observation,
    modal_observations,
    pick_mode,
    predicted_modes,
    robot_unknowns,
    single_wheel_observation,
    slope_observation,
)
from ssmr_ident.identify.sawtooth import mean_with_wander, take_apart
from ssmr_ident.pipeline.fit import SessionFit
from ssmr_ident.pipeline.fit_robot_result import ROPE, path_of, strongest, tables, updated
from ssmr_ident.pipeline.fit_speeds import AtSpeed, rate_findings, slip_findings
from ssmr_ident.simulate.scenarios import ROPE_STIFFNESS

SEEN_BY = {"roll": ("ay", "wx"), "pitch": ("ax", "wy"), "yaw": ("ay", "wz")}
"""Channels that show a motion best (5.8): a roll turns gravity into y, a pitch into x, a yaw moves the cube along y."""

MOST_MODES = 3
"""A robot's log may hold its own mode, the neighbour it is coupled to, and the faster one of the pair."""


@dataclass
class _Gathered:
    """What the recordings gave so far."""

    observations: list[Observation] = field(default_factory=list)
    modes: dict[str, list[Mode]] = field(default_factory=dict)
    lines: dict[str, tuple[str, ...]] = field(default_factory=dict)
    results: dict[str, dict[str, Any]] = field(default_factory=dict)
    findings: list[str] = field(default_factory=list)
    slipping: list[AtSpeed] = field(default_factory=list)
    springs: dict[str, list[AtSpeed]] = field(default_factory=dict)
    rope: bool = False


def fit_robot_session(campaign: Campaign, chosen: tuple[Measurement, ...]) -> SessionFit:
    """Fit a robot (``rigid6``) or the thesis' pure rotations (``decoupled``)."""
    builder = RobotBuilder.of(campaign.parameters)
    decoupled = campaign.session.baseline == "decoupled"
    expected = predicted_modes(builder({}), decoupled=False)
    gathered = _Gathered()
    for measurement in chosen:
        experiment = measurement.entry.experiment
        if experiment == "free_response":
            _decay(measurement, expected, gathered)
        elif experiment == "pull" and measurement.entry.wheel_rate_rad_s:
            _spinning(measurement, builder, gathered)
        elif experiment == "pull":
            _pull(measurement, builder, gathered)
        elif experiment in ("vertical_compression", "wheel_drag"):
            _wheel(measurement, gathered)
        else:
            gathered.lines[measurement.name] = (f"{experiment}: not fitted here, its parameters keep their prior",)
            gathered.results[measurement.name] = {"experiment": experiment, "fitted": False}
    gathered.observations += modal_observations(gathered.modes, builder, decoupled)
    gathered.findings += _structure_left(gathered.results) + slip_findings(gathered.slipping)
    for what, springs in gathered.springs.items():
        gathered.findings += rate_findings(springs, what)
    unknowns = robot_unknowns(campaign.parameters)
    if gathered.rope:
        unknowns = (*unknowns, Unknown(ROPE, "N/m", ROPE_STIFFNESS, None))
    if not gathered.observations:
        gathered.findings.append("no recording here tells a parameter: all keep what robot.yaml says")
    posterior = most_probable(unknowns, gathered.observations)
    fitted = updated(campaign.parameters, posterior)
    if gathered.rope:
        value, std = posterior[ROPE]
        gathered.findings.append(f"the rope stretches: {value:.4g} ± {std:.2g} N/m in series with the tires (3.9)")
    chapter_5 = tables(gathered.modes, builder)
    gathered.findings += posterior_findings(posterior) + chapter_5[1]
    changed = tuple(path_of(u.name) for u in unknowns if u.name != ROPE)
    numbers = sum(len(o.values) for o in gathered.observations)
    return SessionFit(
        session=campaign.session.name,
        before=campaign.parameters,
        parameters=fitted,
        changed=changed,
        statistics=(
            f"{len(chosen)} recordings, {numbers} measured numbers, {len(unknowns)} parameters with priors",
            f"chi-square of the measured numbers {posterior.chi_square:.3g}",
        ),
        recordings=gathered.lines,
        results=gathered.results,
        tables=tuple(chapter_5[0]),
        correlations=strongest(posterior),
        findings=tuple(gathered.findings),
        conflicts=tuple(conflicts(posterior)),
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


def _decay(measurement: Measurement, expected: dict[str, tuple[float, float]], gathered: _Gathered) -> None:
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
    others = ", ".join(f"{m.frequency_hz:.2f} Hz" for m in fit.modes if m is not mode)
    lines = [
        f"{entry.motion} in {channel}: omega_n {mode.omega_n:.4f} +/- {mode.omega_n_std:.2g} rad/s, "
        f"xi {mode.xi:.5f} +/- {mode.xi_std:.2g}, f {mode.frequency_hz:.4f} Hz, lambda {mode.decay_rate:.4f} 1/s",
        f"from {fit.starts_s[0]:.3f} s, {len(fit.modes)} mode(s){', also ' + others if others else ''}"
        + (f", mains {fit.mains_amplitudes[0, 0]:.2g} {unit} removed" if fit.mains_hz[0] else ""),
    ]
    if not fit.adequate:
        lines.append(f"the residual holds structure: {fit.misfit:.3g} times the noise's variance")
    trend = backbone(recording.time, samples, fit)
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


def machine_position(measurement: Measurement) -> np.ndarray:
    """Position of the machine [m]: logged, or time times the stated speed.

    Raises
    ------
    InputError
        When neither is there.
    """
    recording, speed = measurement.recording, measurement.entry.speed_mm_s
    if "position" in recording:
        return recording["position"]
    if speed is None:
        raise InputError(
            recording.provenance.file,
            "has no position channel and session.yaml gives no speed_mm_s",
            "Give speed_mm_s for this recording",
        )
    return recording.time * speed * 1e-3


def _pull(measurement: Measurement, builder: RobotBuilder, gathered: _Gathered) -> None:
    entry, recording = measurement.entry, measurement.recording
    where = recording.provenance.file
    for key in ("direction", "height_m"):
        if getattr(entry, key) is None:
            raise InputError(f"{where}: {key}", "is missing", f"A pull needs {key} in session.yaml")
    direction, height = str(entry.direction), float(entry.height_m or 0.0)
    try:
        pull = take_apart(machine_position(measurement), recording["force"])
    except ValueError as error:
        raise InputError(where, f"no pull found: {error}", "Look at the log with ident inspect") from None
    robot = builder({})
    name, gripping = measurement.name, entry.wheels_gripping
    cable = entry.cable
    if cable == "rope":
        gathered.rope = True
        rigid = slope_observation(
            name, pull.first.slope, pull.first.slope_std, direction, height, gripping, float("inf"), builder
        )
        gathered.observations.append(
            replace(
                rigid,
                predict=lambda values: 1.0 / (1.0 / rigid.predict(values) + 1.0 / values[ROPE]),
            )
        )
    else:
        stiffness = cable.get("stiffness_N_m") if isinstance(cable, dict) else None
        gathered.observations.append(
            slope_observation(
                name, pull.first.slope, pull.first.slope_std, direction, height, gripping, stiffness, builder
            )
        )
    lines = [f"{direction} pull, {len(gripping)} wheel(s) gripping", *str(pull).splitlines()]
    result: dict[str, Any] = {
        "experiment": entry.experiment,
        "direction": direction,
        "first_rise_N_m": pull.first.slope,
        "first_rise_std_N_m": pull.first.slope_std,
        "stick_slip": pull.stick_slip,
        "teeth": len(pull.teeth),
    }
    if direction == "longitudinal" and len(gripping) == 4:
        lines.append(f"K_belt = {pull.first.slope / 2 / 1e3:.3g} N/mm by (3.8)")
    if pull.slides:
        load = gripping_load(robot, gripping, direction, height, pull.level)
        friction = friction_of(pull, load)
        lines.append(str(friction))
        result |= {"mu_static": friction.mu_static, "mu_kinetic": friction.mu_kinetic, "load_N": friction.load}
        if pull.stick_slip:
            troughs = np.array([tooth.trough for tooth in pull.teeth])
            forces = {
                "tire.mu_static": (pull.peak, 0.03 * pull.peak),
                "tire.mu_kinetic": (troughs.mean(), troughs.std()),
            }
            gathered.findings.append(
                f"{name}: stick-slip, {len(pull.teeth)} teeth: friction falls once the contact slides"
            )
        else:
            forces = {key: (pull.level, pull.level_std) for key in ("tire.mu_static", "tire.mu_kinetic")}
        for key, (force, std) in forces.items():
            gathered.observations.append(
                friction_observation(name, key, float(force), float(std), direction, height, gripping, builder)
            )
    gathered.lines[name] = tuple(lines)
    gathered.results[name] = result


def _spinning(measurement: Measurement, builder: RobotBuilder, gathered: _Gathered) -> None:
    """A pull whose wheels spin: the level of its second half over the load, at slip speed r·ω."""
    entry, force = measurement.entry, measurement.recording["force"]
    robot = builder({})
    level, std = mean_with_wander(force[len(force) // 2 :])
    direction, height = entry.direction or "lateral", entry.height_m or 0.0
    load = gripping_load(robot, entry.wheels_gripping, direction, height, level)
    speed = abs(float(entry.wheel_rate_rad_s or 0.0)) * robot.radius
    gathered.slipping.append(AtSpeed(measurement.name, speed, level / load, std / load))
    gathered.lines[measurement.name] = (
        f"{direction} pull with wheels spinning at {speed:.3g} m/s: mu {level / load:.3f} ± {std / load:.2g}",
    )
    gathered.results[measurement.name] = {
        "experiment": entry.experiment,
        "slip_speed_m_s": speed,
        "mu_kinetic": level / load,
        "mu_kinetic_std": std / load,
    }


def _wheel(measurement: Measurement, gathered: _Gathered) -> None:
    entry, recording = measurement.entry, measurement.recording
    try:
        curve = load_curve(machine_position(measurement), recording["force"])
    except ValueError as error:
        raise InputError(
            recording.provenance.file, f"no stiffness in it: {error}", "Look at the log with ident inspect"
        ) from None
    vertical = entry.experiment == "vertical_compression"
    key = "tire.stiffness_z_N_m" if vertical else "tire.stiffness_y_N_m"
    gathered.observations.append(single_wheel_observation(measurement.name, key, curve.stiffness, curve.stiffness_std))
    line = next(law for law in curve.choice.laws if law.name == "linear")
    speed = np.nan if entry.speed_mm_s is None else entry.speed_mm_s * 1e-3
    gathered.springs.setdefault("pressed down" if vertical else "dragged sideways", []).append(
        AtSpeed(measurement.name, speed, curve.stiffness, line.stds["stiffness"])
    )
    best = curve.choice.best
    law = ", ".join(f"{name} {value:.4g} ± {best.stds[name]:.2g}" for name, value in best.values.items())
    lines = [
        f"{'pressed down' if vertical else 'dragged sideways'}: {curve.stiffness / 1e3:.4g} +/- "
        f"{curve.stiffness_std / 1e3:.2g} N/mm from {curve.force_from:.0f} to {curve.force_to:.0f} N",
        f"best law: {best.name} ({law})" + ("" if curve.choice.decisive else ", not decisive"),
    ]
    if best.name != "linear" and curve.choice.decisive:
        gathered.findings.append(f"{measurement.name}: the tire's spring is not straight: {best.name} ({law})")
    gathered.lines[measurement.name] = tuple(lines)
    gathered.results[measurement.name] = {
        "experiment": entry.experiment,
        "stiffness_N_m": curve.stiffness,
        "stiffness_std_N_m": curve.stiffness_std,
        "law": best.name,
        **{f"law_{name}": value for name, value in best.values.items()},
    }
