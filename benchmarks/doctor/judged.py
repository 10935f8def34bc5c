"""What an answer is worth: the row that is kept of a session."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scoring import GOOD, Row, errors, outcome

from doctor.opened import Opened
from doctor.processor import timed
from ssmr_ident.diagnose.diagnosis import Diagnosis

OUTCOMES = ("right", "tie", "part", "wrong", "missed", "false alarm", "undetermined", "failed")


def judged(session: Opened, run: Callable[[], Diagnosis]) -> Row:
    """Run an engine and hold its answer against what is right.

    Where several answers are right, the one that the engine came nearest to counts; where an answer has claims to meet,
    it is right if it meets them all, and right names that do not are a part.
    """
    seconds: list[float] = []
    with timed(seconds):
        diagnosis = run()
    before, after, floor = session.heldout(diagnosis) if session.heldout else kept_back(session, diagnosis)
    said = min((outcome(names, diagnosis) for names in session.right), key=OUTCOMES.index)
    shown = session.claims(diagnosis) if session.claims else ()
    if shown:
        said = "right" if all(holds for _, holds in shown) else "part" if said in GOOD else said
    return {
        "outcome": said,
        "seconds": seconds[0],
        "verdict": diagnosis.verdict,
        "named": [effect.id for effect in diagnosis.effects],
        "ties": [list(effect.indistinguishable_from) for effect in diagnosis.effects],
        "confidence": [effect.confidence for effect in diagnosis.effects],
        "before": before,
        "after": after,
        "floor": floor,
        "errors": errors(diagnosis, session.effects, session.parameters),
        "claims": [f"{'yes' if holds else 'no'}: {words}" for words, holds in shown],
    }


def kept_back(session: Opened, diagnosis: Diagnosis) -> tuple[float, float, float]:
    """Before, after and the floor of the true signals, on what the engine kept back of the session itself."""
    heldout = diagnosis.heldout
    floors = [session.floors[file] for file in heldout.recordings if file in session.floors]
    return heldout.before, heldout.after, float(np.mean(floors)) if floors else float("nan")
