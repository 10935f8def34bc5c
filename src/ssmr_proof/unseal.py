"""Open a kept sealed session beside a diagnosis that was made before, or take the seals of a whole proof again."""

from __future__ import annotations

import json
import tempfile
import zlib
from dataclasses import dataclass
from pathlib import Path

from ssmr_ident.core.atomic import write_bytes, write_text
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_ident.session import read_session
from ssmr_proof.blind import BlindRun
from ssmr_proof.run import open_case
from ssmr_proof.scores.answer import read_answer
from ssmr_proof.scores.score import MEANING
from ssmr_proof.scores.table import Row
from ssmr_proof.seal import Envelope, SealBroken, read_seals, session_digest

SEAL, TRUTH = "seal.sha256", "sealed.bin"


@dataclass(frozen=True)
class Unsealed(Shown):
    """A truth and a diagnosis side by side."""

    row: Row
    seal: str

    def __str__(self) -> str:
        row = self.row
        before, after, floor = row.heldout.means
        lines = [f"{row.case}: the seal {self.seal[:16]}… holds"]
        for effect in row.truth["effects"]:
            values = ", ".join(f"{name} = {p['value']:.4g} {p['unit']}" for name, p in effect["parameters"].items())
            lines.append(
                f"  hidden:  {effect['id']} ({effect['form']}): {effect['how']}" + (f"; {values}" if values else "")
            )
        if not row.truth["effects"]:
            lines.append("  hidden:  nothing")
        lines.append(f"  named:   {', '.join(row.mark.named) or 'nothing'} ({row.answer.verdict.replace('_', ' ')})")
        lines.append(f"  outcome: {row.mark.outcome}: {MEANING[row.mark.outcome]}")
        for name, (error, away) in row.mark.parameter_errors.items():
            lines.append(
                f"  {name}: off by {error:+.1%}" + ("" if away is None else f", {away:+.1f} standard deviations")
            )
        if row.heldout.problem:
            lines.append(f"  held out: {row.heldout.problem}")
        else:
            lines.append(f"  held out: before {before:.2f} %, after {after:.2f} %, noise floor {floor:.2f} %")
        return "\n".join(lines)


def keep(envelope: Envelope, folder: Path) -> None:
    """Put a truth beside its session, packed so that nobody reads it by chance, and its seal in the open."""
    content = {
        "case": envelope.case,
        "nonce": envelope.nonce.hex(),
        "truth": _text(envelope.truth),
        "heldout": {name: _text(data) for name, data in envelope.heldout.items()},
    }
    write_bytes(folder / TRUTH, zlib.compress(json.dumps(content, sort_keys=True, ensure_ascii=False).encode(), 9))
    write_text(folder / SEAL, f"{envelope.digest}\n")


def unseal(folder: Path, diagnosis: Path | None) -> Unsealed:
    """Check the seal of a kept session and hold the truth against a diagnosis.

    Parameters
    ----------
    folder : Path
        Session folder with ``sealed.bin`` and ``seal.sha256``.
    diagnosis : Path
        What ``ident diagnose`` wrote.

    Raises
    ------
    InputError
        There is no diagnosis yet, or it is of another session.
    SealBroken
    """
    if not (folder / TRUTH).is_file():
        raise InputError(str(folder), f"holds no {TRUTH}", "Name a folder of data/raw/concealed, or of a whole proof")
    if diagnosis is None or not (diagnosis / "diagnosis.yaml").is_file():
        where = "no diagnosis was named" if diagnosis is None else f"{diagnosis} holds no diagnosis.yaml"
        mend = f"First ident diagnose {folder} -o DIAGNOSIS, then ident proof --unseal {folder} --diagnosis DIAGNOSIS"
        raise InputError(str(folder), f"is opened beside a diagnosis only, and {where}", mend)
    _same_session(folder, diagnosis)
    envelope, seal = _kept(folder), (folder / SEAL).read_text(encoding="utf-8").strip()
    with tempfile.TemporaryDirectory(prefix="ident-") as place:
        opened = Path(place) / envelope.case
        return Unsealed(open_case(envelope, seal, BlindRun(envelope.case, 0.0), opened, diagnosis), seal)


def recheck(folder: Path) -> int:
    """Take the seals of an opened proof again and return how many hold.

    Raises
    ------
    SealBroken
        One does not, or a case is gone.
    """
    seals = read_seals(folder / "seals.csv")
    for case, seal in seals.items():
        opened = folder / "opened" / case
        if not (opened / "truth.json").is_file():
            raise SealBroken(f"{case}: sealed, but not among the opened cases in {folder / 'opened'}")
        files = {path.name: path.read_bytes() for path in (opened / "heldout").iterdir()}
        nonce = bytes.fromhex((opened / "nonce.txt").read_text(encoding="utf-8").strip())
        session = session_digest(folder / "sessions" / case)
        Envelope(case, (opened / "truth.json").read_bytes(), files, session, nonce).opened(seal)
    return len(seals)


def _kept(folder: Path) -> Envelope:
    try:
        content = json.loads(zlib.decompress((folder / TRUTH).read_bytes()))
        heldout = {name: _bytes(text) for name, text in content["heldout"].items()}
        session = session_digest(folder, (TRUTH, SEAL))
        return Envelope(content["case"], _bytes(content["truth"]), heldout, session, bytes.fromhex(content["nonce"]))
    except (zlib.error, ValueError, KeyError) as error:
        raise SealBroken(f"{folder / TRUTH}: cannot be opened ({error})") from error


def _same_session(folder: Path, diagnosis: Path) -> None:
    name, answer = read_session(folder).name, read_answer(diagnosis)
    if answer.session != name:
        raise InputError(str(diagnosis), f"is a diagnosis of {answer.session!r}, the sealed session is {name!r}")


def _text(data: bytes) -> str:
    return data.decode("latin-1")  # every byte is a letter there, and the words of a log stay short when packed


def _bytes(text: str) -> bytes:
    return text.encode("latin-1")
