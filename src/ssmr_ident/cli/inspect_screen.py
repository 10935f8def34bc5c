"""The screen of ``ident inspect``: one table per recording, then what the reader noticed."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from ssmr_ident.cli.inspect_log import LogSummary

_MOST_NOTES = 12


def show(summaries: Sequence[LogSummary], *, quiet: bool = False) -> None:
    """Print summaries; with ``quiet`` the warnings alone.

    Parameters
    ----------
    summaries : sequence of LogSummary
    """
    console = Console(highlight=False, emoji=False, markup=False, width=None if sys.stdout.isatty() else 110)
    for summary in summaries:
        if not quiet:
            _head(console, summary)
            console.print(_table(summary))
        _notes(console, summary, quiet)
        if not quiet:
            console.print()


def _head(console: Console, summary: LogSummary) -> None:
    provenance, health = summary.recording.provenance, summary.health
    part = f"  ({provenance.part})" if provenance.part else ""
    console.print(f"{provenance.file}{part}", soft_wrap=True)
    console.print(
        f"  reader {provenance.reader}, {health.samples} samples, {health.duration:.6g} s from "
        f"t = {min(channel.start_s for channel in health.channels):.6g} s, {health.sample_rate:.6g} Hz, "
        f"jitter {health.jitter:.2g} s, "
        f"{health.gaps} gap(s), SHA-256 {provenance.sha256[:12]}…",
        soft_wrap=True,
    )
    if summary.recording.header:
        facts = ", ".join(f"{k}: {v}" for k, v in list(summary.recording.header.items())[:8])
        console.print(f"  {facts[:200]}", soft_wrap=True)


def _table(summary: LogSummary) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 1))
    own = summary.recording.clocks_differ
    for heading in ("channel", "header", "unit"):
        table.add_column(heading, overflow="fold", min_width=len(heading) + 1 if own else None)
    if own:
        table.add_column("own clock", no_wrap=True)
    more = () if own else (f"{summary.mains_hz:g} Hz", "repeats")
    for heading in ("min", "max", "mean", "std", *more, "clipped", "missing"):
        table.add_column(heading, justify="right", no_wrap=True)
    for channel in summary.health.channels:
        hum = summary.hum.get(channel.name)
        table.add_row(
            channel.name,
            channel.label[:40],
            channel.unit or "?",
            *((f"{channel.samples} at {channel.rate_hz:.5g} Hz from {channel.start_s:.4g} s",) if own else ()),
            f"{channel.minimum:.5g}",
            f"{channel.maximum:.5g}",
            f"{channel.mean:.5g}",
            f"{channel.std:.3g}",
            *(() if own else (f"{hum[0]:.2g}±{hum[1]:.1g}" if hum else "-", f"{100 * channel.repeated:.0f} %")),
            str(channel.clipped),
            str(channel.missing),
        )
    return table


def _notes(console: Console, summary: LogSummary, quiet: bool) -> None:
    name = summary.recording.provenance.file
    notes = summary.recording.warnings if quiet else summary.recording.notes
    ordered = sorted(notes, key=lambda note: note.level != "warning")
    for note in ordered[:_MOST_NOTES]:
        console.print(f"{name}: {note}" if quiet else f"  {note}", soft_wrap=True)
    if len(ordered) > _MOST_NOTES:
        console.print(f"  and {len(ordered) - _MOST_NOTES} more notes; --json shows all")
