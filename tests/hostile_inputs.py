"""Inputs that are programs: what reads them hangs, swells or dies as they say."""

from __future__ import annotations

from pathlib import Path


def idle(folder: Path) -> None:
    """Nothing to get warm with."""


def obeyed(path: Path) -> str:
    """Do what a file says."""
    exec(path.read_text(encoding="utf-8"), {})
    return "read"
