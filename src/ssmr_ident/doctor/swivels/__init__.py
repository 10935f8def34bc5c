"""Diagnosis of swivels: why the real robot shakes otherwise than the simulated one."""

from __future__ import annotations

from collections.abc import Callable

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.doctor.swivels.assemble import diagnosis_of
from ssmr_ident.doctor.swivels.engine import examine
from ssmr_ident.experiments.campaign import Campaign

__all__ = ["diagnose_swivels"]


def diagnose_swivels(
    campaign: Campaign,
    parameters: ParameterSet | None = None,
    seed: int = 0,
    progress: Callable[[str, int, int], None] | None = None,
) -> Diagnosis:
    """Say what physics was left out of the simulated swivels of a campaign.

    Parameters
    ----------
    campaign : Campaign
        Swivels or straight runs. With recordings of role ``calibration`` the baseline is anchored on them and the
        question is what the targets have that they have not.
    parameters : ParameterSet, optional
        In place of the session's.
    seed : int
        Of the simulated floors.
    progress : callable, optional
        Called with the name of a stage, what of it is done, and of how much.

    Raises
    ------
    InputError
        No target swivel is long enough, or wheel speeds are missing.
    """
    return diagnosis_of(examine(campaign, parameters, seed, progress), campaign.session.name)
