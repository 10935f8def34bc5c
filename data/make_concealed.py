"""Make three sealed sessions in data/raw/concealed anew: ``python data/make_concealed.py``.

Whoever runs this does not learn what is hidden: the seed is drawn, and is written down under the seal only.
"""

from __future__ import annotations

import argparse
import secrets
import shutil
import tempfile
from pathlib import Path

from generator.writing import write_checksums

from ssmr_proof.drawn.cases import draw_case
from ssmr_proof.lab.case import SMALL
from ssmr_proof.run import seal_case
from ssmr_proof.unseal import keep

RAW = Path(__file__).resolve().parent / "raw"
WANTED = {"a": "decay", "b": "rig", "c": "pull"}
README = Path(__file__).resolve().parent / "generator" / "templates" / "concealed.md"


def main() -> None:
    """Draw, record, seal."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument(
        "folder", nargs="?", type=Path, default=RAW / "concealed", help="default: data/raw/concealed"
    )
    folder: Path = arguments.parse_args().folder.resolve()
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".concealed-") as place:
        fresh = Path(place) / folder.name
        fresh.mkdir()
        for name, family in WANTED.items():
            make(fresh / name, family, Path(place) / f"recorded-{name}")
        shutil.copyfile(README, fresh / "README.md")
        if folder.exists():
            shutil.rmtree(folder)
        fresh.rename(folder)
    if (folder.parent / "SHA256SUMS").is_file():
        write_checksums(folder.parent)
    files = [path for path in folder.rglob("*") if path.is_file()]
    print(f"{folder}: {len(files)} files, {sum(path.stat().st_size for path in files) / 1e6:.1f} MB")


def make(folder: Path, family: str, place: Path) -> None:
    """One session of a family, sealed."""
    seed, number = secrets.randbelow(2**31), 1
    while draw_case(seed, number).family != family or draw_case(seed, number).decoupled:
        number += 1  # a baseline that asks for pure rotations would tell what it lacks
    envelope = seal_case(seed, number, place, SMALL)
    shutil.copytree(place / envelope.case, folder)
    keep(envelope, folder)


if __name__ == "__main__":
    main()
