"""A proof that cannot cheat: changed truths, changed seals, spying diagnoses."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from ssmr_ident.core.errors import InputError
from ssmr_proof.lab.case import Extent
from ssmr_proof.run import prove, seal_case
from ssmr_proof.seal import Envelope, SealBroken, read_seals, write_seals
from ssmr_proof.unseal import SEAL, TRUTH, keep, recheck, unseal

ENVELOPE = Envelope("session-001", b'{"effects": []}', {"a.csv": b"1,2", "b.csv": b"3"}, "s")


def test_an_unchanged_truth_opens() -> None:
    assert ENVELOPE.opened(ENVELOPE.digest) == {"effects": []}


@pytest.mark.parametrize(
    "changed",
    [
        Envelope("session-001", b'{"effects": [1]}', ENVELOPE.heldout, "s", ENVELOPE.nonce),
        Envelope("session-001", ENVELOPE.truth, {"a.csv": b"1,2", "b.csv": b"4"}, "s", ENVELOPE.nonce),
        Envelope("session-001", ENVELOPE.truth, {"a.csv": b"1,2b.csv3"}, "s", ENVELOPE.nonce),
        Envelope("session-001", ENVELOPE.truth, ENVELOPE.heldout, "t", ENVELOPE.nonce),
        Envelope("session-001", ENVELOPE.truth, ENVELOPE.heldout, "s"),
    ],
    ids=["truth", "heldout", "files run together", "session", "nonce"],
)
def test_a_changed_truth_does_not(changed: Envelope) -> None:
    with pytest.raises(SealBroken, match="have changed since they were sealed"):
        changed.opened(ENVELOPE.digest)


def test_the_same_truth_never_has_the_same_seal() -> None:
    """Otherwise a diagnosis could try truths against the list."""
    assert Envelope("x", ENVELOPE.truth, {}).digest != Envelope("x", ENVELOPE.truth, {}).digest


def test_seals_are_read_as_written(tmp_path: Path) -> None:
    write_seals(tmp_path / "seals.csv", [ENVELOPE])
    assert read_seals(tmp_path / "seals.csv") == {"session-001": ENVELOPE.digest}
    with pytest.raises(SealBroken, match="cannot be read"):
        read_seals(tmp_path / "gone.csv")


@pytest.mark.slow
def test_a_diagnosis_that_looks_everywhere_finds_no_truth(tmp_path: Path, tiny: Extent) -> None:
    here, report = tmp_path / "place" / "proof", tmp_path / "found.txt"
    spy = str(Path(__file__).with_name("spying_diagnosis.py"))
    command = (sys.executable, spy, "{session}", "{out}", str(here), str(report))
    proof = prove(2, 31, here, 1, command, tiny)
    lines = report.read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if not line.startswith("looked into")] == []
    assert len(lines) == 2  # it did look, both times, and into the sessions at least
    assert all(int(line.split()[2]) > 6 for line in lines)
    assert all(row.mark.outcome == "failed" for row in proof.rows)
    # after opening, the truth lies there for all: the words that the spy looked for are the right ones
    assert "true_robot" in (here / "opened" / "session-001" / "truth.json").read_text(encoding="utf-8")


def test_a_diagnosis_that_changes_the_seals_ends_the_proof(tmp_path: Path, tiny: Extent) -> None:
    out = tmp_path / "proof"
    # the last hexadecimal digit becomes another one, whichever it is: a digest is as random as its nonce
    code = (
        f"import pathlib; p = pathlib.Path({str(out / 'seals.csv')!r}); t = p.read_text().rstrip(); "
        "p.write_text(t[:-1] + ('1' if t[-1] == '0' else '0'))"
    )
    with pytest.raises(SealBroken, match="have changed"):
        prove(1, 32, out, 1, (sys.executable, "-c", code), tiny)


@pytest.mark.slow
def test_a_kept_session_opens_beside_a_diagnosis_only(tmp_path: Path, tiny: Extent, pretended: tuple[str, ...]) -> None:
    from ssmr_proof.blind import run_blind

    envelope = seal_case(33, 2, tmp_path, tiny)
    folder, answer = tmp_path / "session-002", tmp_path / "answer"
    keep(envelope, folder)
    with pytest.raises(InputError, match="beside a diagnosis only"):
        unseal(folder, None)
    assert run_blind(pretended, folder, answer).failure == ""
    found = unseal(folder, answer)
    assert found.row.truth["case"] == "session-002"
    assert envelope.digest[:16] in str(found)
    for word in (b"true_robot", b"effects"):
        assert word not in (folder / TRUTH).read_bytes()

    other = tmp_path / "other"
    seal_case(33, 3, tmp_path, tiny)
    run_blind(pretended, tmp_path / "session-003", other)
    with pytest.raises(InputError, match="is a diagnosis of 'session-003'"):
        unseal(folder, other)
    log = next(path for path in folder.iterdir() if path.suffix in (".csv", ".txt", ".lvm", ".xlsx"))
    kept = log.read_bytes()
    log.write_bytes(kept + b"\n")
    with pytest.raises(SealBroken):
        unseal(folder, answer)
    log.write_bytes(kept)
    seal = (folder / SEAL).read_text(encoding="utf-8")
    (folder / SEAL).write_text(seal.replace(seal[0], "0" if seal[0] != "0" else "1"), encoding="utf-8")
    with pytest.raises(SealBroken):
        unseal(folder, answer)


def test_a_whole_proof_can_be_checked_again(tmp_path: Path, tiny: Extent, pretended: tuple[str, ...]) -> None:
    out = tmp_path / "proof"
    prove(1, 34, out, 1, pretended, tiny)
    assert recheck(out) == 1
    truth = out / "opened" / "session-001" / "truth.json"
    truth.write_text(truth.read_text(encoding="utf-8").replace("0", "1", 1), encoding="utf-8")
    with pytest.raises(SealBroken, match="session-001"):
        recheck(out)
