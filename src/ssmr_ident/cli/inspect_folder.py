"""``ident inspect`` on a folder: a line a log, and what the logs have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ssmr_ident.cli.inspect_log import LogSummary

_ALIKE = 1e-3  # relative difference of rates that two starts of one logger have


def line_of(summary: LogSummary) -> str:
    """One log in a line."""
    recording, health = summary.recording, summary.health
    part = f" ({recording.provenance.part})" if recording.provenance.part else ""
    channels = ", ".join(f"{c.name} [{c.unit or '?'}]" for c in health.channels[:8])
    more = f" and {len(health.channels) - 8} more" if len(health.channels) > 8 else ""
    doubts = f"; {len(recording.warnings)} warning(s)" if recording.warnings else ""
    return (
        f"{recording.provenance.file}{part}: reader {recording.provenance.reader}, {health.samples} samples, "
        f"{health.duration:.6g} s, {health.sample_rate:.6g} Hz: {channels}{more}{doubts}"
    )


def in_common(summaries: Sequence[LogSummary]) -> dict[str, Any]:
    """Reader, rate, length, channels and units that all logs share; keys without a common value are left out."""
    if len(summaries) < 2:
        return {}
    common: dict[str, Any] = {}
    readers = {s.recording.provenance.reader for s in summaries}
    if len(readers) == 1:
        common["reader"] = readers.pop()
    for key, values in (
        ("sample_rate_hz", [s.health.sample_rate for s in summaries]),
        ("duration_s", [s.health.duration for s in summaries]),
    ):
        if max(values) - min(values) <= _ALIKE * max(values):
            common[key] = float(f"{sum(values) / len(values):.6g}")
    channels = [{(c.name, c.unit) for c in s.health.channels} for s in summaries]
    shared = set.intersection(*channels)
    if shared:
        common["channels"] = {c.name: c.unit for c in summaries[0].health.channels if (c.name, c.unit) in shared}
    return common


def common_lines(common: dict[str, Any], count: int) -> list[str]:
    """What ``in_common`` found, for the screen."""
    if count < 2:
        return []
    words = []
    if "reader" in common:
        words.append(f"reader {common['reader']}")
    if "sample_rate_hz" in common:
        words.append(f"{common['sample_rate_hz']:g} Hz")
    if "duration_s" in common:
        words.append(f"{common['duration_s']:g} s")
    if "channels" in common:
        words.append("channels " + ", ".join(f"{name} [{unit or '?'}]" for name, unit in common["channels"].items()))
    return [f"in common of {count} recordings: {'; '.join(words) or 'nothing'}"]
