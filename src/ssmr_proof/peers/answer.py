"""What a peer says of a session."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments.campaign import Campaign


@dataclass(frozen=True)
class PeerAnswer(Shown):
    """One peer on one session.

    Parameters
    ----------
    name : str
    claims : tuple of str
        What it says beyond the mass, the damper and the spring: terms, warnings, failed tests.
    effects : tuple of str
        Those of the claims that name physics of the catalogue, by its ids.
    says_missing : bool
        Whether its own output would make a user look for more.
    parameters : mapping of str to (float, float)
        Value and half-width of its 95 % interval, NaN where it gives none.
    seconds : float
    """

    name: str
    claims: tuple[str, ...]
    effects: tuple[str, ...]
    says_missing: bool
    seconds: float
    parameters: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def __str__(self) -> str:
        said = "; ".join(self.claims) or "nothing more"
        lines = [f"{self.name}: {said}  ({self.seconds:.1f} s)"]
        lines += [f"  {name} = {value:.5g} ± {half:.2g}" for name, (value, half) in self.parameters.items()]
        return "\n".join(lines)


def drive_and_motion(campaign: Campaign) -> tuple[str, list[Any]]:
    """The motion quantity that all targets of a driven rig have, and the targets.

    Raises
    ------
    InputError
        The session is no rig that a measured force drives.
    """
    targets = [m for m in campaign.measurements if m.entry.role != "heldout" and m.experiment.driven]
    if campaign.session.baseline != "sdof" or not targets or "force" not in targets[0].recording:
        raise InputError(campaign.session.name, "is not a rig driven by a measured force", "Peers run on those only")
    for quantity in ("acceleration", "velocity", "position"):
        if all(quantity in m.recording for m in targets):
            return quantity, targets
    raise InputError(campaign.session.name, "has no motion quantity that all its recordings share")
