"""The printed report of a fit: what was read from each recording, the parameters, and the findings in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import fill

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.identify.lmfit_report import Variable, variables_report


def file_variables(before: ParameterSet, after: ParameterSet, changed: Sequence[str]) -> tuple[Variable, ...]:
    """Scalars that a fit was free to move, as variables of a report.

    Parameters
    ----------
    before, after : ParameterSet
    changed : sequence of str
        Paths.
    """
    rows = []
    for path in changed:
        estimate, known = after[path], before.get(path)
        if isinstance(estimate.value, float):
            prior = None if known is None else float(known.value)
            spread = None if known is None else known.std
            rows.append(Variable(path, estimate.value, estimate.std, estimate.unit, prior, spread, estimate.source))
    return tuple(rows)


def fit_report(
    session: str,
    statistics: Sequence[str],
    recordings: Mapping[str, Sequence[str]],
    tables: Sequence[str],
    before: ParameterSet,
    after: ParameterSet,
    changed: Sequence[str],
    correlations: Sequence[tuple[str, str, float]],
    findings: Sequence[str],
    variables: Sequence[Variable] = (),
) -> str:
    """The whole report as text.

    Parameters
    ----------
    session : str
    statistics : sequence of str
        Lines under Fit Statistics.
    recordings : mapping of file to lines
    tables : sequence of str
        Printed as they are.
    before, after : ParameterSet
    changed : sequence of str
        Paths that the fit was free to move.
    correlations : sequence of (name, name, number)
    findings : sequence of str
    variables : sequence of Variable
        What the fit was free to move; empty takes the scalars of ``changed``.
    """
    lines = [f"[[Fit]] {session}", "[[Fit Statistics]]"]
    lines += [f"    {line}" for line in statistics]
    if recordings:
        lines.append("[[Recordings]]")
        for file, texts in recordings.items():
            first, *rest = texts or ["(nothing fitted)"]
            lines.append(f"    {file}: {first}")
            lines += [f"        {text}" for text in rest]
    for table in tables:
        lines += ["[[Table]]", *(f"    {line}" for line in table.splitlines())]
    pairs = {(first, second): size for first, second, size in correlations}
    rows = variables or file_variables(before, after, changed)
    lines += variables_report(rows, pairs) if rows else ["[[Variables]]", "    (none)"]
    lines.append("[[Findings]]")
    lines += [fill(text, 110, initial_indent="    - ", subsequent_indent="      ") for text in findings] or [
        "    none: the recordings and what was known before agree"
    ]
    return "\n".join(lines)
