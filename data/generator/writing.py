"""Session files, parameter files and checksums."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.session import write_parameters


def write_session(
    path: Path,
    name: str,
    robot: str,
    recordings: Iterable[Mapping[str, Any]],
    baseline: str = "rigid6",
    comment: str = "",
) -> None:
    """Write a session file, one recording per line."""
    lines = [f"# {line}" for line in ("SYNTHETIC recordings, see README.md.", *comment.splitlines())]
    lines += ["schema: ssmr-ident/session/1", f"name: {name}", f"robot: {robot}", f"baseline: {baseline}"]
    lines += ["recordings:", *(f"  - {{{_flow(row)}}}" for row in recordings)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def _flow(row: Mapping[str, Any]) -> str:
    return ", ".join(f"{key}: {_scalar(value)}" for key, value in row.items())


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_scalar, value)) + "]"
    return str(value)


def write_robot(path: Path, parameters: ParameterSet) -> None:
    """Write a parameter file, telling in its first line what it is."""
    write_parameters(path, parameters)
    text = path.read_text(encoding="utf-8")
    first = "# SYNTHETIC: " + (
        "what the recordings were made with." if path.name.startswith("truth") else "what a lab would know."
    )
    path.write_text(f"{first}\n{text}", encoding="utf-8", newline="\n")


def write_checksums(folder: Path) -> None:
    """SHA256SUMS over all files below a folder, in the form that ``sha256sum -c`` checks."""
    files = sorted(p for p in folder.rglob("*") if p.is_file() and p.name != "SHA256SUMS")
    lines = [f"{hashlib.sha256(p.read_bytes()).hexdigest()}  {p.relative_to(folder).as_posix()}" for p in files]
    (folder / "SHA256SUMS").write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
