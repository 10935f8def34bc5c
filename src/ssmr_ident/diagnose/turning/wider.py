"""Where no explanation comes near: the best few once more, from all of their starts at once.

With a baseline that is not yet where it goes with an effect, the evidence of single starts is half chance: a centre of
mass 4 cm off was followed from the wrong side, at 5.4 dB, when its own place had 4.9 dB. An ensemble over all starts
and the baseline's parameters together ended at 2.5 to 3 dB on the right side in three of three draws, one of half the
size in one of two.
"""

from __future__ import annotations

from collections.abc import Sequence

from ssmr_ident.diagnose.turning.candidates import UNLISTED
from ssmr_ident.diagnose.turning.conditions import Condition
from ssmr_ident.diagnose.turning.counter import Counter, Progress
from ssmr_ident.diagnose.turning.ensemble import ROUGH, ROUNDS, Ensemble, settled, work_of
from ssmr_ident.diagnose.turning.search import Explained

FAR_DB = 1.5
"""Own error of the best explanation from which on it was not found yet, or none of them is it."""
TRIED, FEWER, MANY = 3, 2, 6
"""Explanations that run with fine steps besides what is unlisted, at most, and fewer of them from how many recorded
conditions on. Twice as many begin: what is fourth by single starts may be first by an ensemble's coarse rounds."""
REACH = 150.0
"""Of evidence: an ensemble from all starts and what followed it was seen to add 140 at most."""
LED, TIMES = 2, 2  # how many of them ensembles take on, and how often at most
WORK = 2.2e8
"""Steps simulated in a diagnosis from which on nothing is led on any further: about 150 s of processor time."""
MOST_WORK = 3.0e8
"""Steps beyond which no more explanations are searched from all starts, but for the first and what is unlisted."""


def wider(
    best: list[Explained],
    targets: tuple[Condition, ...],
    seed: int,
    final: tuple[int, ...],
    show: Progress,
    straight: Sequence[str] = (),
) -> list[Explained]:
    """Those in front, searched from everywhere; none where the best comes near.

    Parameters
    ----------
    best : list of Explained
        One of each id, best first.
    targets : tuple of Condition
    seed : int
        Of the draws, and of the simulated floors.
    final : tuple of int
        Floors over which places are compared.
    show : callable
        Called with the name of the stage, what of it is done, and of how much.
    straight : sequence of str
        Ids that came first beside a baseline that was not fitted to the targets: tried before those that are in front
        beside one that was, and may have bent itself round what is missing.
    """
    if not best or best[0].target.tau_db < FAR_DB:
        return []
    level = best[0].evidence - REACH
    listed = [one for one in best if one.id != UNLISTED and one.candidate is not None and one.candidate.free]
    ahead = [one for name in straight[: TRIED - 1] for one in listed if one.id == name]
    ahead += [one for one in listed if one not in ahead and one.evidence > level]
    recorded = (*best[0].anchor.calibration, *targets)
    room = int((MOST_WORK - best[0].anchor.bench.work) / max(work_of(recorded), 1.0)) - 1
    most = min(max(room, 1), FEWER if len(recorded) > MANY else TRIED)
    chosen = ahead[: 2 * most]
    chosen += [one for one in best if one.id == UNLISTED]
    count = Counter(show, "best explanations from all starts", (len(chosen) + LED * TIMES) * ROUNDS)
    found = _raced([Ensemble(one, targets, seed, final, everywhere=True) for one in chosen], most, count)
    found.sort(key=lambda one: one.evidence, reverse=True)
    bench = best[0].anchor.bench
    for place, one in enumerate(found[:LED]):
        for time in range(TIMES):
            count.reach((len(chosen) + place * TIMES + time) * ROUNDS)
            if one.target.tau_db < FAR_DB or one.evidence < found[0].evidence - REACH or bench.work > WORK:
                break  # found, or out of reach, or as long as anyone waits
            # one that gains nothing says little of the next: beside falling friction the first added 0, the second 60
            one = found[place] = settled(one, targets, seed + 1 + time, final, count.advance)
    count.finish()
    return found


def _raced(ensembles: list[Ensemble], most: int, count: Counter) -> list[Explained]:
    """Where the ensembles end that are in front after the coarse rounds and still in reach of the best after fine ones.

    ``most`` listed explanations at most run with fine steps.
    """
    alive = list(ensembles)
    for done in range(ROUNDS):
        for ensemble in alive:
            ensemble.advance()
            count.advance()
        count.reach((done + 1) * len(ensembles))
        if done == ROUGH - 1:
            listed = [ensemble for ensemble in alive if ensemble.start.id != UNLISTED]
            ahead = sorted(listed, key=lambda ensemble: ensemble.level, reverse=True)[:most]
            alive = [ensemble for ensemble in alive if ensemble in ahead or ensemble.start.id == UNLISTED]
        elif done >= ROUGH:
            level = max(ensemble.level for ensemble in alive)
            alive = [ensemble for ensemble in alive if ensemble.level > level - REACH]
    return [ensemble.best() for ensemble in alive]
