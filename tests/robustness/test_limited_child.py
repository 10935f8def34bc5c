"""The fuzzers' own judge: what hangs, swells or ends its process is told, and the next input is judged as any other."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from hostile_inputs import idle, obeyed
from limited_child import Child

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform != "linux", reason="/proc")]


def test_a_child_that_hangs_swells_or_dies_is_told(tmp_path: Path) -> None:
    child = Child(tmp_path, idle, obeyed)
    try:
        calm = child.ask("calm", b"pass")
        assert calm.outcome == "read"
        swollen = child.ask("swells", b"held = bytes(1) * 300_000_000")
        assert swollen.megabytes > calm.megabytes + 250
        assert child.ask("calm", b"pass").megabytes < calm.megabytes + 50
        hung = child.ask("hangs", b"while True: pass")
        assert hung.outcome.startswith("slow")
        assert hung.seconds == pytest.approx(2.0, abs=1.0)
        assert child.ask("dies", b"import os; os._exit(3)").outcome == "died"
        assert child.ask("calm", b"pass").outcome == "read"
    finally:
        child.end()
