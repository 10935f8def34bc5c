"""A robot's fit as a result: parameter set with sources, correlations, tables of chapter 5."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ssmr_ident.core.parameter import FITTED, Estimate, ParameterSet
from ssmr_ident.identify.body.builder import HEIGHT, SENSOR, SHIFTS, RobotBuilder
from ssmr_ident.identify.body.tire_parameters import MOTIONS, damping_as_printed, solve_damping
from ssmr_ident.identify.decays.result import Mode
from ssmr_ident.identify.forces.observations import SHARES
from ssmr_ident.identify.lmfit_report import Variable
from ssmr_ident.identify.posterior.findings import at_bound, table_5_2
from ssmr_ident.identify.posterior.most_probable import Posterior, Unknown
from ssmr_ident.identify.robot.unknowns import geometry_of

UNINFORMED = 0.19
"""Share of information below which the posterior std is above 0.9 of the prior's: then the source is the prior."""

ON_FLOOR = " on "
"""Between a friction coefficient's key and the floor, for floors beside the one that the file gets."""

ROPE = "rope_stiffness_N_m"
"""An unknown beside those of the file: the rope between machine and robot."""


def in_file(name: str) -> bool:
    """True for the unknowns that a parameter file has a key for."""
    return name != ROPE and name not in SHARES and ON_FLOOR not in name


PARTS = {
    **dict.fromkeys((*SHIFTS, HEIGHT), "contact_points_m"),
    **dict.fromkeys(SENSOR, "accelerometer.position_m"),
}
"""Unknowns that are parts of an array in the file."""


def path_of(name: str) -> str:
    return PARTS.get(name, name)


def updated(parameters: ParameterSet, posterior: Posterior) -> ParameterSet:
    """The parameter set with values, stds and sources of the fit.

    An array has one std in the file: that of its least known part, so that nothing is claimed to be known better
    than it is.
    """
    changes: dict[str, Estimate] = {}
    for index, unknown in enumerate(posterior.unknowns):
        if not in_file(unknown.name) or unknown.name in PARTS:
            continue
        before = parameters[unknown.name]
        share = posterior.information_share[index]
        source = FITTED if share > UNINFORMED else _prior_source(before)
        if share < 1e-6:
            # no recording depends on it: the file's own digits stay
            changes[unknown.name] = replace(before, source=source)
            continue
        value = float(posterior.values[index])
        # An unknown std stays unknown where nothing was learnt: the wide prior's own width is no knowledge.
        std = float(posterior.stds[index]) if share > UNINFORMED or before.std is not None else None
        bound = at_bound(unknown, value)
        changes[unknown.name] = replace(before, value=value, std=std, source=source, at_bound=bound)
    for path in dict.fromkeys(PARTS.values()):
        indices = [k for k, unknown in enumerate(posterior.unknowns) if path_of(unknown.name) == path]
        if indices:
            changes[path] = _array(parameters[path], posterior, indices)
    return parameters.updated(changes)


def _array(before: Estimate, posterior: Posterior, indices: list[int]) -> Estimate:
    shares = posterior.information_share[indices]
    source = FITTED if shares.max() > UNINFORMED else _prior_source(before)
    if shares.max() < 1e-6:
        return replace(before, source=source)
    array = np.asarray(before.value, float).copy()
    for index in indices:
        name, value = posterior.unknowns[index].name, float(posterior.values[index])
        if name == HEIGHT:
            array[:, 2] -= value - posterior.unknowns[index].prior
        elif name in SHIFTS:
            array[:, SHIFTS.index(name)] += value
        else:
            array[SENSOR.index(name)] = value
    std = None if before.std is None and shares.min() <= UNINFORMED else float(max(posterior.stds[indices]))
    return replace(before, value=array, std=std, source=source)


def _prior_source(before: Estimate) -> str:
    return (
        "prior"
        if not before.source
        else before.source
        if before.source.startswith("prior")
        else f"prior: {before.source}"
    )


def variables(posterior: Posterior, known: Sequence[Unknown]) -> tuple[Variable, ...]:
    """Every unknown with its value, standard deviation and what was known before, for the printed report."""
    before = {unknown.name: unknown for unknown in known}
    return tuple(
        Variable(
            unknown.name,
            float(value),
            float(std),
            unknown.unit,
            before[unknown.name].prior,
            before[unknown.name].prior_std,
            "data" if share > UNINFORMED else "prior",
        )
        for unknown, value, std, share in zip(
            posterior.unknowns, posterior.values, posterior.stds, posterior.information_share, strict=True
        )
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
