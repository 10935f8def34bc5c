"""What compiled loops were made of: their own file and every one that it imports, at whatever distance.

numba asks of a cached loop whether its own file has changed, not whether one has that it calls or takes numbers from:
after an update in place a loop would go on with the old law of a tire, or read its state at the old places.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.errors import InputError

STAMP = "compiled_from.json"


def forget_other_sources(package: Path) -> bool:
    """Delete what was compiled of other sources than those that a package has now.

    Parameters
    ----------
    package : Path
        Folder whose files, at whatever depth, kernels are made of. Where it cannot be written to, numba keeps nothing
        there either.

    Returns
    -------
    bool
        Whether any file was another one, or not known.
    """
    # an interpreter that keeps no bytecode does not make the package's own; numba makes one wherever it keeps loops
    kept = package / "__pycache__"
    if not os.access(kept if kept.is_dir() else package, os.W_OK):
        return False
    kept.mkdir(exist_ok=True)
    files = sorted(package.rglob("*.py"))
    facts = [(file.relative_to(package).as_posix(), file.stat().st_size, file.stat().st_mtime_ns) for file in files]
    seen = hashlib.sha256(repr(facts).encode()).hexdigest()
    stamp = kept / STAMP
    before = _before(stamp)
    if before["seen"] == seen:
        return False
    sources = _sources(package, files)
    for index in package.rglob("__pycache__/*.nbi"):  # named FILE.FUNCTION-LINE
        own = (index.parent.parent / f"{index.name.split('.')[0]}.py").relative_to(package).as_posix()
        if own not in sources or before["sources"].get(own) != sources[own]:
            index.unlink(missing_ok=True)
    with suppress(InputError):  # a full disk: what is kept is asked for once more by the next run
        write_text(stamp, json.dumps({"seen": seen, "sources": sources}))
    return True


def _before(stamp: Path) -> dict[str, Any]:
    """What loops were compiled of; nothing where that was never written, or is no longer whole."""
    with suppress(OSError, ValueError):
        found = json.loads(stamp.read_text(encoding="ascii"))
        if isinstance(found, dict) and found.keys() == {"seen", "sources"} and isinstance(found["sources"], dict):
            return found
    return {"seen": "", "sources": {}}


def _sources(package: Path, files: list[Path]) -> dict[str, str]:
    """Of every file that has kernels: a digest of it and of all that it imports of the package."""
    modules = {_module(package, file): file for file in files}
    text = {name: file.read_bytes() for name, file in modules.items()}
    imported: dict[str, set[str]] = {}

    def reached(name: str) -> set[str]:
        found: set[str] = set()
        ahead = [name]
        while ahead:
            here = ahead.pop()
            if here not in found:
                found.add(here)
                if here not in imported:
                    imported[here] = _imports(text[here]) & modules.keys()
                ahead += imported[here]
        return found

    return {
        modules[name].relative_to(package).as_posix(): hashlib.sha256(
            b"".join(text[m] for m in sorted(reached(name)))
        ).hexdigest()
        for name in modules
        if b"@kernel" in text[name]
    }


def _module(package: Path, file: Path) -> str:
    parts = file.relative_to(package.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imports(source: bytes) -> set[str]:
    """Names of modules, and of what is taken from them, which may be modules too."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
        elif isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
    return found
