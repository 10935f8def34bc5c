"""Answers that hold what is no number: null with a word, never a traceback after minutes of work."""

from __future__ import annotations

import json

import numpy as np
import pytest
import yaml

from ssmr_ident.cli.answer import print_json
from ssmr_ident.core.documents import yaml_text

ANSWER = {"fit": {"before": np.float64("inf"), "after": 2.0}, "values": np.array([1.0, np.nan]), "n": np.int64(3)}
NOTE = "null stands for what is no finite number: fit.before: inf; values[1]: nan"


def test_json_has_null_and_says_where(capsys: pytest.CaptureFixture[str]) -> None:
    print_json(ANSWER)
    said = capsys.readouterr()
    assert json.loads(said.out) == {"fit": {"before": None, "after": 2.0}, "values": [1.0, None], "n": 3}
    assert NOTE in said.err
    assert len(said.err.splitlines()) == 1


def test_yaml_has_null_and_says_where() -> None:
    text = yaml_text(ANSWER)
    assert yaml.safe_load(text)["fit"]["before"] is None
    assert text.splitlines()[-1] == f"# {NOTE}"
