"""Recordings whose noise and mains lines are known once something has been fitted to them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.trials import Trial
from ssmr_ident.signals.noise import block_noises


def prepared(fit: JointFit) -> list[Trial]:
    """A fit's trials with the mains lines that stand out of its residual.

    Where no quiet tail tells the noise, it is what the fit leaves at its fastest; of a load cell, what it leaves of all
    pulls together.
    """
    found: list[Trial] = []
    slow: list[tuple[int, np.ndarray]] = []
    for trial, simulated in zip(fit.trials, fit.simulated, strict=True):
        clean = trial.with_lines(trial.colour(simulated))
        together = trial.channels == ("force",) and not trial.quiet
        if together:
            slow.append((len(found), simulated))
        found.append(clean if trial.quiet or together else clean.renoised(simulated))
    blocks = [found[index].blocks(simulated) for index, simulated in slow]
    for (index, _), std in zip(slow, block_noises(blocks) if slow else (), strict=True):
        found[index] = found[index].with_noises((replace(found[index].noises[0], std=float(std)),))
    return found
