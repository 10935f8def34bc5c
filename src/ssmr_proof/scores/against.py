"""Other programs on the same sealed sessions: what they name, and how often they say that something is missing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path

from ssmr_ident.experiments.campaign import load
from ssmr_ident.report.html import Section, Table
from ssmr_proof.peers import PEERS, PeerAnswer
from ssmr_proof.run import processes
from ssmr_proof.scores.answer import Answer, Claim
from ssmr_proof.scores.score import CLEAN, FAILED, FALSE_ALARM, MEANING, NAMED, marked
from ssmr_proof.scores.summary import Share
from ssmr_proof.scores.table import Row


@dataclass(frozen=True)
class PeerScore:
    """One program over the rigs of a proof.

    Parameters
    ----------
    name : str
    outcomes : Counter
        Cases by outcome, as for a diagnosis.
    named, false_alarms : Share
    seconds : float
        Per case, mean.
    """

    name: str
    outcomes: Counter[str]
    named: Share
    false_alarms: Share
    seconds: float

    def cells(self) -> tuple[str, ...]:
        """As the table has it."""
        counts = ", ".join(f"{self.outcomes[name]} {name}" for name in MEANING if self.outcomes[name])
        return self.name, str(self.named), str(self.false_alarms), counts, f"{self.seconds:.1f}"


def against(
    rows: Sequence[Row], sessions: Path, jobs: int = 1, report: Callable[[str, int, int], None] | None = None
) -> tuple[PeerScore, ...]:
    """Run every peer on the rigs, which is what they know, and mark them as the diagnosis is marked."""
    rigs = [row for row in rows if row.truth["family"] == "rig"]
    found: dict[str, list[tuple[Row, str, float]]] = {name: [] for name in PEERS}
    with processes(jobs) as submit:
        waiting = [submit(asked, sessions / row.case) for row in rigs]
        for done, _ in enumerate(as_completed(waiting), start=1):
            if report:
                report("other programs", done, len(rigs))
    for row, future in zip(rigs, waiting, strict=True):
        for name, answer in future.result().items():
            found[name].append((row, marked(row.truth, as_answer(answer)).outcome, answer.seconds))
    own = PeerScore("ident diagnose", *_scored([(row, row.mark.outcome, row.seconds) for row in rigs]))
    return (own, *(PeerScore(name, *_scored(marks)) for name, marks in found.items()))


def asked(session: Path) -> dict[str, PeerAnswer]:
    """What every peer says of a session."""
    campaign = load(session)
    return {name: peer(campaign) for name, peer in PEERS.items()}


def as_answer(peer: PeerAnswer) -> Answer:
    """A peer's output in a diagnosis' terms: it names what it claims, or says only that something is missing."""
    claims = tuple(Claim(effect, (), {}) for effect in peer.effects)
    return Answer("missing_physics" if peer.says_missing else "nothing_missing", claims)


def peer_section(scores: Sequence[PeerScore]) -> Section:
    """For the page."""
    header = ("program", "hidden effects named", "false alarms", "outcomes", "seconds a case")
    text = (
        "The rigs of this proof, the same sealed sessions. A program that only says that its residual is not noise "
        "names nothing: it counts as wrong where physics is missing and as a false alarm where it is not."
    )
    table = Table("Marked as the diagnosis is.", header, tuple(score.cells() for score in scores))
    return Section("Other programs on the same sessions", (text,), (table,))


def _scored(marks: Sequence[tuple[Row, str, float]]) -> tuple[Counter[str], Share, Share, float]:
    outcomes = Counter(outcome for _, outcome, _ in marks)
    missing = sum(row.missing for row, _, _ in marks)
    named = sum(outcomes[name] for name in NAMED)
    null = outcomes[CLEAN] + outcomes[FALSE_ALARM] + sum(not row.missing and o == FAILED for row, o, _ in marks)
    seconds = sum(spent for _, _, spent in marks) / max(len(marks), 1)
    return outcomes, Share(named, missing), Share(outcomes[FALSE_ALARM], null), seconds


def peer_rows(scores: Sequence[PeerScore]) -> list[Mapping[str, object]]:
    """For JSON."""
    return [{"program": s.name, "outcomes": dict(s.outcomes), "seconds": s.seconds} for s in scores]
