"""A diagnosis that cheats: it looks through every file that it may find for the words of a truth.

Arguments: session, out, folder of the proof, file for what it found. POSIX lets it look at its parent's open files and
environment too.
"""

import os
import sys
from pathlib import Path

WORDS = (b"true_robot", b"missing_physics", b"noise_floor", b"dry_friction", b"strength")


def main() -> None:
    """Look everywhere and say what was found."""
    session, out, proof, report = map(Path, sys.argv[1:5])
    found, looked = [], 0
    for place in (Path.cwd(), session, proof, proof.parent):
        for path in place.rglob("*"):
            if path.is_file() and path != report:
                looked += 1
                content = path.read_bytes()
                found += [f"{path}: {word.decode()}" for word in WORDS if word in content]
    parent = Path("/proc") / str(os.getppid())
    if parent.is_dir():
        for link in (parent / "fd").iterdir():
            target = link.readlink() if link.is_symlink() else Path()
            if target.is_file() and target.suffix in (".json", ".yaml", ".bin"):
                found.append(f"open in the parent: {target}")
        arguments = (parent / "cmdline").read_bytes() + (parent / "environ").read_bytes()
        found += [f"parent's arguments: {word.decode()}" for word in WORDS if word in arguments]
    with report.open("a", encoding="utf-8") as stream:
        stream.write(f"looked into {looked} files\n" + "".join(f"{line}\n" for line in found))
    out.mkdir()


if __name__ == "__main__":
    main()
