"""``ident fit``."""

from __future__ import annotations


def command() -> None:
    """(in the making)"""
