"""A few hundred mutated logs; benchmarks/fuzz_readers.py runs thousands."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def fuzz(root: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("fuzz_readers", root / "benchmarks" / "fuzz_readers.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("seed", [11, 12])
def test_mutated_logs_are_read_or_refused(fuzz: ModuleType, seed: int) -> None:
    outcomes, failures = fuzz.run(300, seed, [])
    assert not failures, failures[0]
    assert set(outcomes) <= {"read", "refused"}
    assert outcomes["read"] > 10  # a fuzzer that breaks everything tests only the door
    assert outcomes["refused"] > 100


def test_mutated_samples(fuzz: ModuleType, shared: Path) -> None:
    outcomes, failures = fuzz.run(300, 13, [shared / "spec" / "format-samples"])
    assert not failures, failures[0]
    assert set(outcomes) <= {"read", "refused"}
