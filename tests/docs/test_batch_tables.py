"""The tables of a batch on its page are those of the code."""

from __future__ import annotations

import runpy
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_the_columns_on_the_page_are_the_codes() -> None:
    made = runpy.run_path(str(DOCS / "make_batch_tables.py"))
    assert made["page"]() == (DOCS / "howto" / "batch.md").read_text(encoding="utf-8")
