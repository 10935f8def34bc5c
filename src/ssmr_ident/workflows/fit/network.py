"""A network's session (``baseline: network``): every recording at once to masses, springs and dampers."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from ssmr_ident.compare.comparison import measure
from ssmr_ident.compare.network import NO_GROUND
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.doctor.left import beyond
from ssmr_ident.doctor.result import conflicting, exported, predictions
from ssmr_ident.doctor.rules import OVER_NOISE
from ssmr_ident.doctor.table import over_noise
from ssmr_ident.estimate.baseline import fitted_baseline
from ssmr_ident.estimate.clipped import within_range
from ssmr_ident.estimate.model_error import under_model_error
from ssmr_ident.estimate.network import EXACTLY, network_problem
from ssmr_ident.estimate.values import Fit, Problem
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.physics.network import network_from_parameters
from ssmr_ident.workflows.fit.result import SessionFit

CORRELATED = 0.5
"""From which a correlation is printed."""

LEARNT = 0.9
"""Share of what was known of a parameter (its prior standard deviation) that a fit leaves at the most, to be said to
have told it."""


def fit_network_session(campaign: Campaign, chosen: tuple[Measurement, ...]) -> SessionFit:
    """Fit a linear network; initial states, zeros and gains of each recording are eliminated.

    Raises
    ------
    InputError
        Effects in the file: those are fitted by a diagnosis.
    """
    known = campaign.parameters
    if known.effects:
        mend = "Leave effects: out here; ident diagnose fits them beside the network"
        raise InputError(f"{known.file}: effects", "are not fitted with a network", mend)
    problem, clipped = within_range(network_problem(chosen, known), chosen)
    problem, fit = fitted_baseline(problem)
    fit = under_model_error(problem, fit)
    fitted = exported(fit, known)
    stds = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    free = [k for k, c in enumerate(fit.node.baseline) if c.std > EXACTLY]
    told = [k for k in free if stds[k] < LEARNT * fit.node.baseline[k].std]
    findings = [*campaign.found, *clipped]
    findings += [f"{fit.node.baseline[k].name} keeps its prior: these recordings do not tell it"
                 for k in free if k not in told]  # fmt: skip
    far = beyond(problem, fit) if over_noise(problem, fit) >= OVER_NOISE else None
    if far is not None:
        findings.append(str(far))
    if not problem.layout.grounded:
        findings.append(NO_GROUND)
    if not any(p.driven and not p.based for p in problem.pieces):
        name = fit.node.baseline[0].name
        findings.append(f"without a measured force all is known only as ratios to {name}, which stays")
    lines, results = _recordings(problem, fit, known)
    size = np.where(stds > 0.0, stds, 1.0)
    correlations = fit.covariance / np.outer(size, size)
    return SessionFit(
        session=campaign.session.name,
        before=known,
        parameters=fitted,
        changed=tuple(fit.node.baseline[k].name for k in free),
        statistics=(f"{len(chosen)} recordings, {len(free)} parameters with priors", f"ended: {fit.stop.value}"),
        recordings=lines,
        results=results,
        tables=(modes_table(known, fitted),),
        correlations=tuple(
            (fit.node.baseline[j].name, fit.node.baseline[i].name, float(correlations[i, j]))
            for at, i in enumerate(free)
            for j in free[:at]
            if abs(correlations[i, j]) > CORRELATED
        ),
        findings=tuple(findings),
        conflicts=tuple(asdict(conflict) for conflict in conflicting(fit)),
    )


def modes_table(before: ParameterSet, after: ParameterSet) -> str:
    """Frequencies, damping ratios and shapes of both, as text."""
    was, now = network_from_parameters(before), network_from_parameters(after)
    hz, ratio, shapes = now.modes()
    first = was.modes()[0]
    head = f"  {'mode':<6}{'f [Hz]':>12}{'before':>12}{'xi [%]':>10}   shape ({', '.join(now.layout.bodies)})"
    rows = [head]
    for k, (f, xi, shape) in enumerate(zip(hz, ratio, shapes.T, strict=True)):
        old = f"{first[k]:12.5g}" if k < len(first) else f"{'':>12}"
        rows.append(f"  {k + 1:<6}{f:12.5g}{old}{100 * xi:10.3g}   {', '.join(f'{value:.3g}' for value in shape)}")
    return "\n".join(["Modes", *rows])


def _recordings(
    problem: Problem, fit: Fit, known: ParameterSet
) -> tuple[dict[str, tuple[str, ...]], dict[str, dict[str, Any]]]:
    lines: dict[str, list[str]] = {}
    results: dict[str, dict[str, Any]] = {}
    judged = predictions(problem, fit, known)
    for piece, rest, prediction in zip(problem.pieces, fit.residuals, judged, strict=True):
        size, left = (piece.counted(x - x.mean(axis=0)).std(axis=0) for x in (piece.y, rest))
        share = dict(zip(piece.channels, map(float, 100.0 * left / np.maximum(size, 1e-300)), strict=True))
        places = [problem.layout.bodies[k] for k in piece.seen.bodies]
        said = ", ".join(f"{v:.3g} % of {name} of {on}" for (name, v), on in zip(share.items(), places, strict=True))
        apart = measure(prediction)[0]
        span = f"{piece.time[0]:.4g} to {piece.time[-1]:.4g} s"
        low, high = prediction.high_pass_hz, prediction.low_pass_hz
        where = f"from {low:.4g} to {high:.4g} Hz" if low else f"below {high:.4g} Hz"
        counted = "at all frequencies" if piece.band is None else "there"
        lines.setdefault(piece.name, []).append(f"{span}: {apart:.3g} % apart {where}; unexplained {counted} {said}")
        own = results.setdefault(piece.name, {"nrmse_percent": apart, "unexplained_percent": {}})
        own["unexplained_percent"] |= share
    return {name: tuple(own) for name, own in lines.items()}, results
