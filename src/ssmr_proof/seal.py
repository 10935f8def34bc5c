"""A truth under seal: its SHA-256 with a nonce is on disk before any diagnosis, the truth itself is not.

Until a case is opened, its truth and its held-out recordings are bytes in this process' memory. A diagnosis runs as
another process and finds only the digest, which says nothing: a nonce of 32 random bytes is hashed with the truth.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ssmr_ident.core.atomic import write_bytes, write_text


class SealBroken(Exception):
    """What is opened is not what was sealed. A proof stops here; there is nothing to mend."""


@dataclass(frozen=True)
class Envelope:
    """One sealed case, in memory.

    Parameters
    ----------
    case : str
    truth : bytes
        JSON.
    heldout : mapping of str to bytes
        A session folder of its own that the diagnosis never sees.
    session : str
        Digest of the session that is diagnosed, so that neither is exchanged.
    nonce : bytes
    """

    case: str
    truth: bytes
    heldout: Mapping[str, bytes] = field(repr=False)
    session: str = ""
    nonce: bytes = field(default_factory=lambda: secrets.token_bytes(32), repr=False)

    @property
    def digest(self) -> str:
        """SHA-256 over nonce, truth, the held-out files with their names and the session's digest, in hexadecimal."""
        return digest(self.nonce, self.truth, self.heldout, self.session)

    def opened(self, sealed: str) -> dict[str, Any]:
        """The truth, when the digest is still the sealed one.

        Raises
        ------
        SealBroken
        """
        if self.digest != sealed:
            raise SealBroken(
                f"{self.case}: truth or recordings have changed since they were sealed: {self.digest} is not {sealed}"
            )
        result: dict[str, Any] = json.loads(self.truth)
        return result

    def unpack(self, folder: Path) -> None:
        """Write truth, nonce and held-out recordings, so that anyone can check the digest again."""
        (folder / "heldout").mkdir(parents=True, exist_ok=True)
        write_bytes(folder / "truth.json", self.truth)
        write_text(folder / "nonce.txt", self.nonce.hex() + "\n")
        for name, content in self.heldout.items():
            write_bytes(folder / "heldout" / name, content)


def session_digest(folder: Path, besides: tuple[str, ...] = ()) -> str:
    """SHA-256 over the files of a session folder and their names, without those of other names given."""
    files = {path.name: path.read_bytes() for path in folder.iterdir() if path.name not in besides}
    return digest(b"", b"", files)


def digest(nonce: bytes, truth: bytes, heldout: Mapping[str, bytes], session: str = "") -> str:
    """SHA-256 over a nonce, a truth and files; each part's length goes in before it, so that no two sets collide."""
    total = hashlib.sha256()
    parts = [nonce, truth, session.encode()]
    for name in sorted(heldout):
        parts += [name.encode(), heldout[name]]
    for part in parts:
        total.update(len(part).to_bytes(8, "big"))
        total.update(part)
    return total.hexdigest()


def write_seals(path: Path, envelopes: list[Envelope]) -> None:
    """The list of digests, before any diagnosis starts."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("case", "sha256"))
    rows.writerows((envelope.case, envelope.digest) for envelope in envelopes)
    write_text(path, text.getvalue())


def read_seals(path: Path) -> dict[str, str]:
    """Digest by case.

    Raises
    ------
    SealBroken
        The list is gone or is no such list.
    """
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            return {row["case"]: row["sha256"] for row in csv.DictReader(stream)}
    except (OSError, KeyError) as error:
        raise SealBroken(f"{path}: the list of seals cannot be read ({error})") from error
