"""One kind of error for whatever a user can mend; the command line prints it in one line and exits with 2."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class InputError(Exception):
    """A file or a call is wrong, and the user can mend it.

    Parameters
    ----------
    where : str
        File and the place in it: ``roll-1.xlsx:z:B16``, ``session.yaml: recordings[2].motion``.
    problem : str
        What is wrong, with what was found and what was expected.
    mend : str
        What to do about it.
    """

    def __init__(self, where: str, problem: str, mend: str = "") -> None:
        self.where, self.problem, self.mend = str(where), problem, mend
        super().__init__(f"{where}: {problem}" + (f". {mend}" if mend else ""))


class Impossible(InputError):
    """Numbers that no robot can have, an inertia of no body or a mast that is more than it: a search may try them."""


class SimulationError(Exception):
    """A simulation left the finite numbers; names when, and with which parameters."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """A hint for a misspelt name, or the list of what is known.

    >>> did_you_mean("mas_kg", ["mass_kg", "tire"])
    "Did you mean 'mass_kg'?"
    >>> did_you_mean("zzz", ["mass_kg", "tire"])
    'Known: mass_kg, tire.'
    """
    known = sorted(known)
    close = difflib.get_close_matches(name, known, n=1)
    return f"Did you mean {close[0]!r}?" if close else f"Known: {', '.join(known)}."
