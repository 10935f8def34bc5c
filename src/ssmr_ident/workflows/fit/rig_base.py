"""A rig on a foot that is moved: frequency and damping from what the mass does against its foot; its mass stays."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ssmr_ident.estimate.foot import foot_motion
from ssmr_ident.experiments.campaign import Measurement
from ssmr_ident.experiments.experiment import BASES
from ssmr_ident.identify.posterior.most_probable import Observation
from ssmr_ident.identify.rigs.frequency_domain import DERIVATIVES, ForcedRecord, fit_rig
from ssmr_ident.physics.rig import Rig

ALIKE = 1e-4
"""Choice: relative error beside the fit's own, of two accelerometers whose clocks and phases are taken as alike."""


def base_driven(
    measurements: list[Measurement],
    rig: Rig,
    keys: tuple[str, ...],
    fixed: Mapping[str, float],
    lines: dict[str, tuple[str, ...]],
    results: dict[str, dict[str, Any]],
    findings: list[str],
) -> Observation:
    """Damping and stiffness over the mass as an observation; what it shows goes into lines, results and findings."""
    fit = fit_rig([_against_the_foot(m) for m in measurements], (1.0, rig.damping / rig.mass, rig.stiffness / rig.mass))
    # the gain of two accelerometers may differ; what the foot and the mass say of the ratios does not depend on it
    ratios = np.array([fit.damping, fit.stiffness]) / fit.mass
    turn = np.array([[-ratios[0], 1.0, 0.0], [-ratios[1], 0.0, 1.0]]) / fit.mass
    covariance = turn @ fit.covariance @ turn.T + np.diag((ALIKE * ratios) ** 2)
    omega = math.sqrt(ratios[1])
    xi = ratios[0] / (2.0 * omega)
    slope = np.array([[0.0, 0.5 / omega], [0.5 / omega, -0.5 * xi / ratios[1]]])
    omega_std, xi_std = np.sqrt(np.diag(slope @ covariance @ slope.T))
    share = "; ".join(f"{value:.3g} % unexplained of {name}" for name, value in fit.unexplained_percent.items())
    lines["all base motion"] = (
        f"f = {omega / (2 * math.pi):.4g} ± {omega_std / (2 * math.pi):.2g} Hz, xi = {xi:.4g} ± {xi_std:.2g}",
        share,
    )
    for number, measurement in enumerate(measurements):
        results[measurement.name] = {
            "experiment": measurement.experiment.name,
            "omega_n_rad_s": omega,
            "omega_n_std_rad_s": float(omega_std),
            "xi": xi,
            "xi_std": float(xi_std),
            "unexplained_percent": {
                name.split(" ", 2)[-1]: value
                for name, value in fit.unexplained_percent.items()
                if name.startswith(f"record {number + 1} ")
            },
        }
    if keys[0] not in fixed:
        findings.append(
            f"a foot that is moved gives {keys[1]} and {keys[2]} only as ratios to {keys[0]}, which keeps its prior"
        )
    if fit.whiteness_p < 1e-3:
        findings.append("the residual of the base motion holds structure: the best linear rig is not all")

    def predict(now: Mapping[str, float]) -> np.ndarray:
        mass, damping, stiffness = ({**fixed, **now}[key] for key in keys)
        return np.array([damping / mass, stiffness / mass])

    return Observation("base motion", ("damping/mass", "stiffness/mass"), ratios, covariance, predict)


def _against_the_foot(measurement: Measurement) -> ForcedRecord:
    """The motion against the foot under the inertia of a unit mass."""
    recording = measurement.recording
    name = next(name for name in reversed(BASES) if name in recording)
    motions = {motion: order for motion, order in DERIVATIVES.items() if motion in recording}
    rate = recording.sample_rate
    foot = foot_motion(recording[name], name, motions, rate, recording.provenance.file)
    seen = {motion: recording[motion] - foot[:, DERIVATIVES[motion]] for motion in motions}
    return ForcedRecord(1.0 / rate, -foot[:, 2], seen)
