"""Free responses of a robot fitted by their samples, inside ``ident fit``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.body.free_decays import BodyDecay, body_decay
from ssmr_ident.identify.posterior.most_probable import Posterior, Unknown
from ssmr_ident.identify.robot.fit import BodyFit, fit_body
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.signals.noise import whiteness
from ssmr_ident.workflows.fit.robot_forces import Gathered

AXES = ("ax", "ay", "az")

NAMED = 1.2
"""Variance over the noise's, or widening of a standard deviation, below which structure is not told."""

CLIPPED = 3
"""Samples at the end of the sensor's range from which a channel is left out."""


def fit_samples(
    campaign: Campaign,
    chosen: Sequence[Measurement],
    unknowns: Sequence[Unknown],
    gathered: Gathered,
    modal: Posterior,
    seed: int,
) -> BodyFit | None:
    """Output error over all decays with accelerations, other experiments beside it; None where there are none.

    Parameters
    ----------
    campaign : Campaign
    chosen : sequence of Measurement
    unknowns : sequence of Unknown
    gathered : Gathered
        Gets a line, a number and a finding for what the samples leave behind.
    modal : Posterior
        Fit of the modes, the first start.
    seed : int
    """
    builder = RobotBuilder.of(campaign.parameters)
    decays = [
        decay
        for measurement in chosen
        if measurement.experiment.free
        for decay in [_prepared(measurement, builder, gathered)]
        if decay is not None
    ]
    if not decays:
        return None
    start = {u.name: float(v) for u, v in zip(modal.unknowns, modal.values, strict=True)}
    fit = fit_body(
        decays, builder, unknowns, gathered.observations, start, seed=seed, effects=effect_values(campaign.parameters)
    )
    _report(fit, gathered)
    return fit


def _prepared(measurement: Measurement, builder: RobotBuilder, gathered: Gathered) -> BodyDecay | None:
    recording, sensor = measurement.recording, builder.nominal.accelerometer
    channels = []
    for axis, name in enumerate(AXES):
        if name not in recording:
            continue
        samples = recording[name]
        low, high = recording.channel(name).shows(sensor.range_m_s2)
        if np.count_nonzero((samples <= low) | (samples >= high)) >= CLIPPED:
            gathered.findings.append(
                f"{measurement.name}: {name} reaches the end of what it shows and is left out of the fit of samples"
            )
            continue
        if np.ptp(samples) > 0:
            channels.append((axis, samples))
    if not channels:
        return None
    return body_decay(measurement.name, recording.time, channels, sensor.bandwidth_hz)


def _report(fit: BodyFit, gathered: Gathered) -> None:
    system = fit.posterior.systems[0]
    tests = sum(residual.shape[1] for residual in system.residuals)
    left = {}
    for decay, weighted, sizes in zip(fit.decays, system.residuals, fit.distrust, strict=True):
        residual = weighted * sizes
        early = residual[: len(residual) // 4]
        misfit = float(np.mean(early**2))
        p_value = min(1.0, tests * min(whiteness(residual[:, c]) for c in range(residual.shape[1])))
        if p_value < 1e-3:
            left[decay.name] = misfit
        gathered.results[decay.name] |= {"output_error_misfit": misfit, "output_error_white": p_value >= 1e-3}
        axes = ", ".join(AXES[axis] for axis in decay.axes)
        gathered.lines[decay.name] += (
            f"all samples of {axes}: {misfit:.3g} times the noise's variance left in the first quarter"
            + ("" if p_value >= 1e-3 else ", with structure"),
        )
    if not gathered.observations:
        gathered.findings.append(
            "free responses alone tell mass, inertia, stiffness and damping up to one common factor, which here comes "
            "from what was known before; a pull or a weighing tells it"
        )
    widened = float(np.max(fit.posterior.sandwich))
    if left and max([*left.values(), widened]) > NAMED:
        least = max(float(np.max(sizes)) for sizes in fit.distrust)
        worst = max(left, key=lambda name: left[name])
        gathered.findings.append(
            f"{len(left)} of {len(fit.decays)} decays leave more than noise behind the full simulator (most in "
            f"{worst}: {left[worst]:.3g} times its variance in the first quarter): the model misses something; "
            f"their channels were trusted up to {least:.3g} times less, and standard deviations widened up to "
            f"{widened:.2g} times"
        )
    if not fit.settled:
        gathered.findings.append(
            f"with these parameters the full simulator leaves small motions by up to {fit.largest_defect:.0f} noise "
            "standard deviations, as when contacts slide, and the recordings do not follow it: the decays were fitted "
            "as small motions on sticking tires"
        )


def body_statistics(fit: BodyFit | None) -> tuple[str, ...]:
    """Lines for the printed report; none where no samples were fitted."""
    if fit is None:
        return ()
    system = fit.posterior.systems[0]
    count = sum(residual.size for residual in system.residuals)
    return (
        f"output error: {count} block averages of {len(fit.decays)} decays, 12 starting states, offsets and mains "
        "lines eliminated in each",
        f"chi-square {system.cost:.6g}, reduced {system.cost / count:.4f}; {fit.agreeing} of {fit.tried} starts "
        f"led here; largest effect of finite motion {fit.largest_defect:.2g} noise std",
    )
