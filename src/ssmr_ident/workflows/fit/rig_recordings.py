"""What each recording of a rig says by itself: frequency, damping, both against amplitude, and what is left of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ssmr_ident.compare.comparison import measure
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.doctor.result import predictions
from ssmr_ident.estimate.one_recording import Oscillation, alone
from ssmr_ident.estimate.pieces import Piece
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.identify.decays.backbone import Backbone, along
from ssmr_ident.identify.posterior.findings import TREND, amplitude_findings
from ssmr_ident.report.figures_fit import NamedBackbone
from ssmr_ident.signals.noise import whiteness

Array = np.ndarray

WHITE = 1e-3
"""Chance below which what is left of a recording is no white noise."""


@dataclass(frozen=True, eq=False)
class Found:
    """What is printed of each recording, the same for programs, findings, and what is drawn."""

    lines: dict[str, tuple[str, ...]] = field(default_factory=dict)
    results: dict[str, dict[str, Any]] = field(default_factory=dict)
    findings: list[str] = field(default_factory=list)
    backbones: list[NamedBackbone] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Seen:
    """A recording by itself.

    Parameters
    ----------
    unexplained : dict of str to float
        Percent of each channel that the fit of all recordings leaves.
    own : Oscillation or None
        None without a spring.
    trend : Backbone or None
        Of a decay with room for windows.
    drifts : bool
        Whether its frequency depends on amplitude.
    free : bool
        Whether nothing drove it.
    """

    unexplained: dict[str, float]
    own: Oscillation | None
    trend: Backbone | None
    drifts: bool
    free: bool


def recordings_of(
    problem: Problem, fit: Fit, known: ParameterSet, measurements: Sequence[Measurement], found: Found
) -> list[Seen]:
    """Each recording by itself; what it shows goes into ``found``."""
    judged = predictions(problem, fit, known)
    seen = []
    for number, measurement in enumerate(measurements):
        places = [k for k, piece in enumerate(problem.pieces) if piece.recording == number]
        one = _seen(problem, fit, places, measurement.experiment.free, number)
        text = ", ".join(f"{value:.3g} % of {name}" for name, value in one.unexplained.items())
        result = {
            "experiment": measurement.experiment.name,
            "start_s": problem.pieces[places[0]].begin,
            "nrmse_percent": float(np.mean([measure(judged[k])[0] for k in places])),
            "unexplained_percent": one.unexplained,
        }
        lines = [f"unexplained {text}, from {result['start_s']:.4g} s on"]
        if problem.pieces[places[0]].driven and not problem.pieces[places[0]].based:
            result["drive_zero"] = float(fit.nuisances[places[0]][fit.node.states])
        if one.own is not None:
            lines, result = [_told(one.own), *lines], result | _numbers(one.own)
        if one.trend is not None:
            piece = problem.pieces[places[0]]
            found.backbones.append(NamedBackbone(measurement.name, piece.channels[0], piece.units[0], one.trend))
            lines += str(one.trend).splitlines()
            result |= _over_amplitude(one.trend)
        if one.drifts and one.trend is not None:
            xi, std = one.trend.mean_xi
            lines[0] = f"no one frequency over the record; over windows of it xi = {xi:.4g} ± {std:.2g}"
            result |= {"xi": xi, "xi_std": std}
        if one.trend is not None and not _white(problem, places, one.own):
            small = f"{one.trend.small_omega_n:.3f} ± {one.trend.small_omega_n_std:.2g} rad/s"
            trends = {"omega": one.trend.omega_trend_p, "xi": one.trend.xi_trend_p}
            falls = bool(one.trend.omega_n[0] < one.trend.omega_n[-1])
            found.findings.extend(amplitude_findings(measurement.name, trends, falls, small))
        found.lines[measurement.name] = tuple(lines)
        found.results[measurement.name] = result
        seen.append(one)
    return seen


def _seen(problem: Problem, fit: Fit, places: Sequence[int], free: bool, number: int) -> Seen:
    left, moves = (
        np.concatenate([problem.pieces[k].counted(x - x.mean(axis=0)) for k, x in columns])
        for columns in ([(k, fit.residuals[k]) for k in places], [(k, problem.pieces[k].y) for k in places])
    )
    size = np.maximum(np.linalg.norm(moves, axis=0), 1e-300)
    shares = dict(zip(problem.pieces[places[0]].channels, map(float, 100.0 * np.linalg.norm(left, axis=0) / size),
                      strict=True))  # fmt: skip
    if fit.node.baseline[2].upper == math.inf:
        return Seen(shares, None, None, False, free)
    own = alone(problem, fit, number)
    first = problem.pieces[places[0]]
    trend = _trend(first, own) if free and len(places) == 1 and first.band is None else None
    drifts = trend is not None and trend.omega_trend_p < TREND and not _white(problem, places, own)
    return Seen(shares, own, trend, drifts, free)


def _trend(piece: Piece, own: Oscillation) -> Backbone | None:
    """Along the decay of the first channel, its zero taken off, from where it is within its range."""
    c = len(piece.channels)
    zero, drift = own.nuisances[0][-2 * c], own.nuisances[0][-c]
    cleaned = piece.y[:, 0] - zero - drift * np.linspace(-1.0, 1.0, len(piece.y))
    cut = np.flatnonzero(~piece.counts[:, 0])
    begin = int(cut[-1]) + 1 if len(cut) else 0
    return along(cleaned[begin:], piece.step * piece.every, own.omega_n, own.xi, float(piece.white[0]))


def _white(problem: Problem, places: Sequence[int], own: Oscillation | None) -> bool:
    """Whether what a recording's own fit leaves is white, in the first channel."""
    assert own is not None
    counted = [rest[problem.pieces[k].counts[:, 0], 0] for k, rest in zip(places, own.residuals, strict=True)]
    return all(whiteness(rest) > WHITE for rest in counted)


def _told(own: Oscillation) -> str:
    turn = 2.0 * math.pi
    return (
        f"f = {own.omega_n / turn:.6g} ± {own.omega_n_std / turn:.2g} Hz, "
        f"xi = {own.xi:.4g} ± {own.xi_std:.2g}, by this recording alone"
    )


def _numbers(own: Oscillation) -> dict[str, float]:
    return {
        "omega_n_rad_s": own.omega_n,
        "omega_n_std_rad_s": own.omega_n_std,
        "xi": own.xi,
        "xi_std": own.xi_std,
    }


def _over_amplitude(trend: Backbone) -> dict[str, Any]:
    columns = (trend.amplitude, trend.omega_n, trend.omega_n_std, trend.xi, trend.xi_std)
    names = ("amplitude", "omega_n_rad_s", "omega_n_std_rad_s", "xi", "xi_std")
    return {
        "small_amplitude_omega_n_rad_s": trend.small_omega_n,
        "small_amplitude_omega_n_std_rad_s": trend.small_omega_n_std,
        "over_amplitude": [dict(zip(names, map(float, row), strict=True)) for row in zip(*columns, strict=True)],
    }
