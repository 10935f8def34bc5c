"""The printed report of a fit: what was read from each recording, the parameters, and the findings in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import fill

from ssmr_ident.core.parameter import Estimate, ParameterSet


def parameter_lines(before: ParameterSet, after: ParameterSet, changed: Sequence[str]) -> list[str]:
    """One line per fitted parameter: value, standard deviation, percent, what was known before, source."""
    width = max((len(path) for path in changed), default=0)
    lines = []
    for path in changed:
        estimate = after[path]
        lines.append(
            f"    {path + ':':<{width + 1}} {_value(estimate):<34} {_known(before.get(path))}  [{estimate.source}]"
        )
    return lines


def _value(estimate: Estimate) -> str:
    if not isinstance(estimate.value, float):
        spread = "" if estimate.std is None else f" +/- {estimate.std:.2g}"
        return f"(array){spread} {estimate.unit}"
    if estimate.std is None:
        return f"{estimate.value:.6g} {estimate.unit}"
    percent = f" ({100 * estimate.std / abs(estimate.value):.2g}%)" if estimate.value else ""
    return f"{estimate.value:.6g} +/- {estimate.std:.2g} {estimate.unit}{percent}"


def _known(estimate: Estimate | None) -> str:
    if estimate is None or not isinstance(estimate.value, float):
        return ""
    spread = "unknown std" if estimate.std is None else f"± {estimate.std:.2g}"
    return f"(before {estimate.value:.6g} {spread})"


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
    lines.append("[[Variables]]")
    lines += parameter_lines(before, after, changed) or ["    (none)"]
    if correlations:
        lines.append("[[Correlations]] (above 0.5, strongest first)")
        lines += [f"    C({first}, {second}) = {size:+.3f}" for first, second, size in correlations]
    lines.append("[[Findings]]")
    lines += [fill(text, 110, initial_indent="    - ", subsequent_indent="      ") for text in findings] or [
        "    none: the recordings and what was known before agree"
    ]
    return "\n".join(lines)
