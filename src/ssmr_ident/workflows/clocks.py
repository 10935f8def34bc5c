"""By how much the clocks of two logs of one event differ, for who looks at both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ssmr_ident.core.recording import Recording
from ssmr_ident.core.shown import Shown
from ssmr_ident.experiments.experiment import ACCELERATIONS
from ssmr_ident.experiments.together import clock_of, clock_sentence
from ssmr_ident.signals.alignment import Alignment
from ssmr_ident.workflows.new.machines import ALIKE, in_rig_quantities
from ssmr_ident.workflows.new.system import Log, moving, pulling


@dataclass(frozen=True)
class Clocks(Shown):
    """Two logs of one event.

    Parameters
    ----------
    first, second : str
        Files.
    felt : (str, str)
        By which quantities of each the clocks were compared.
    alignment : Alignment
    sentence : str
    """

    first: str
    second: str
    felt: tuple[str, str]
    alignment: Alignment
    sentence: str

    def as_dict(self) -> dict[str, Any]:
        """Plain values for ``--json``."""
        found = self.alignment
        return {
            "first": self.first,
            "second": self.second,
            "felt": list(self.felt),
            "shift_s": found.shift_s,
            "shift_std_s": found.shift_std_s,
            "drift_ppm": found.drift_ppm,
            "drift_std_ppm": found.drift_std_ppm,
            "start_s": found.start_s,
            "end_s": found.end_s,
            "explained": found.explained,
        }

    def __str__(self) -> str:
        return self.sentence


def clocks_of(recordings: Sequence[Recording]) -> Clocks | None:
    """Clocks of two logs of which one holds a force and the other a motion, and which last about as long; else None.

    Raises
    ------
    InputError
        They have nothing in common; the message says what was looked for.
    """
    if len(recordings) != 2 or recordings[0].provenance.file == recordings[1].provenance.file:
        return None
    if any(len(set(ACCELERATIONS) & set(r.names)) > 1 or len(r.time) < 2 for r in recordings):
        return None  # a body in space is no rig
    logs = [Log(Path(r.provenance.file).name, None, r) for r in recordings]
    drives = [pulling(r) and not moving(r) for r in recordings]
    moves = [moving(r) and not pulling(r) for r in recordings]
    lasting = recordings[0].duration / max(recordings[1].duration, 1e-9)
    if not ((drives[0] and moves[1]) or (drives[1] and moves[0])) or not ALIKE < lasting < 1.0 / ALIKE:
        return None
    first, second = (in_rig_quantities(log) for log in logs)
    found, one, other = clock_of(first, second)
    return Clocks(logs[0].file, logs[1].file, (one, other), found, clock_sentence(first, second, found, one, other))
