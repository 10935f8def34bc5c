"""The catalogue: one left-out effect per file. The folder is the list, and installed packages may add to it."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.own_effect import effect_of_file, effects_of_packages


def _read() -> dict[str, Effect]:
    found: dict[str, Effect] = {}
    for module in sorted(pkgutil.iter_modules(__path__), key=lambda m: m.name):
        effect = importlib.import_module(f"{__name__}.{module.name}").EFFECT
        if effect.id != module.name:
            raise ImportError(f"effects/{module.name}.py declares the id {effect.id!r}; expected {module.name!r}")
        found[effect.id] = effect
    for effect in effects_of_packages(found):
        found[effect.id] = effect
    return found


CATALOGUE: dict[str, Effect] = _read()


@contextmanager
def effects_of(*files: str | Path) -> Iterator[tuple[Effect, ...]]:
    """Within a ``with``, the catalogue holds the effects of some Python files too, which are run.

    Parameters
    ----------
    files : path
        Each with one value ``EFFECT``.

    Raises
    ------
    InputError
        A file that does not run or holds no effect that can be taken; the catalogue is as before then.
    """
    added: list[Effect] = []
    try:
        for file in files:
            effect = effect_of_file(file, CATALOGUE)
            CATALOGUE[effect.id] = effect
            added.append(effect)
        yield tuple(added)
    finally:
        for effect in added:
            del CATALOGUE[effect.id]
