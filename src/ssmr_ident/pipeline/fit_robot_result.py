"""A robot's fit as a result: parameter set with sources, correlations, tables of chapter 5."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.identify.decay_result import Mode
from ssmr_ident.identify.findings import at_bound, table_5_2
from ssmr_ident.identify.posterior import Posterior
from ssmr_ident.identify.robot_map import HEIGHT, SHARES, RobotBuilder, geometry_of
from ssmr_ident.identify.tire_parameters import MOTIONS, damping_as_printed, solve_damping

UNINFORMED = 0.19
"""Share of information below which the posterior std is above 0.9 of the prior's: then the source is the prior."""

ON_FLOOR = " on "
"""Between a friction coefficient's key and the floor, for floors beside the one that the file gets."""

ROPE = "rope_stiffness_N_m"
"""An unknown beside those of the file: the rope between machine and robot."""


def in_file(name: str) -> bool:
    """True for the unknowns that a parameter file has a key for."""
    return name != ROPE and name not in SHARES and ON_FLOOR not in name


def path_of(name: str) -> str:
    return "contact_points_m" if name == HEIGHT else name


def updated(parameters: ParameterSet, posterior: Posterior) -> ParameterSet:
    """The parameter set with values, stds and sources of the fit."""
    changes: dict[str, Estimate] = {}
    for index, unknown in enumerate(posterior.unknowns):
        if not in_file(unknown.name):
            continue
        path = path_of(unknown.name)
        before = parameters[path]
        informed = posterior.information_share[index] > UNINFORMED
        source = "fit of the recordings" if informed else _prior_source(before)
        if posterior.information_share[index] < 1e-6:
            # no recording depends on it: the file's own digits stay
            changes[path] = replace(before, source=source)
            continue
        value = float(posterior.values[index])
        # An unknown std stays unknown where nothing was learnt: the wide prior's own width is no knowledge.
        std = float(posterior.stds[index]) if informed or before.std is not None else None
        if unknown.name == HEIGHT:
            points = np.asarray(before.value, float).copy()
            points[:, 2] -= value - unknown.prior
            changes[path] = replace(before, value=points, std=std, source=source)
        else:
            bound = at_bound(unknown, value)
            changes[path] = replace(before, value=value, std=std, source=source, at_bound=bound)
    return parameters.updated(changes)


def _prior_source(before: Estimate) -> str:
    return (
        "prior"
        if not before.source
        else before.source
        if before.source.startswith("prior")
        else f"prior: {before.source}"
    )


def strongest(posterior: Posterior) -> tuple[tuple[str, str, float], ...]:
    names = [unknown.name for unknown in posterior.unknowns]
    pairs = [
        (names[j], names[i], float(posterior.correlations[i, j]))
        for i in range(len(names))
        for j in range(i)
        if abs(posterior.correlations[i, j]) > 0.5
    ]
    return tuple(sorted(pairs, key=lambda pair: -abs(pair[2]))[:8])


def tables(modes: dict[str, list[Mode]], builder: RobotBuilder) -> tuple[list[str], list[str]]:
    """Table 5.2 of these recordings, and (5.10) with its findings where all three motions were recorded."""
    if not modes:
        return [], []
    ordered = {motion: modes[motion] for motion in MOTIONS if motion in modes}
    table = table_5_2({k: [(m.frequency_hz, m.decay_rate) for m in rows] for k, rows in ordered.items()})
    if set(ordered) != set(MOTIONS):
        return [table], []
    natural = np.array([np.mean([m.omega_n for m in rows]) for rows in ordered.values()])
    xi = np.array([np.mean([m.xi for m in rows]) for rows in ordered.values()])
    robot = builder({})
    geometry = geometry_of(robot)
    printed = damping_as_printed(natural, xi, robot.stiffness, geometry)
    exact = solve_damping(natural, xi, robot.stiffness, geometry)
    ratio = printed.inertia / np.diag(robot.inertia)
    lines = [
        "pure rotations, for comparison: what (5.3) and (5.10) make of these modes",
        "I_x, I_y, I_z = "
        + ", ".join(f"{value:.3f}" for value in printed.inertia)
        + " kg m^2, "
        + ", ".join(f"{value:.1f}" for value in ratio)
        + " times robot.yaml's",
        "D_x, D_y, D_z as printed "
        + ", ".join(f"{value:.0f}" for value in printed.damping)
        + "; solved exactly "
        + ", ".join(f"{value:.0f}" for value in exact.damping)
        + " N s/m",
    ]
    findings = [f"pure rotations (5.3), solved exactly: {text}" for text in exact.findings]
    return [table, "\n".join(lines)], findings
