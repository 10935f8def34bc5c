"""A pulled block's session (``baseline: drag``): friction, the drive, where sliding begins, teeth."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from ssmr_ident.doctor.blocks import conflicts
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.blocks.exported import exported
from ssmr_ident.identify.blocks.fit import Fitted
from ssmr_ident.identify.blocks.model import DAMPING, FALLING, KINETIC, STATIC, STIFFNESS
from ssmr_ident.identify.blocks.search import Pulls, chosen, error, known_shape, pulls_of, searched
from ssmr_ident.physics.rig import block_from_parameters
from ssmr_ident.workflows.fit.result import SessionFit

UNEXPLAINED = 10.0
"""Percent of a force beyond which its friction is no one number. Set by judgement: a load cell's noise is far less."""


def fit_drag_session(campaign: Campaign, measurements: tuple[Measurement, ...]) -> SessionFit:
    """Fit a block pulled over a surface by the poorest model that its pulls allow.

    The file's numbers are those of that model; a stiffness of the drive or a fall of the friction that the file does
    not have is told beside them.
    """
    parameters = campaign.parameters
    block = block_from_parameters(parameters)
    pulls = pulls_of(measurements, block.mass)
    found, _ = searched(pulls, parameters, known_shape(parameters))
    best = chosen(found)
    after = exported(best, parameters)
    values, stds = best.values, best.stds()
    results = {log.name: _numbers(best, pulls, k) for k, log in enumerate(pulls.logs)}
    for measurement in measurements:
        results[measurement.name]["experiment"] = measurement.entry.experiment
    clashing = [
        {"parameter": c.parameter, "prior": c.prior, "fitted": c.fitted, "sigmas": c.sigmas, "unit": c.unit}
        for c in conflicts(best)
    ]
    return SessionFit(
        session=campaign.session.name,
        before=parameters,
        parameters=after,
        changed=tuple(key for key in values if key in after and after[key] is not parameters.get(key)),
        statistics=(f"{len(measurements)} recordings, weight {best.blocks.weight:.4g} N",),
        recordings={name: _lines(numbers) for name, numbers in results.items()},
        results=results,
        findings=(*campaign.found, *_findings(best, values, stds, found[0]), *_doubts(results)),
        conflicts=tuple(clashing),
    )


def _doubts(results: dict[str, dict[str, Any]]) -> list[str]:
    """Pulls whose force one friction does not explain."""
    return [
        f"{name}: the fit leaves {numbers['nrmse_percent']:.0f} % of the force: its level of friction cannot be trusted"
        for name, numbers in results.items()
        if numbers["nrmse_percent"] > UNEXPLAINED
    ]


def _numbers(best: Fitted, pulls: Pulls, index: int) -> dict[str, Any]:
    log, own, values = pulls.logs[index], best.own[index], best.values
    moments = own[best.blocks.let_go(index)] if best.blocks.shape.falls else pulls.moments[index][:1]
    force = best.simulated[index]
    numbers: dict[str, Any] = {
        "drive_starts_s": float(log.time[0] + own[0]),
        "slides_from_s": float(log.time[0] + moments[0]),
        "zero_N": float(own[1]),
        "first_peak_N": float(force.max() - own[1]),
        "mu_kinetic": values[KINETIC],
        "mu_static": values[STATIC] if best.blocks.shape.falls else None,
        "rise_N_s": values[STIFFNESS] * log.speed if STIFFNESS in values else log.rise,
        "teeth": pulls.teeth[index],
        "stick_slip": pulls.teeth[index] > 0,
        "nrmse_percent": error(best, index),
    }
    if pulls.teeth[index] and len(moments) > 2:
        step, height, fall = log.step, [], []
        for begin, end in itertools.pairwise(moments):
            tooth = force[round(float(begin) / step) : round(float(end) / step) + 1]
            if len(tooth) > 2:
                low = int(np.argmin(tooth))
                height.append(float(tooth[0] - tooth[low]))
                fall.append(height[-1] / max(low * step, step))
        numbers |= {
            "tooth_hz": 1.0 / float(np.median(np.diff(moments))),
            "tooth_height_N": float(np.median(height)),
            "tooth_fall_N_s": float(np.median(fall)),
        }
    return numbers


def _lines(numbers: dict[str, Any]) -> tuple[str, ...]:
    starts, slides = numbers["drive_starts_s"], numbers["slides_from_s"]
    lines = [
        f"the drive starts at {starts:.4g} s, the block slides from {slides:.4g} s on",
        f"first peak {numbers['first_peak_N']:.4g} N over a zero of {numbers['zero_N']:.3g} N, after a rise of "
        f"{numbers['rise_N_s']:.4g} N/s",
    ]
    if "tooth_hz" in numbers:
        height, fall = numbers["tooth_height_N"], numbers["tooth_fall_N_s"]
        rate = f"{numbers['teeth']} teeth at {numbers['tooth_hz']:.4g} Hz"
        lines.append(f"{rate}, {height:.3g} N high, falling at {fall:.3g} N/s")
    else:
        lines.append("no stick-slip")
    return tuple(lines)


def _findings(best: Fitted, values: dict[str, float], stds: dict[str, float], base: Fitted) -> list[str]:
    shape, known = best.blocks.shape, base.blocks.shape
    said = []
    if shape.stretches and not known.stretches:
        stiffness = f"{values[STIFFNESS] / 1e3:.4g} ± {stds[STIFFNESS] / 1e3:.1g} N/mm"
        said.append(f"drive, load cell and cable stretch with {stiffness}, though the file takes the cable as stiff")
    if shape.stretches:
        ratio = values[DAMPING] / (2.0 * math.sqrt(values[STIFFNESS] * best.blocks.mass))
        said.append(f"the drive damps with {values[DAMPING]:.3g} ± {stds[DAMPING]:.1g} N s/m, a ratio of {ratio:.2g}")
    if shape.falls and not known.falls:
        fall = f"from {values[STATIC]:.3f} ± {stds[STATIC]:.1g} to {values[KINETIC]:.3f} ± {stds[KINETIC]:.1g}"
        over = f", over {values[FALLING] * 1e3:.2g} ± {stds[FALLING] * 1e3:.1g} mm/s" if shape.smoothly else ""
        said.append(f"friction falls {fall} once the block slides{over}, though the file has one")
    if shape.drifts:
        said.append(f"the load cell's zero drifts by {values['zero_drift_N_s']:.3g} N/s")
    if shape.changes:
        said.append("friction changes along the way, in every recording its own way: see ident diagnose")
    return said
