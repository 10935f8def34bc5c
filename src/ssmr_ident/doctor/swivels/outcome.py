"""All that an examination of swivels found."""

from __future__ import annotations

from dataclasses import dataclass, field

from ssmr_ident.doctor.swivels.anchor import Anchor
from ssmr_ident.doctor.swivels.bench import Bench
from ssmr_ident.doctor.swivels.conditions import Condition
from ssmr_ident.doctor.swivels.explained import Explained
from ssmr_ident.doctor.swivels.grip import GripProfile
from ssmr_ident.doctor.swivels.yaw_gain import YawGain


@dataclass(frozen=True, eq=False)
class Outcome:
    """All that was found.

    Parameters
    ----------
    calibration, targets, heldout : tuples of Condition
    anchor : Anchor
        Baseline before anything was added.
    baseline : Explained
    explanations : tuple of Explained
        Best first, at their final values; without the baseline.
    screened : tuple of Explained
        Those that were not followed further.
    grip : GripProfile
    notes : tuple of str
    seconds : dict
    turned : YawGain or None
        Of the targets, where gyroscopes measured it.
    unread : str
        Why spectra were asked nothing; empty where they were.
    """

    bench: Bench
    calibration: tuple[Condition, ...]
    targets: tuple[Condition, ...]
    heldout: tuple[Condition, ...]
    anchor: Anchor
    baseline: Explained
    explanations: tuple[Explained, ...]
    screened: tuple[Explained, ...]
    grip: GripProfile
    notes: tuple[str, ...]
    seconds: dict[str, float] = field(default_factory=dict)
    turned: YawGain | None = None
    unread: str = ""

    @property
    def calibrated(self) -> bool:
        return bool(self.calibration)
