"""A proof as a page of text, to be kept under version control: seed, versions, command, tables."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from ssmr_ident.core.atomic import write_text
from ssmr_proof.run import Proof
from ssmr_proof.scores.against import PeerScore
from ssmr_proof.scores.power import power
from ssmr_proof.scores.score import MEANING
from ssmr_proof.scores.summary import confusion

PACKAGES = ("ssmr_ident", "mujoco", "numpy", "scipy", "numba")


def write_kept(proof: Proof, command: str, scores: Sequence[PeerScore] = ()) -> Path:
    """Write ``proof.md``."""
    versions = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    lines = [f"# A kept run: {len(proof.rows)} cases, seed {proof.seed}", "", "```sh", command, "```", ""]
    lines += [f"Python {platform.python_version()}, {versions}.", ""]
    lines += ["```", str(proof.summary), "```", ""]
    lines += _table(("outcome", "cases", "meaning"), _outcomes(proof))
    hidden, named, counts = confusion(proof.rows)
    lines += ["## Hidden down, named across", ""]
    lines += _table(
        ("hidden", *named),
        [(name, *(str(n) if n else "" for n in row)) for name, row in zip(hidden, counts, strict=True)],
    )
    lines += ["## Near the limit", "", "√(before² − floor²)/floor on the held-out recordings.", ""]
    rows = [tuple(map(str, row)) for row in power(proof.rows).rows() if row[1]]
    lines += _table(("left over the noise", "cases", "said to be missing", "named"), rows)
    if scores:
        lines += ["## Other programs on the same rigs", ""]
        header = ("program", "hidden effects named", "false alarms", "outcomes", "seconds a case")
        lines += _table(header, [score.cells() for score in scores])
    lines += ["## Every case", ""]
    names = ("case", "family", "hidden", "outcome", "named", "before_percent", "after_percent", "noise_floor_percent")
    lines += _table(
        ("case", "family", "hidden", "outcome", "named", "before %", "after %", "noise %"),
        [tuple(cells[name] for name in names) for cells in (row.as_dict() for row in proof.rows)],
    )
    return write_text(proof.folder / "proof.md", "\n".join(lines).rstrip() + "\n")


def _outcomes(proof: Proof) -> list[tuple[str, ...]]:
    outcomes = proof.summary.outcomes
    return [(name, str(outcomes[name]), MEANING[name]) for name in MEANING if outcomes[name]]


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    lines = ["| " + " | ".join(header) + " |", "| " + " | ".join("---" for _ in header) + " |"]
    return [*lines, *("| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in rows), ""]
