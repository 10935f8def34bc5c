"""What stands beside the library and is not there is told in one line."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from ssmr_ident.cli import proof
from ssmr_ident.core.errors import InputError
from ssmr_ident.workflows.demo.thesis import thesis_scoreboard


def test_without_the_studies_the_thesis_cannot_be_checked(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no thesis2012/scoreboard\.py\. .* run it in a checkout"):
        thesis_scoreboard([tmp_path])


def test_without_the_proof_its_verb_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="ssmr_proof is not installed"):
        proof.command(cases=1)
