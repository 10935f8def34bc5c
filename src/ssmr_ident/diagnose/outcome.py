"""What a search of a robot's recordings hands to the answer."""

from __future__ import annotations

from dataclasses import dataclass

from ssmr_ident.diagnose.setup import Setup
from ssmr_ident.diagnose.weigh import Explanation


@dataclass(frozen=True, eq=False)
class Outcome:
    """What the search found.

    Parameters
    ----------
    setup : Setup
    baseline : Explanation
    tried : tuple of Explanation
        All, the baseline among them.
    chosen : Explanation
        The baseline where nothing is missing.
    rivals : tuple of Explanation
        Those that fit as well as the chosen one.
    found : dict of str to float
        Log evidence by id, the baseline's being 0.
    looked_at : int
        Effects that were tried, by a fit or by a score test.
    confidence : float
        In the chosen one, 0 … 1.
    withdrawn : str
        An answer that predicts recordings worse than the baseline does; empty where there is none.
    """

    setup: Setup
    baseline: Explanation
    tried: tuple[Explanation, ...]
    chosen: Explanation
    rivals: tuple[Explanation, ...]
    found: dict[str, float]
    looked_at: int
    confidence: float = 0.0
    withdrawn: str = ""
