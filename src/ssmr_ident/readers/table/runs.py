"""Runs side by side in one table: ``Run 1: Time (s), Run 1: Force (N), Run 2: Time (s)``, as classrooms' loggers do."""

from __future__ import annotations

import re

import numpy as np

from ssmr_ident.readers.table.columns import Column
from ssmr_ident.readers.table.headings import heading_of
from ssmr_ident.readers.table.vocabulary import LONGEST, Vocabulary, words_of

_RUN = re.compile(r"(?<![^\W_])((?:[^\W\d_]{3,12} )?)([^\W\d_]{3,12})[ _]?#?[ _]?(\d{1,3})\b[ )\]]*:?")


def runs_of(columns: list[Column], known: Vocabulary) -> dict[str, list[Column]]:
    """Columns by the run that their names say, each with a time of its own; empty where they are of one run.

    Parameters
    ----------
    columns : list of Column
    known : Vocabulary
        Its ``runs`` are the words before a run's number.
    """
    found: dict[str, list[Column]] = {}
    names: dict[str, list[str]] = {}
    for column in columns:
        run, label = run_in(column.label[:LONGEST], known)
        if not run:
            return {}
        found.setdefault(run, []).append(column)
        names.setdefault(run, []).append(label)
    alike = len({str(labels) for labels in names.values()}) == 1
    timed = [name for label in next(iter(names.values()), []) if (name := heading_of(label, None, known).quantity)]
    if len(found) < 2 or not alike or "time" not in timed:
        return {}
    for name, members in found.items():
        rows = np.flatnonzero(np.any([np.isfinite(c.values) for c in members], axis=0))
        end = int(rows[-1]) + 1 if len(rows) else 0  # a shorter run has blank cells below it
        for column, label in zip(members, names[name], strict=True):
            column.label, column.values = label, column.values[:end]
    return found


def run_in(label: str, known: Vocabulary) -> tuple[str, str]:
    """The run that a name says, and the name without it; empty for none."""
    for match in _RUN.finditer(label):
        for word, begin in ((match[1] + match[2], match.start()), (match[2], match.start(2))):
            if known.has("runs", words_of(word)):
                rest = label[:begin].rstrip(" ,([_"), label[match.end() :].lstrip(" ,_")
                return f"{word} {match[3]}", " ".join(part for part in rest if part)
    return "", label
