"""Free decays of a rig: let go by hand, or after a blow."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.decays.backbone import backbone
from ssmr_ident.identify.decays.fit import fit_decay
from ssmr_ident.identify.decays.result import DecayFit
from ssmr_ident.identify.posterior.findings import TREND, amplitude_findings
from ssmr_ident.identify.posterior.most_probable import Observation
from ssmr_ident.identify.rigs.frequency_domain import DERIVATIVES
from ssmr_ident.readers.health import cut_off
from ssmr_ident.report.figures_fit import NamedBackbone

REST = 128
"""Samples that a decay must have beyond its sensor's range to be fitted there."""


def modes_after_a_hit(
    forced: list[Measurement], lines: dict[str, tuple[str, ...]], results: dict[str, dict[str, Any]]
) -> list[str]:
    """Modes of the free decay that follows a blow; nothing for a force that goes on."""
    findings = []
    for measurement in forced:
        recording = measurement.recording
        force = recording["force" if "force" in recording else "torque"]
        strength = np.abs(force - np.median(force))
        loud = np.flatnonzero(strength > 0.05 * strength.max())
        end = int(loud[-1]) + 1
        if end > 0.2 * len(force) or loud[-1] - loud[0] > 0.05 * len(force):
            continue
        names = [name for name in DERIVATIVES if name in recording]
        # Faster modes die first: a fiftieth of the record is left to them.
        start = float(recording.time[min(end + len(force) // 50, len(force) - 64)])
        table = np.column_stack([recording[name] for name in names])
        fit = fit_decay(recording.time, table, start_s=start, max_modes=3, unit=recording.channel(names[0]).unit)
        lines[f"{measurement.name} after the hit"] = tuple(str(fit).splitlines())
        results[f"{measurement.name} after the hit"] = {
            "experiment": "free decay after a hit",
            "modes": [
                {
                    "frequency_Hz": mode.frequency_hz,
                    "omega_n_rad_s": mode.omega_n,
                    "omega_n_std_rad_s": mode.omega_n_std,
                    "xi": mode.xi,
                    "xi_std": mode.xi_std,
                }
                for mode in fit.modes
            ],
        }
        strong = [m for m in fit.modes if np.sum(m.amplitudes**2) > 0.1 * np.sum(fit.dominant.amplitudes**2)]
        near = [m for m in strong if abs(m.omega_n / fit.dominant.omega_n - 1) < 0.3]
        if len(near) > 1:
            findings.append(
                f"{measurement.name}: {len(near)} modes close together, at "
                + " and ".join(f"{m.frequency_hz:.2f} Hz (xi {100 * m.xi:.2g} %)" for m in near)
                + ": one mass on one spring cannot beat"
            )
    return findings


def free_decay(
    measurement: Measurement,
    keys: tuple[str, ...],
    fixed: Mapping[str, float],
    lines: dict[str, tuple[str, ...]],
    results: dict[str, dict[str, Any]],
    findings: list[str],
    backbones: list[NamedBackbone],
) -> Observation:
    """Frequency and damping of a decay as an observation; what it shows goes into lines, results and findings."""
    recording = measurement.recording
    name = next((n for n in ("angle", "position", *DERIVATIVES) if n in recording), None)
    if name is None:
        raise InputError(
            recording.provenance.file,
            f"a free response needs {' or '.join(DERIVATIVES)}; found {', '.join(recording.names)}",
            "Map the header in session.yaml under channels",
        )
    samples = recording[name]
    start = _after_the_range(measurement.name, recording.time, samples, findings)
    try:
        fit = fit_decay(recording.time, samples, start_s=start, modes=1, unit=recording.channel(name).unit)
    except InputError as error:
        raise InputError(f"{recording.provenance.file}: {name}", error.problem, error.mend) from None
    mode = fit.dominant
    omega, xi, covariance = mode.omega_n, mode.xi, fit.covariance.copy()
    text = [*str(fit).splitlines()]
    trend = backbone(recording.time, samples, fit)
    result = _decay_numbers(fit)
    if trend is not None:
        backbones.append(NamedBackbone(measurement.name, name, recording.channel(name).unit, trend))
        text += str(trend).splitlines()
        result |= {
            "small_amplitude_omega_n_rad_s": trend.small_omega_n,
            "small_amplitude_omega_n_std_rad_s": trend.small_omega_n_std,
        }
        small = f"{trend.small_omega_n:.3f} ± {trend.small_omega_n_std:.2g} rad/s"
        p_values = {"omega": trend.omega_trend_p, "xi": trend.xi_trend_p}
        if not fit.adequate:
            findings += amplitude_findings(measurement.name, p_values, trend.omega_n[0] < trend.omega_n[-1], small)
            # Where the mode drifts over the record, one pair of numbers is no better known than the drift is wide.
            covariance[0, 0] += float(np.var(trend.omega_n))
            covariance[1, 1] += float(np.var(trend.xi))
            if p_values["omega"] < TREND:
                omega, (xi, std) = trend.small_omega_n, trend.mean_xi  # what a small motion has
                covariance[1, 1] = std**2 + float(np.var(trend.xi)) / len(trend.xi)
                result |= {"xi": xi, "xi_std": math.sqrt(covariance[1, 1])}
                text = [f"no one frequency over the record; in windows of a few periods xi = {xi:.4g} ± {std:.2g}",
                        *str(trend).splitlines()]  # fmt: skip
    lines[measurement.name] = tuple(text)
    results[measurement.name] = {"experiment": measurement.entry.experiment, **result}

    def predict(now: Mapping[str, float]) -> np.ndarray:
        values = {**fixed, **now}
        mass, damping, stiffness = (values[key] for key in keys)
        omega = np.sqrt(max(stiffness / mass, 1e-12))
        return np.array([omega, damping / (2 * mass * omega)])

    return Observation(measurement.name, ("omega_n", "xi"), np.array([omega, xi]), covariance, predict)


def _after_the_range(name: str, time: np.ndarray, samples: np.ndarray, findings: list[str]) -> float | None:
    """Time from which a decay stays within its sensor's range, where it has left it [s]."""
    cut = np.flatnonzero(cut_off(samples))
    if not len(cut):
        return None
    first = int(cut[-1]) + 1
    if len(samples) - first < REST:
        findings.append(f"{name}: {len(cut)} clipped samples up to its end; xi and frequency are those of a cut signal")
        return None
    start = float(time[first])
    findings.append(
        f"{name}: {len(cut)} clipped samples; the decay is fitted after the last of them, from {start:.4g} s on"
    )
    return start


def _decay_numbers(fit: DecayFit) -> dict[str, Any]:
    mode = fit.dominant
    return {
        "omega_n_rad_s": mode.omega_n,
        "omega_n_std_rad_s": mode.omega_n_std,
        "omega_n_bound_rad_s": mode.omega_n_bound,
        "xi": mode.xi,
        "xi_std": mode.xi_std,
        "xi_bound": mode.xi_bound,
        "start_s": fit.starts_s[0],
        "residual_white": fit.adequate,
    }
