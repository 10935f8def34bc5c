"""The replication of the 2012 thesis, which stands beside the library in a checkout."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from ssmr_ident.core.errors import InputError

PLACES = (Path("studies"), Path(__file__).resolve().parents[4] / "studies")
"""Of this folder, then of the checkout that the library runs from."""


def thesis_scoreboard(places: Sequence[Path] = PLACES) -> ModuleType:
    """Load ``thesis2012/scoreboard.py`` from the first place that holds it.

    Raises
    ------
    InputError
        None does: the library was installed without its studies.
    """
    for place in places:
        if (place / "thesis2012" / "scoreboard.py").is_file():
            sys.path.insert(0, str(place.resolve()))
            return importlib.import_module("thesis2012.scoreboard")
    raise InputError(
        ", ".join(map(str, places)),
        "no thesis2012/scoreboard.py",
        "The replication of the thesis is not installed with the library: run it in a checkout",
    )
