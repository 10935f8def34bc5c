"""The whole proof with a pretended diagnosis, as a user calls it."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ssmr_ident.cli import app
from ssmr_ident.core.errors import InputError
from ssmr_proof.kept import write_kept
from ssmr_proof.lab.case import Extent
from ssmr_proof.page.page import write_proof_page
from ssmr_proof.run import STAGES, Proof, prove
from ssmr_proof.scores.against import against
from ssmr_proof.scores.score import MEANING

pytestmark = pytest.mark.slow

CASES = 6


@pytest.fixture(scope="module")
def proof(tmp_path_factory: pytest.TempPathFactory, tiny: Extent, pretended: tuple[str, ...]) -> Proof:
    out = tmp_path_factory.mktemp("proof") / "out"
    told: list[tuple[str, int, int]] = []
    sealed: list[int] = []

    def announce(seals: str) -> None:
        sealed.append(len(told))
        assert not any((out / "answers").iterdir())  # before any diagnosis
        assert len(seals.splitlines()) == CASES + 1

    made = prove(CASES, 41, out, 1, pretended, tiny, lambda *step: told.append(step), announce)
    assert [step for step in told if step[0] == STAGES[1]] == [(STAGES[1], n, CASES) for n in range(1, CASES + 1)]
    assert sealed == [CASES]  # once, after recording and before diagnosing
    return made


def test_every_case_has_a_mark_and_a_row(proof: Proof) -> None:
    assert all(row.mark.outcome in MEANING and not row.failure for row in proof.rows)
    with (proof.folder / "proof.csv").open(encoding="utf-8", newline="") as stream:
        table = list(csv.DictReader(stream))
    assert [row["case"] for row in table] == [f"session-{n:03d}" for n in range(1, CASES + 1)]
    assert all(float(row["noise_floor_percent"]) > 0.0 for row in table)
    assert sum(proof.summary.outcomes.values()) == CASES


def test_the_page_stands_alone(proof: Proof) -> None:
    page = write_proof_page(proof, "ident proof").read_text(encoding="utf-8")
    assert not re.search(r'(src|href)="https?:', page)
    for word in ("Hidden and named", "Held out", "Near the limit", "Six cases", "Seals"):
        assert word in page
    text = re.sub(r"<(svg|script).*?</\1>", "", page, flags=re.DOTALL)
    assert not re.search(r"\bnan\b", text)


def test_what_is_kept_names_its_command_and_every_case(proof: Proof) -> None:
    text = write_kept(proof, "ident proof --seed 41").read_text(encoding="utf-8")
    assert "ident proof --seed 41" in text
    assert sum(line.startswith("| session-") for line in text.splitlines()) == CASES
    assert (
        len({line.count("|") for line in text.split("Hidden down")[1].split("##")[0].splitlines() if "|" in line}) == 1
    )


def test_the_same_seed_gives_the_same_sessions(
    proof: Proof, tmp_path: Path, tiny: Extent, pretended: tuple[str, ...]
) -> None:
    again = prove(1, 41, tmp_path / "out", 1, pretended, tiny)
    for path in (again.folder / "sessions" / "session-001").iterdir():
        assert path.read_bytes() == (proof.folder / "sessions" / "session-001" / path.name).read_bytes()


def test_a_diagnosis_that_fails_is_counted(tmp_path: Path, tiny: Extent) -> None:
    import sys

    code = "import sys; print('ident: out of luck', file=sys.stderr); sys.exit(1)"
    proof = prove(1, 42, tmp_path / "out", 1, (sys.executable, "-c", code), tiny)
    assert proof.rows[0].mark.outcome == "failed"
    assert proof.rows[0].as_dict()["problem"] == "ident: out of luck"


def test_a_folder_that_holds_something_else_is_left_alone(tmp_path: Path, tiny: Extent) -> None:
    (tmp_path / "thesis.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="no proof"):
        prove(1, 43, tmp_path, 1, ("true",), tiny)
    assert (tmp_path / "thesis.txt").is_file()


def test_other_programs_are_marked_alike(proof: Proof, monkeypatch: pytest.MonkeyPatch) -> None:
    from ssmr_proof.peers import PeerAnswer
    from ssmr_proof.scores import against as module

    monkeypatch.setattr(module, "PEERS", {"mute": lambda campaign: PeerAnswer("mute", (), (), False, 0.1)})
    own, mute = against(proof.rows, proof.folder / "sessions")
    rigs = [row for row in proof.rows if row.truth["family"] == "rig"]
    assert sum(mute.outcomes.values()) == sum(own.outcomes.values()) == len(rigs) > 0
    assert mute.named.hits == mute.false_alarms.hits == 0


def test_the_command_opens_and_complains(proof: Proof, tmp_path: Path) -> None:
    run = CliRunner().invoke(app, ["proof", "--unseal", str(proof.folder), "--json"])
    assert json.loads(run.stdout) == {"seals": CASES, "hold": True}
    seals = proof.folder / "seals.csv"
    kept = seals.read_text(encoding="utf-8")
    try:
        seals.write_text(kept.replace(kept.split(",")[2][:8], "00000000"), encoding="utf-8")
        run = CliRunner().invoke(app, ["proof", "--unseal", str(proof.folder)])
    finally:
        seals.write_text(kept, encoding="utf-8")
    assert run.exit_code == 1
    assert "SEAL BROKEN" in run.stderr
