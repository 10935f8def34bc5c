"""Some two hundred mutated session and parameter files; benchmarks/fuzz_yaml.py reads as many as it is asked."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def fuzz(root: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("fuzz_yaml", root / "benchmarks" / "fuzz_yaml.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_mutated_files_are_read_or_refused(fuzz: ModuleType, tmp_path: Path) -> None:
    random = np.random.default_rng(7)
    for log in "abc":
        (tmp_path / f"{log}.csv").write_text("t,a\n0,0\n")
    texts = fuzz.seeds()
    outcomes = []
    for number in range(200):
        name, text = texts[int(random.integers(len(texts)))]
        (tmp_path / name).write_bytes((fuzz.structured if number % 2 else fuzz.mutated)(text, random))
        outcomes.append(fuzz.judged(tmp_path / name))
    assert set(outcomes) == {"read", "refused"}, [each for each in outcomes if each not in ("read", "refused")][:1]
    assert outcomes.count("read") > 10  # a fuzzer that breaks everything tests only the door
