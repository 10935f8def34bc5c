"""A baseline as an effect has left it: fitted from where the effect led all else, and shaken before one is named."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.accept import ahead, better, certain, significant, within_file
from ssmr_ident.diagnose.baseline import LAST, unsteady
from ssmr_ident.diagnose.explain import without
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.hollows import challenged
from ssmr_ident.diagnose.polish import calmed
from ssmr_ident.diagnose.rotate import shown_in_turn
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.identify.fitting.descent import descend, slides
from ssmr_ident.identify.fitting.joint import JointFit, differentiate
from ssmr_ident.identify.trials import Trial


def good_enough(leader: Explanation, before: Explanation, first: bool) -> bool:
    """Whether an explanation is named before another, by what is kept back or by all recordings in turn."""
    return better(leader, before, first) or (first and shown_in_turn(leader, before))


def outdone(leader: Explanation, before: Explanation) -> bool:
    """Whether pulls fit better without an effect than with it.

    All its evidence is then of recordings kept back, and these may lie in hollows of their own.
    """
    counted = _counted(leader, before)
    return slides(leader.fit) and before.fit.cost(counted) < leader.fit.cost(counted)


def _counted(leader: Explanation, before: Explanation) -> np.ndarray:
    """Independent samples of each recording, in what the one leaves that leaves less.

    A drag that a baseline misses altogether had 5 of them (bank 5086), and 168 beside the cable that explains it.
    """
    return min((leader.fit, before.fit), key=lambda fit: float(np.log(fit.parts).sum())).counted


def stripped_of(leader: Explanation, chosen: Explanation) -> JointFit:
    """A leader without the effect that it has more, led on from where it ended."""
    more = [name for name in leader.fit.model.ids if name not in chosen.fit.model.ids]
    stripped = without(leader.fit, more[-1])
    # the leader of pulls was led far, over hollows: what is without it begins where it ended, and is led as far
    return descend(calmed(stripped) if unsteady(stripped) else stripped, LAST // 2)


def way_home(
    chosen: Explanation, baseline: Explanation, tried: Sequence[Explanation], kept: Sequence[Trial], known: ParameterSet
) -> Explanation | None:
    """A better baseline than the one that an answer was held against, by way of an effect that is none.

    What is ahead of the answer by an effect of no size, or of one that the file allows, has found its way out of a
    hollow of the baseline, and needs no effect to stand there. A baseline of four decays (bank 260034, nothing missing)
    was left at a cost of 4,762, which is 865 from the true values; a mast took 3,900 of it, and a bandwidth that was no
    lower than its sheet 450 more.
    """
    for other in tried:
        if len(other.fit.model.ids) != 1 or other is chosen or not ahead(other, chosen):
            continue
        fit = differentiate(other.fit)
        if not significant(fit) or within_file(fit, known):
            bare = explained(kept, differentiate(stripped_of(other, baseline)), other.kept)
            if certain(bare, baseline):
                return bare
    return None


def shaken(stripped: JointFit, chosen: Explanation, leader: Explanation, kept: Sequence[Trial]) -> JointFit:
    """The baseline of pulls after as many tries as the effects have had that stand against it."""

    def beaten(base: JointFit) -> bool:
        bare = explained(kept, base, leader.kept)
        return outdone(leader, bare) or not good_enough(leader, bare, True)

    return challenged(leader.fit, _counted(leader, chosen), (stripped, chosen.fit), beaten)
