"""Some two hundred mutated session and parameter files; benchmarks/fuzz_yaml.py reads as many as it is asked."""

from __future__ import annotations

from pathlib import Path

import fuzz_yaml
import numpy as np
import pytest

pytestmark = pytest.mark.slow


def test_mutated_files_are_read_or_refused(tmp_path: Path) -> None:
    random = np.random.default_rng(7)
    for log in "abc":
        (tmp_path / f"{log}.csv").write_text("t,a\n0,0\n")
    texts = fuzz_yaml.seeds()
    outcomes = []
    for number in range(200):
        name, text = texts[int(random.integers(len(texts)))]
        (tmp_path / name).write_bytes((fuzz_yaml.structured if number % 2 else fuzz_yaml.mutated)(text, random))
        outcomes.append(fuzz_yaml.judged(tmp_path / name))
    assert set(outcomes) == {"read", "refused"}, [each for each in outcomes if each not in ("read", "refused")][:1]
    assert outcomes.count("read") > 10  # a fuzzer that breaks everything tests only the door
