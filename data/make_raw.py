"""Make the reference campaign in data/raw anew: ``make data``, or ``python data/make_raw.py [FOLDER]``.

Seeded: the same versions of Python's zlib, numpy, numba and this package give the same bytes.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path

from generator import documents, pulls, releases, swivels
from generator.writing import write_checksums

SEED = 20120510
HERE = Path(__file__).resolve().parent


def main() -> None:
    """Make the campaign and put it in the place of the old one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=HERE / "raw", help="default: data/raw")
    parser.add_argument("--seed", type=int, default=SEED)
    arguments = parser.parse_args()
    folder: Path = arguments.folder.resolve()
    if folder.exists() and any(folder.iterdir()) and not (folder / "SHA256SUMS").is_file():
        parser.error(f"{folder} holds something else (no SHA256SUMS); name an empty folder")
    folder.parent.mkdir(parents=True, exist_ok=True)
    # made beside its place and moved there whole, so that a failure leaves the old campaign as it was
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".raw-") as temporary:
        fresh = Path(temporary) / folder.name
        make(fresh, arguments.seed)
        if (folder / "concealed").is_dir():  # sealed once, and not to be had again from a seed
            shutil.copytree(folder / "concealed", fresh / "concealed")
            write_checksums(fresh)
        if folder.exists():
            shutil.rmtree(folder)
        fresh.rename(folder)
    files = [path for path in folder.rglob("*") if path.is_file()]
    print(f"{folder}: {len(files)} files, {sum(path.stat().st_size for path in files) / 1e6:.1f} MB")


def make(folder: Path, seed: int) -> None:
    """Write the whole campaign into a new folder."""
    releases.make(folder / "free_response", seed)
    pulls.make(folder / "pulls", seed)
    for frame in swivels.FRAMES:
        swivels.make(folder / f"swivel-{frame}", seed, frame)
    documents.write(folder, seed)
    write_checksums(folder)


if __name__ == "__main__":
    main()
