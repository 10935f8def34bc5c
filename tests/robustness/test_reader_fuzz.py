"""A few hundred mutated logs; benchmarks/fuzz_readers.py runs thousands."""

from __future__ import annotations

from pathlib import Path

import fuzz_readers
import pytest

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", [11, 12])
def test_mutated_logs_are_read_or_refused(seed: int) -> None:
    outcomes, failures, *_ = fuzz_readers.run(300, seed, [])
    assert not failures, failures[0]
    assert set(outcomes) <= {"read", "refused"}
    assert outcomes["read"] > 10  # a fuzzer that breaks everything tests only the door
    assert outcomes["refused"] > 100


def test_mutated_samples(shared: Path) -> None:
    outcomes, failures, *_ = fuzz_readers.run(300, 13, [shared / "spec" / "format-samples"])
    assert not failures, failures[0]
    assert set(outcomes) <= {"read", "refused"}
